#include "sd_rate.h"

#include <math.h>

sd_status sd_rate(const sd_decay *of, int products, double *v, double *work, double *rate)
{
  *rate = 0.0;
  for (int k = 0; k < products; k++) {
    double sums[3] = {0.0, 0.0, 0.0};
    sd_status status = of->apply(of->ctx, v, work);
    for (long j = 0; j < of->n; j++) {
      sums[0] += v[j] * work[j];
      sums[1] += v[j] * of->W[j] * v[j];
      sums[2] += work[j] * work[j] / of->W[j];
    }
    if (status == SD_OK) status = sd_world_sum(of->world, sums, 3);
    if (status != SD_OK) return status;
    if (!isfinite(sums[0]) || !isfinite(sums[2])) return SD_ENOTFINITE;
    if (!(sums[2] > 0.0)) return SD_OK;
    *rate = fmax(*rate, sums[0] / sums[1]);
    const double scale = 1.0 / sqrt(sums[2]); /* v.W v = 1 */
    for (long j = 0; j < of->n; j++) v[j] = scale * work[j] / of->W[j];
  }
  return SD_OK;
}
