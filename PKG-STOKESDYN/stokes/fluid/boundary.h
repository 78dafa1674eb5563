/* What is around the spheres, from LAMMPS's `boundary` and the keywords wall and flow: read in
 * one place, found before a run (boundary_checks.h), and asked by everybody else.
 *
 *   OPEN       fluid everywhere               PERIODIC   in all directions
 *   WALL       one wall, no direction is periodic
 *   FLOOR      one wall, periodic along it    SLIT       two walls, periodic along them
 *   LAYER      periodic in two directions, and nothing beyond the spheres but fluid
 *
 * The last three are sums of their own (sd_slab.h): without torques of one-point spheres, at a
 * ratio of radii up to SD_SLAB_RATIO, in a box without tilt. */
#ifndef SD_BOUNDARY_H
#define SD_BOUNDARY_H

#include "sd_slab.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Domain;
}

namespace StokesDyn {

class Keywords;

struct Boundary {
  enum Kind { OPEN, PERIODIC, WALL, FLOOR, SLIT, LAYER };
  Kind kind = OPEN;
  /* so many of keyword wall, the one that looks up first; at_edge: it is that side of the box,
   * found before a run */
  int walls = 0;
  sd_wall wall[2] = {};
  bool at_edge[2] = {false, false};
  /* two walls: the pressure is the same at both ends, or nothing flows out */
  bool no_flux = false;
  /* across FLOOR, SLIT and LAYER */
  int across = 2;

  /* SIDE POSITION|EDGE, once or for two opposite sides; pressure or flux */
  void read_wall(Keywords &in);
  /* before the words are read, as an error that says how two are given */
  static void refuse_second(const Keywords &in, const std::vector<std::string> &words);
  void read_flow(Keywords &in);

  bool slab() const { return kind == FLOOR || kind == SLIT || kind == LAYER; }
  bool walled() const { return walls > 0; }
  /* Does everybody have an image, and so see himself? */
  bool has_images() const { return kind != OPEN; }
  /* That wall whose images pairs have in a law with one at most, and that which matters most to a
   * body at x when it moves alone. sign 0: there is none */
  const sd_wall &image_wall() const { return wall[0]; }
  const sd_wall &nearest(const double x[3]) const;
  sd_slab_walls slab_walls() const;
  /* As a user would say it: "above a floor"; where sums over everybody go; "zlo at 0, or zhi at 5" */
  std::string where() const;
  std::string summed() const;
  std::string wall_names() const;
  /* "boundary p p f", of a box that is periodic along the walls */
  std::string letters() const;
  /* Where those at sides of the box stand now, to tell one state from another */
  std::vector<std::string> edges() const;
  /* What errors of a LAYER advise */
  inline static const std::string GIVE_WALLS =
      ": give the pair style a wall (a floor, or two walls), or use boundary p p p";
};

/* "zlo at 0.5" */
std::string wall_name(const sd_wall &wall);
inline char axis_name(int d) { return "xyz"[d]; }
/* Where the side of the box stands now that bears its name */
double side_of_box(const LAMMPS_NS::Domain *domain, const sd_wall &wall);

}    // namespace StokesDyn
#endif
