/* Which spheres see each other, and how: keywords of the pair style for scene, engine and far field. */
#ifndef SD_SCENE_SETTINGS_H
#define SD_SCENE_SETTINGS_H

#include "boundary.h"

#include "sd_product.h"

#include <cmath>

namespace StokesDyn {

struct SceneSettings {
  sd_tensor tensor = SD_TENSOR_RPY;
  sd_taper taper = SD_TAPER_NONE;
  double cutoff = 0.0;    // INFINITY: no cut-off
  bool clumps_only = false;
  bool rotation = false;    // vectors have force and torque, 6 numbers an atom
  /* clumps must be whole: they are rigid, or their spheres see each other and nobody else */
  bool whole = false;
  Boundary boundary;    // walls and periods
  /* how everybody sees everybody: all pairs, Ewald sums, or what costs less */
  enum { AUTO, DIRECT, EWALD };
  int far_field = AUTO;
  /* error of a product by Ewald sums over the rms of F/(6 pi eta a) */
  double far_field_tolerance = 0.0;
  // relative residual at which a solve ends: products of floats have none far below 1e-6
  double residual = 1e-3;

  bool everybody() const { return std::isinf(cutoff) && !clumps_only; }
  bool has_cutoff() const { return std::isfinite(cutoff); }
  sd_law law() const { return {tensor, taper, cutoff, boundary.image_wall()}; }
};

}    // namespace StokesDyn
#endif
