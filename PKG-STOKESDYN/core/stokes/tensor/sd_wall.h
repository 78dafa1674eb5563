/* One plane no-slip wall: what it adds to the pair tensors of sd_tensor.h, for any two radii and any
 * overlap.
 *
 * Axes of the wall: x and y along it, z across it, the fluid at z > 0. Sphere i has the height g and
 * the radius a, sphere j the height h and the radius b; R = x_i - m x_j with m = diag(1, 1, -1), so
 * that R_z = g + h; u = 1/|R|, f = m F, p = R.f, A = a^2/6, B = b^2/6, w = A + B, q = A B,
 * e = 12 R_z (A h + B g) + 24 q, Q = 120 q R_z u^7. All times 8 pi eta:
 *
 *   U_i = c1 f + (c3 p + c4 f_z) R + (c2 f_z + c5 p) z + k_ji z x T - l_ji t R - n_i t z
 *         + u^3 T_z R x z
 *   W_i = -z x (k_ij F + (l_ij p + n_j f_z) R) + u^3 (R x F)_z z
 *         + (3/2 u^3 + 2 d) T' - 3/2 u^5 (3r + R_z T_z) R' + 1/2 (d T_z + 3 u^5 R_z r) z
 *
 *   c1 = -u - 2(hg + w) u^3 + e u^5 - Q R_z      c4 = g [2u^3 + 12(B - A) u^5] - 2Q
 *   c2 = 2u + 4w u^3 + 48 q u^5                 c5 = h [2u^3 - 12(B - A) u^5] - 2Q
 *   c3 = -u^3 + 6(hg + w) u^5 - 5e u^7 + 7 Q R_z u^2
 *   k_ij = (h - g) u^3 - 12 B R_z u^5     l_ij = 60 B R_z u^7 - 6h u^5     n_j = -u^3 - 12 B u^5
 *   d = u^3 - 3 u^5 R_z^2,  t = (R x T)_z,  r = R_x T_x + R_y T_y,  ': components along the wall
 *
 * k_ji, l_ji, n_i: the spheres exchanged. There is one formula for spheres apart, overlapping and at
 * one point, since a sphere never overlaps an image; with i = j it is what the wall does to a lone
 * sphere.
 *
 * Free part and image part together are the average of the Green's function of the half-space over
 * the two surfaces. So their matrix is symmetric and positive definite for every overlap while all
 * spheres are in z >= a, touching included. A sphere that cuts the wall has the matrix that it has
 * where it touches: the whole matrix, free part included, is made with heights max(z, a).
 * Source: Blake 1971; the averages and their form are our own; one radius and no torques: Swan &
 * Brady 2007. */
#ifndef SD_WALL_H
#define SD_WALL_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* The fluid is where sign (x[axis] - at) > 0. sign 1 or -1; 0: there is no wall. */
typedef struct {
  int axis, sign;
  double at;
} sd_wall;

/* Height of x above the wall */
static inline double sd_wall_height(const sd_wall *wall, const double x[3])
{
  return wall->sign * (x[wall->axis] - wall->at);
}

/* The axes of the wall: component d along them is sign * v[axis[d]], sign that of the wall for d = 2
 * and 1 else; a rotation. Without wall those of space. */
void sd_wall_axes(const sd_wall *wall, int axis[3]);
/* x in these axes, z the height, or a where that is larger. Without wall x itself. */
void sd_wall_stand(const sd_wall *wall, const double x[3], double a, double out[3]);
/* The same place in axes of space */
void sd_wall_keep_off(const sd_wall *wall, const double x[3], double a, double out[3]);

/* The functions of a pair. of_i: k_ji l_ji n_i; of_j: k_ij l_ij n_j */
typedef struct {
  double R[3], c[5], of_i[3], of_j[3], u3, u5, d;
} sd_wall_pair;

/* xi, xj in the axes of the wall, heights at least the radii */
sd_wall_pair sd_wall_pair_of(const double xi[3], double a, const double xj[3], double b);
/* UW [width] += image part, times 8 pi eta, for FT [width] of j: width 3 or 6 */
void sd_wall_pair_add(const sd_wall_pair *w, int width, const double *FT, double *UW);
/* The block of the image part in a fluid of viscosity 1, in axes of space, row-major: rows U_i (W_i), columns
 * F_j (T_j); width 3 or 6. xi, xj in axes of space */
void sd_wall_block(const sd_wall *wall, int width, const double xi[3], double a, const double xj[3],
                   double b, double *M);

/* M [(width m)^2], row-major: RPY between m points x [3m] of radii a [m] in a fluid of viscosity 1,
 * with torques for width 6. wall: with their images in it, in axes of space; NULL: there is none */
void sd_wall_matrix(const sd_wall *wall, int m, int width, const double *x, const double *a,
                    double *M);

SD_END_C
#endif
