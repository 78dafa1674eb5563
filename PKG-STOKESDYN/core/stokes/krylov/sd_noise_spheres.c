#include "sd_noise_spheres.h"

#include <string.h>

sd_status sd_noise_spheres_apply(void *spheres, const double *F, double *u)
{
  const sd_noise_spheres *s = spheres;
  if (s->apply) {
    for (size_t i = 0; i < s->n; i++)
      memcpy(s->F + s->engine_width * i, F + s->width * i, sizeof(double) * s->width);
    const sd_status status = s->apply(s->ctx, s->F, s->u);
    if (status != SD_OK) return status;
  }
  for (size_t i = 0; i < s->n; i++)
    for (size_t d = 0; d < s->width; d++) {
      const size_t j = s->width * i + d;
      u[j] = s->D[j] > 0.0 ? s->u[s->engine_width * i + d] + F[j] / s->D[j] : 0.0;
    }
  return SD_OK;
}

void sd_noise_spheres_add(const sd_noise_spheres *s, const double *u, double *y)
{
  for (size_t i = 0; i < s->n; i++)
    for (size_t d = 0; d < s->width; d++) y[s->width * i + d] += u[s->engine_width * i + d];
}
