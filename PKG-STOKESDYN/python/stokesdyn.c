/* libstokesdyn.so: what the Python module stokesdyn/clump.py calls, with flat arrays. Everything else of the
 * core is hidden in it; C programs link the static libraries instead. */
#include "sd_clump.h"
#include "sd_linear.h"

#include <math.h>

#define EXPORT __attribute__((visibility("default")))

/* clump.py has the same in the same order. Viscosity 1; rows force, torque, columns velocity,
 * angular velocity (resistance), and the other way round (mobility), about the centre. */
typedef struct {
  double resistance[36], mobility[36];
  /* of hydrodynamic stress, in the axes of the spheres; hydrodynamic radius */
  double centre[3], radius;
  /* bytes that a dense and an iterative solve need, also where there was none */
  double dense, iterative;
  /* points of all spheres; iterations of the longest solve, 0: dense */
  int points, iterations;
} result;

EXPORT const char *stokesdyn_version(void)
{
  return SD_VERSION;
}

EXPORT const char *stokesdyn_status(int status)
{
  return sd_status_string((sd_status) status);
}

/* Resistance of the rigid clump of n spheres at x [3n] with radii a [n]. shell, rotation, memory: see
 * sd_clump_options. Returns SD_OK, or the status of sd_linear_room, sd_shape_create or sd_clump_create. */
EXPORT int stokesdyn_clump(int n, const double *x, const double *a, int shell, int rotation,
                           double memory, result *out)
{
  sd_clump_options options = SD_CLUMP_OPTIONS;
  options.shell = shell;
  options.rotation = rotation;
  options.memory = memory;
  sd_shape shape;
  sd_status status = sd_linear_room();
  if (status != SD_OK) return status;
  status = sd_shape_create(n, x, a, &shape);
  if (status != SD_OK) return status;
  sd_shells shells = {0};
  sd_clump clump;
  sd_clump_need need = {0};
  status = sd_clump_create(&shape, &options, &shells, &clump, &need);
  out->dense = need.dense;
  out->iterative = need.iterative;
  if (status == SD_OK) {
    for (int k = 0; k < 36; k++) {
      out->resistance[k] = clump.R_centre[k];
      out->mobility[k] = clump.mobility[k];
    }
    for (int d = 0; d < 3; d++) {
      out->centre[d] = clump.centre[d];
      for (int k = 0; k < n; k++) out->centre[d] += x[3 * k + d] / n;
      if (fabs(out->centre[d]) < 1e-12 * shape.size) out->centre[d] = 0.0;    // rounding
    }
    out->radius = clump.radius;
    out->points = clump.points;
    out->iterations = clump.iterations;
    sd_clump_free(&clump);
  }
  sd_shells_free(&shells);
  sd_shape_free(&shape);
  return status;
}
