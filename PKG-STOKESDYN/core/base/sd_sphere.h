/* Volume of a sphere of radius a. */
#ifndef SD_SPHERE_H
#define SD_SPHERE_H

#include "sd_constants.h"

static inline double sd_sphere_volume(double a)
{
  return 4.0 / 3.0 * SD_PI * a * a * a;
}

#endif
