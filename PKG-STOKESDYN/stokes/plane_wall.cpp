#include "plane_wall.h"

#include "keywords.h"
#include "ranks.h"

#include "domain.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

static std::string side_name(const sd_wall &wall)
{
  return std::string(1, "xyz"[wall.axis]) + (wall.sign > 0 ? "lo" : "hi");
}

std::string wall_name(const sd_wall &wall)
{
  return side_name(wall) + " at " + text(wall.at);
}

static double side_of_box(const Domain *domain, const sd_wall &wall)
{
  return wall.sign > 0 ? domain->boxlo[wall.axis] : domain->boxhi[wall.axis];
}

/* Is a side of a triclinic box at right angles to its axis? */
static bool upright(const Domain *domain, int axis)
{
  if (!domain->triclinic || axis == 2) return true;
  return axis == 1 ? domain->yz == 0.0 : domain->xy == 0.0 && domain->xz == 0.0;
}

void find_wall(const Voice &voice, Scene::Settings &settings)
{
  const Domain *domain = voice.lmp->domain;
  sd_wall &wall = settings.wall;
  if (!wall.sign) return;
  for (int d = 0; d < 3; d++)
    if (domain->periodicity[d])
      voice.fail("keyword wall: it needs boundary f, s or m in all directions, and " +
                 std::string(1, "xyz"[d]) + " is periodic: periodic images above a wall are not "
                 "summed");
  if (!settings.at_edge) return;
  if (domain->boundary[wall.axis][wall.sign < 0] != 1)
    voice.fail("keyword wall: EDGE: that side of the box follows the spheres (boundary s or m): "
               "give the position of the wall, or boundary f there");
  if (!upright(domain, wall.axis))
    voice.fail("keyword wall: EDGE: that side of the box is tilted: give the position of the wall");
  wall.at = side_of_box(domain, wall);
}

void check_stream_at_wall(const Voice &voice, const sd_wall &wall,
                          const Ambient::Settings &fluid)
{
  if (!wall.sign || fluid.grid || fluid.box) return;
  for (int k = 1; k <= 3; k++) {    // the one across the wall last
    const int d = (wall.axis + k) % 3;
    const Field &u = fluid.velocity[d];
    if (u.is_variable() || u.number() == 0.0) continue;
    const std::string there = wall_name(wall) + ", and its component " + "xyz"[d] + " is '" +
        text(u.number()) + "' there: ";
    if (k == 3)
      voice.fail("keyword fluid_velocity: nothing flows through the wall " + there +
                 "give 0, or a variable that is 0 at the wall");
    voice.warn("keyword fluid_velocity: the fluid rests at the wall " + there + "a shear flow is a "
               "variable, such as RATE*(z-zlo)");
  }
}

double spheres_cut_by_wall(const Voice &voice, const Scene &scene)
{
  const sd_wall &wall = scene.settings.wall;
  const sd_spheres spheres = scene.local();
  const Domain *domain = voice.lmp->domain;
  double cut = 0.0;
  if (scene.settings.at_edge && wall.at != side_of_box(domain, wall))
    voice.at_step().fail("keyword wall: EDGE: that side of the box is at " +
                         text(side_of_box(domain, wall)) + " now and was at " + text(wall.at) +
                         " when the run began: walls do not move; give its position");
  for (int k = 0; k < scene.size(); k++) {
    const double height = sd_wall_height(&wall, spheres.x + 3 * (size_t) k);
    cut += height < spheres.a[k];
    if (height > 0.0) continue;
    voice.at_step().fail_one("keyword wall: the centre of atom " + std::to_string(scene.tag(k)) +
                             ", radius " + text(spheres.a[k]) + ", is " + text(0.0 - height) +
                             " behind the wall " + wall_name(wall) + ": spheres must stand in "
                             "front of it; is it on the right side? A contact (fix wall/gran) or a "
                             "shorter time step keeps them there");
  }
  return sum_of_all(voice.lmp->world, cut);
}

}    // namespace StokesDyn
