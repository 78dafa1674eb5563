#include "boundary.h"

#include "keywords.h"

#include "domain.h"

#include <algorithm>

namespace StokesDyn {

// --- keywords ------------------------------------------------------------------------------------

static const std::initializer_list<const char *> SIDES = {"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"};

static bool names_a_side(const std::string &word)
{
  for (const char *side : SIDES)
    if (word == side) return true;
  return false;
}

static std::string side_name(const sd_wall &wall)
{
  return std::string(1, axis_name(wall.axis)) + (wall.sign > 0 ? "lo" : "hi");
}

std::string wall_name(const sd_wall &wall)
{
  return side_name(wall) + " at " + text(wall.at);
}

double side_of_box(const LAMMPS_NS::Domain *domain, const sd_wall &wall)
{
  return wall.sign > 0 ? domain->boxlo[wall.axis] : domain->boxhi[wall.axis];
}

void Boundary::read_wall(Keywords &in)
{
  for (walls = 0; walls == 0 || (in.more() && names_a_side(in.peek()));) {
    if (walls == 2)
      in.refuse("a corner of walls is not possible: give one side, or two opposite ones");
    const size_t side = in.choice(SIDES);
    wall[walls] = {(int) side / 2, side % 2 ? -1 : 1, 0.0};
    at_edge[walls] = in.take("EDGE");
    if (!at_edge[walls]) wall[walls].at = in.value("POSITION").number();
    walls++;
  }
  if (walls == 1) return;
  if (wall[0].axis != wall[1].axis || wall[0].sign == wall[1].sign)
    in.refuse("'" + side_name(wall[0]) + "' and '" + side_name(wall[1]) +
              "' are not opposite sides: give one side, or two opposite ones, such as zlo and zhi");
  if (wall[0].sign < 0) {
    std::swap(wall[0], wall[1]);
    std::swap(at_edge[0], at_edge[1]);
  }
}

void Boundary::refuse_second(const Keywords &in, const std::vector<std::string> &words)
{
  int many = 0;
  for (size_t k = 0; k + 1 < words.size(); k++)
    many += words[k] == "wall" && names_a_side(words[k + 1]);
  in.require(many <= 1,
             "keyword wall: two walls are given by two sides after one keyword, such as wall zlo 0 "
             "zhi 10");
}

void Boundary::read_flow(Keywords &in)
{
  no_flux = in.choice({"pressure", "flux"}) == 1;
}

sd_slab_walls Boundary::slab_walls() const
{
  if (kind == LAYER) return sd_slab_layer(across);
  if (kind == FLOOR) return sd_slab_floor(wall);
  return sd_slab_slit(across, wall[0].at, wall[1].at, no_flux);
}

std::string Boundary::where() const
{
  static const char *const NAMES[] = {"in open fluid", "in the periodic box", "at a wall",
                                      "above a floor", "in a slit",           "in an open layer"};
  return NAMES[kind];
}

std::string Boundary::wall_names() const
{
  return wall_name(wall[0]) + (walls == 2 ? ", or " + wall_name(wall[1]) : "");
}

std::string Boundary::summed() const
{
  return slab() ? where() + ", periodic along it" : kind == PERIODIC ? where() : "in an open box around them";
}

std::string Boundary::letters() const
{
  std::string letters = "boundary p p p";
  letters[9 + 2 * wall[0].axis] = 'f';
  return letters;
}

const sd_wall &Boundary::nearest(const double x[3]) const
{
  const bool other = walls == 2 && sd_wall_height(&wall[1], x) < sd_wall_height(&wall[0], x);
  return wall[other];
}

std::vector<std::string> Boundary::edges() const
{
  std::vector<std::string> all;
  for (int w = 0; w < walls; w++) {
    char position[40];
    snprintf(position, sizeof(position), "%.17g", wall[w].at);
    if (at_edge[w]) all.push_back(position);
  }
  return all;
}

}    // namespace StokesDyn
