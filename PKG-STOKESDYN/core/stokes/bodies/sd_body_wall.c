#include "sd_body_wall.h"

#include <math.h>
#include <stdlib.h>

#include "sd_linear.h"
#include "sd_tensor.h"

void sd_body_wall_matrix(const sd_wall *wall, int m, int width, const double *x, const double *a,
                         double *M)
{
  const size_t w = (size_t) width, N = w * (size_t) m;
  for (size_t i = 0; i < (size_t) m; i++)
    for (size_t j = 0; j < (size_t) m; j++) {
      const double *xi = x + 3 * i, *xj = x + 3 * j;
      const double g = fmax(sd_wall_height(wall, xi), a[i]);
      double r[3], block[36], image[36];
      sd_minus(xi, xj, r);
      r[wall->axis] = wall->sign * (g - fmax(sd_wall_height(wall, xj), a[j]));
      sd_tensor_grand(r, a[i], a[j], 1.0, block);
      sd_wall_block(wall, width, xi, a[i], xj, a[j], 1.0, image);
      for (size_t p = 0; p < w; p++)
        for (size_t q = 0; q < w; q++)
          M[(w * i + p) * N + w * j + q] = block[6 * p + q] + image[w * p + q];
    }
}

sd_status sd_body_wall_shape(const sd_wall *wall, int m, int width, const double *x,
                             const double *a, const double centre[3], sd_body_shape *out)
{
  const size_t N = (size_t) width * (size_t) m;
  double *M = malloc(sizeof(double) * (N * N + 3 * (size_t) m)), *arm = M + N * N;
  *out = (sd_body_shape){0};
  if (!M) return SD_ENOMEMORY;
  sd_body_wall_matrix(wall, m, width, x, a, M);
  for (size_t k = 0; k < (size_t) m; k++) sd_minus(x + 3 * k, centre, arm + 3 * k);
  const sd_status status = sd_body_shape_of(m, width, arm, M, out);
  free(M);
  return status;
}

int sd_body_wall_pays(int m, int bodies, double height, double extent)
{
  return height < 10.0 * extent && (m <= SD_BODY_WALL_SMALL || m <= 3.0 * bodies);
}
