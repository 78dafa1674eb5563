/* Where spheres stand on the grid. Included by sd_ewald_kernels.c. Loops are so short that the compiler makes
 * vectors of them. */

/* Along d: the first points, and v of sd_window.h */
INLINE void stand_along(sd_standing *s, int d, int many, int *restrict corner, real *restrict v)
{
  const double *x = s->x[0], *y = s->x[1], *z = s->x[2], *own = s->x[d], *G = s->gradient[d], *o = s->origin;
  const double shift = s->shift, lo = s->lo[d], hi = s->hi[d];
  double at[SD_STAND_MANY], below[SD_STAND_MANY];
  for (int i = 0; i < many; i++)
    at[i] = shift + (G[0] * (x[i] - o[0]) + G[1] * (y[i] - o[1]) + G[2] * (z[i] - o[2]));
  for (int i = 0; i < many; i++) {
    const double here = own[i] >= lo && own[i] <= hi ? at[i] : (double) SD_NOT_THERE;
    at[i] = fabs(here) < SD_NOT_THERE ? here : (double) SD_NOT_THERE;
  }
  for (int i = 0; i < many; i++) {
    const double towards = (double) (int) at[i];
    below[i] = towards - (at[i] < towards ? 1.0 : 0.0);
  }
  for (int i = 0; i < many; i++) corner[i] = 1 + (int) below[i];
  for (int i = 0; i < many; i++) v[i] = (real) (2.0 * (at[i] - below[i]) - 1.0);
  int first = s->first[d], last = s->last[d];
  int64_t sum = 0;
  for (int i = 0; i < many; i++) {
    first = corner[i] < first ? corner[i] : first;
    last = corner[i] > last ? corner[i] : last;
    sum += corner[i];
  }
  s->first[d] = first;
  s->last[d] = last;
  s->sum[d] += sum;
}

static void stand_on_grid(sd_standing *s, int many, int (*corner)[3], void *place)
{
  real(*to)[4] = place, v[4][SD_STAND_MANY];
  int at[3][SD_STAND_MANY], unlike = 0;
  for (int d = 0; d < 3; d++) stand_along(s, d, many, at[d], v[d]);
  for (int i = 0; i < many; i++) unlike |= s->a[i] != s->a_ref;
  for (int i = 0; i < many; i++) v[3][i] = (real) ((s->a[i] - s->a_ref) * (s->a[i] + s->a_ref) / 6.0);
  s->equal &= !unlike;
  for (int i = 0; i < many; i++) {
    for (int d = 0; d < 3; d++) corner[i][d] = at[d][i];
    for (int d = 0; d < 4; d++) to[i][d] = v[d][i];
  }
}
