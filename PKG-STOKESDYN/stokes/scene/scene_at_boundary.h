/* The fluid and the spheres of a step at a boundary: what it refuses of them, and what walls do to lone
 * spheres. Before a run: boundary_checks.h */
#ifndef SD_SCENE_AT_BOUNDARY_H
#define SD_SCENE_AT_BOUNDARY_H

#include <vector>

namespace StokesDyn {

class Ambient;
struct Boundary;
class Scene;
class Voice;

/* Once a run: formulas and grids must not flow through a wall, nor move on it what films take to be at
 * rest. */
void check_stream_at_walls(const Voice &voice, const Boundary &boundary, Ambient &ambient, bool films);

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
