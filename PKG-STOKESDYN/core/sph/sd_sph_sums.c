#include "sd_sph_sums.h"

/* Diffusion needs the gradient of the density, and M for it; shift also the disorder; correction
 * also the gradient of the velocity. */
sd_sph_level sd_sph_level_of(const sd_sph_model *model)
{
  if (model->scheme == SD_SPH_CORRECTION) return SD_SPH_VELOCITY;
  if (model->scheme == SD_SPH_SHIFT) return SD_SPH_DISORDER;
  return model->delta > 0.0 ? SD_SPH_GRADIENT : SD_SPH_RATE;
}

int sd_sph_sum_columns(sd_sph_level level)
{
  static const int columns[] = {1, 12, 16, 24};
  return columns[level];
}

int sd_sph_columns(const sd_sph_model *model)
{
  static const int columns[] = {0, 4, 8, 16};
  return columns[sd_sph_level_of(model)];
}
