/* What a boundary refuses before a run; in every step: scene_at_boundary.h; what its keywords do not go
 * with: settings.h */
#ifndef SD_BOUNDARY_CHECKS_H
#define SD_BOUNDARY_CHECKS_H

#include <string>

namespace StokesDyn {

struct Boundary;
class Voice;
struct StokesSettings;

/* Before a run: which kind of boundary it is, and where walls at the side of the box are now.
 * Errors: directions that are periodic or not where they must not be, a side that moves or
 * leans, settings that do not go with it; a stream that does not rest where a wall is (a number
 * across it; along it a warning). */
void find_boundary(const Voice &voice, StokesSettings &settings);
/* When that stands: in a layer velocities follow from forces, of free spheres of one point each */
void check_layer(const Voice &voice, const StokesSettings &settings, bool overdamped);
/* and none is held, nor moves by noise. */
void refuse_in_layer(const Voice &voice, const Boundary &boundary, const std::string &holds,
                     bool noisy);

/* A slab's box stays as it is when the run begins. */
void refuse_moving_box(const Voice &voice, const Boundary &boundary);

}    // namespace StokesDyn
#endif
