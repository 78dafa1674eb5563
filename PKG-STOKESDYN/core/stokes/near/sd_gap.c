#include "sd_gap.h"

#include "sd_linear.h"
#include "sd_neighbor.h"

#include <math.h>

sd_status sd_smallest_gap(const double *x, const double *a, const int64_t *body, int n, int n_all,
                          double reach, double *gap)
{
  sd_neighbors list = {0};
  const sd_status status = sd_neighbors_cutoff(&list, x, n, n_all, reach);
  *gap = INFINITY;
  for (int i = 0; i < n && status == SD_OK; i++)
    for (long k = list.pairs.first[i]; k < list.pairs.first[i + 1]; k++) {
      const int j = list.pairs.neighbor[k];
      if (body && body[i] != 0 && body[i] == body[j]) continue;
      const double R = sqrt(sd_distance_squared(x + 3 * (long) i, x + 3 * (long) j));
      *gap = fmin(*gap, 2.0 * (R / (a[i] + a[j]) - 1.0));
    }
  sd_neighbors_free(&list);
  return status;
}
