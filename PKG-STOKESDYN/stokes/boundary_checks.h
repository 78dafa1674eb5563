/* What a boundary refuses, before a run and in every step; what its keywords do not go with: settings. */
#ifndef SD_BOUNDARY_CHECKS_H
#define SD_BOUNDARY_CHECKS_H

#include <string>
#include <vector>

namespace StokesDyn {

class Ambient;
struct Boundary;
class Scene;
class Voice;
struct StokesSettings;

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
