#include "sd_wall.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_tensor.h"

/* Below a wall that looks down the other two axes change places: a rotation, so that torques turn as
 * forces do */
void sd_wall_axes(const sd_wall *wall, int axis[3])
{
  const int across = wall->sign ? wall->axis : 2, turned = wall->sign < 0;
  axis[0] = (across + 1 + turned) % 3;
  axis[1] = (across + 2 - turned) % 3;
  axis[2] = across;
}

void sd_wall_stand(const sd_wall *wall, const double x[3], double a, double out[3])
{
  int axis[3];
  sd_wall_axes(wall, axis);
  for (int d = 0; d < 3; d++) out[d] = x[axis[d]];
  if (wall->sign) out[2] = fmax(sd_wall_height(wall, x), a);
}

void sd_wall_keep_off(const sd_wall *wall, const double x[3], double a, double out[3])
{
  memcpy(out, x, 3 * sizeof(double));
  if (wall->sign && sd_wall_height(wall, x) < a) out[wall->axis] = wall->at + wall->sign * a;
}

sd_wall_pair sd_wall_pair_of(const double xi[3], double a, const double xj[3], double b)
{
  const double g = xi[2], h = xj[2], A = a * a / 6.0, B = b * b / 6.0;
  const double x = xi[0] - xj[0], y = xi[1] - xj[1], z = g + h;
  const double u = 1.0 / sqrt(x * x + y * y + z * z), u2 = u * u, u3 = u * u2, u5 = u3 * u2;
  const double w = A + B, q = A * B, e = 12.0 * z * (A * h + B * g) + 24.0 * q;
  const double Q = 120.0 * q * z * u5 * u2, s = 2.0 * (h * g + w), v = 12.0 * (B - A) * u5;
  return (sd_wall_pair){
      .R = {x, y, z},
      .c = {-u - s * u3 + e * u5 - Q * z, 2.0 * u + 4.0 * w * u3 + 48.0 * q * u5,
            -u3 + (3.0 * s - 5.0 * e * u2) * u5 + 7.0 * Q * z * u2, g * (2.0 * u3 + v) - 2.0 * Q,
            h * (2.0 * u3 - v) - 2.0 * Q},
      .of_i = {(g - h) * u3 - 12.0 * A * z * u5, (60.0 * A * z * u2 - 6.0 * g) * u5,
               -u3 - 12.0 * A * u5},
      .of_j = {(h - g) * u3 - 12.0 * B * z * u5, (60.0 * B * z * u2 - 6.0 * h) * u5,
               -u3 - 12.0 * B * u5},
      .u3 = u3,
      .u5 = u5,
      .d = u3 - 3.0 * u5 * z * z};
}

void sd_wall_pair_add(const sd_wall_pair *w, int width, const double *FT, double *UW)
{
  const double *R = w->R, *c = w->c, *F = FT, *T = FT + 3, *i = w->of_i, *j = w->of_j;
  const double p = R[0] * F[0] + R[1] * F[1] - R[2] * F[2];
  double along = c[2] * p - c[3] * F[2], up = c[4] * p - c[1] * F[2];
  if (width == 6) {
    const double t = R[0] * T[1] - R[1] * T[0], r = R[0] * T[0] + R[1] * T[1];
    const double turn = j[1] * p - j[2] * F[2], self = 1.5 * w->u3 + 2.0 * w->d;
    const double back = 1.5 * w->u5 * (3.0 * r + R[2] * T[2]);
    along -= i[1] * t;
    up -= i[2] * t;
    UW[0] += w->u3 * T[2] * R[1] - i[0] * T[1];
    UW[1] += i[0] * T[0] - w->u3 * T[2] * R[0];
    UW[3] += j[0] * F[1] + turn * R[1] + self * T[0] - back * R[0];
    UW[4] += self * T[1] - back * R[1] - j[0] * F[0] - turn * R[0];
    UW[5] += w->u3 * (R[0] * F[1] - R[1] * F[0]) +
        0.5 * (w->d * T[2] + 3.0 * w->u5 * R[2] * r);
  }
  UW[0] += c[0] * F[0] + along * R[0];
  UW[1] += c[0] * F[1] + along * R[1];
  UW[2] += up - c[0] * F[2] + along * R[2];
}

void sd_wall_block(const sd_wall *wall, int width, const double xi[3], double a, const double xj[3],
                   double b, double *M)
{
  const double unit = 1.0 / (8.0 * SD_PI);
  double at_i[3], at_j[3];
  int axis[3];
  sd_wall_axes(wall, axis);
  sd_wall_stand(wall, xi, a, at_i);
  sd_wall_stand(wall, xj, b, at_j);
  const sd_wall_pair pair = sd_wall_pair_of(at_i, a, at_j, b);
  for (int q = 0; q < width; q++) {
    double FT[6] = {0.0}, UW[6] = {0.0};
    FT[q] = q % 3 == 2 ? wall->sign * unit : unit;
    sd_wall_pair_add(&pair, width, FT, UW);
    const int column = q - q % 3 + axis[q % 3];
    for (int p = 0; p < width; p++)
      M[width * (p - p % 3 + axis[p % 3]) + column] = p % 3 == 2 ? wall->sign * UW[p] : UW[p];
  }
}

/* Each pair of points, whose blocks are the transposed ones of each other, and 1/(6 pi a),
 * 1/(8 pi a^3) on the diagonal (r = 0). */
void sd_wall_matrix(const sd_wall *wall, int m, int width, const double *x, const double *a,
                    double *M)
{
  static const sd_wall none = {.sign = 0};
  const size_t w = (size_t) width, N = w * (size_t) m;
  if (!wall) wall = &none;
  for (size_t i = 0; i < (size_t) m; i++)
    for (size_t j = i; j < (size_t) m; j++) {
      double xi[3], xj[3], block[36], image[36] = {0.0};
      sd_wall_keep_off(wall, x + 3 * i, a[i], xi);
      sd_wall_keep_off(wall, x + 3 * j, a[j], xj);
      const double r[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
      if (width == 6)
        sd_tensor_grand(r, a[i], a[j], 1.0, block);
      else
        sd_tensor_uf(SD_TENSOR_RPY, r, a[i], a[j], 1.0, block);
      if (wall->sign) sd_wall_block(wall, width, xi, a[i], xj, a[j], image);
      for (size_t p = 0; p < w; p++)
        for (size_t q = 0; q < w; q++)
          M[(w * i + p) * N + w * j + q] = M[(w * j + q) * N + w * i + p] =
              block[w * p + q] + image[w * p + q];
    }
}
