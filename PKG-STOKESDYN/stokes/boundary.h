/* What is around the spheres, from LAMMPS's `boundary` and the keywords wall and flow: read in
 * one place, found before a run, and asked by everybody else.
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

class Ambient;
class Keywords;
class Scene;
class Voice;
struct StokesSettings;

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
  /* When all words are read: an error for what does not go with a wall, or with flow; torques of spheres of
   * one point, for whose images there is no Ewald sum, are summed over all pairs. */
  void settle(const Keywords &in, StokesSettings &settings) const;

  bool slab() const { return kind == FLOOR || kind == SLIT || kind == LAYER; }
  bool walled() const { return walls > 0; }
  /* Does everybody have an image, and so see himself? */
  bool has_images() const { return kind != OPEN; }
  /* That wall whose images pairs have in a law with one at most, and that which matters most to a
   * body at x when it moves alone. sign 0: there is none */
  const sd_wall &image() const { return wall[0]; }
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
};

/* "zlo at 0.5" */
std::string wall_name(const sd_wall &wall);

/* Before a run: which kind of boundary it is, and where walls at the side of the box are now.
 * Errors: directions that are periodic or not where they must not be, a side that moves or
 * leans, settings that do not go with it; a stream that does not rest where a wall is (a number
 * across it; along it a warning). */
void find_boundary(const Voice &voice, StokesSettings &settings);
/* In a step, once a run: formulas and grids must not flow through a wall, nor move on it what films
 * take to be at rest. */
void check_stream_at_walls(const Voice &voice, const Boundary &boundary, Ambient &ambient, bool films);
/* When that stands: in a layer velocities follow from forces, of free spheres of one point each */
void check_layer(const Voice &voice, const StokesSettings &settings, bool overdamped);
/* and none is held, nor moves by noise. */
void refuse_in_layer(const Voice &voice, const Boundary &boundary, const std::string &holds,
                     bool noisy);

/* A slab's box stays as it is when the run begins. */
void refuse_moving_box(const Voice &voice, const Boundary &boundary);

/* The mobility across the walls of the lone sphere that they slow down most, over that in open
 * fluid, of this rank's; 1: there is no wall. */
double least_lone_mobility(const Scene &scene);

/* Where the rows of the scene stand. Errors: the side of the box has left the wall; a centre
 * that is not in front of it. Returns how many spheres cut a wall, on all ranks. */
double spheres_cut_by_wall(const Voice &voice, const Scene &scene);

/* A sphere that is wider than a slit is an error. */
void refuse_wide_spheres(const Voice &voice, const Boundary &boundary, double largest);

/* F [width rows]: in a layer an error unless forces along it add up to 0. On all ranks */
void refuse_net_force(const Voice &voice, const Scene &scene, const std::vector<double> &F,
                      size_t width);

}    // namespace StokesDyn
#endif
