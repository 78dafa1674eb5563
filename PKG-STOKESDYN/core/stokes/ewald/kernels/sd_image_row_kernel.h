/* Kernel of the images in a wall: rows of waves times the kernels of sd_image_kernel.h. Included by
 * sd_ewald_kernels.c. */

/* So many waves at once, real and imaginary parts apart: loops over them become vectors. */
enum { WAVES = 32 };

typedef struct {
  double re[6][WAVES], im[6][WAVES];
} waves;

typedef struct {
  double re, im;
} wave;

INLINE wave times(wave a, wave b)
{
  return (wave){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

INLINE wave plus(wave a, wave b)
{
  return (wave){a.re + b.re, a.im + b.im};
}

INLINE wave less(wave a, wave b)
{
  return (wave){a.re - b.re, a.im - b.im};
}

/* f, z f -> f, z f - i gamma f */
INLINE void load_waves(const sd_image_rows *r, int side, int from, int n, waves *w)
{
  const double gamma = side ? -r->gamma : r->gamma;
  for (int c = 0; c < 6; c++)
    for (int l = 0; l < n; l++) {
      w->re[c][l] = r->row[side][c][2 * (from + l)];
      w->im[c][l] = r->row[side][c][2 * (from + l) + 1];
    }
  for (int c = 0; c < 3; c++)
    for (int l = 0; l < n; l++) {
      w->re[3 + c][l] += gamma * w->im[c][l];
      w->im[3 + c][l] -= gamma * w->re[c][l];
    }
}

/* u + i gamma u', u' */
INLINE void store_waves(const sd_image_rows *r, int side, int from, int n, const waves *w)
{
  const double gamma = side ? -r->gamma : r->gamma;
  for (int c = 0; c < 3; c++) {
    double *restrict u = r->row[side][c] + 2 * from, *restrict v = r->row[side][3 + c] + 2 * from;
    for (int l = 0; l < n; l++) {
      u[2 * l] = w->re[c][l] - gamma * w->im[3 + c][l];
      u[2 * l + 1] = w->im[c][l] + gamma * w->re[3 + c][l];
      v[2 * l] = w->re[3 + c][l];
      v[2 * l + 1] = w->im[3 + c][l];
    }
  }
}

/* The kernels at one wave; conjugate -1: at the opposite one across the wall */
INLINE wave kernel_at(const double *T, int depth, int kernel, int l, double conjugate)
{
  const double *t = T + 2L * kernel * depth + l;
  return (wave){t[0], conjugate * t[depth]};
}

/* -i sign times that */
INLINE wave odd_kernel_at(const double *T, int depth, int kernel, int l, double conjugate,
                          double sign)
{
  const wave k = kernel_at(T, depth, kernel, l, conjugate);
  return (wave){sign * k.im, -sign * k.re};
}

INLINE void multiply_waves(const double *T, int depth, int n, double conjugate, double sy,
                           const waves *in, waves *out)
{
#define F(c) ((wave){in->re[c][l], in->im[c][l]})
#define KERNEL(k) kernel_at(T, depth, SD_IMAGE_##k, l, conjugate)
#define ODD(k, sign) odd_kernel_at(T, depth, SD_IMAGE_##k, l, conjugate, sign)
#define OUT(c, value)            \
  do {                           \
    const wave v_ = value;       \
    out->re[c][l] = v_.re;       \
    out->im[c][l] = v_.im;       \
  } while (0)
  for (int l = 0; l < n; l++) { /* of velocities */
    wave G12 = KERNEL(G12);
    const wave L1 = ODD(L1, sy), L2 = ODD(L2, 1.0), none = {0.0, 0.0};
    G12.re *= sy;
    G12.im *= sy;
    OUT(0, less(none, plus(times(KERNEL(GZZ), F(0)), plus(times(L1, F(4)), times(L2, F(5))))));
    OUT(1, less(none, plus(times(KERNEL(G11), F(1)), plus(times(G12, F(2)), times(L1, F(3))))));
    OUT(2, less(none, plus(times(KERNEL(G22), F(2)), plus(times(G12, F(1)), times(L2, F(3))))));
  }
  for (int l = 0; l < n; l++) { /* of those times the height */
    wave L12 = KERNEL(L12), e0 = F(3), e1 = F(4), e2 = F(5);
    const wave L1 = ODD(L1, sy), L2 = ODD(L2, 1.0), L1z = ODD(L1Z, sy), L2z = ODD(L2Z, 1.0);
    L12.re *= sy;
    L12.im *= sy;
    e0 = plus(e0, e0);
    e1 = plus(e1, e1);
    e2 = plus(e2, e2);
    OUT(3, plus(less(plus(times(L1z, e1), times(L2z, e2)), times(KERNEL(LZZ), e0)),
                plus(times(L1, F(1)), times(L2, F(2)))));
    const wave v1 = plus(times(KERNEL(L11), e1), times(L12, e2));
    const wave v2 = plus(times(KERNEL(L22), e2), times(L12, e1));
    OUT(4, plus(less(v1, times(L1z, e0)), times(L1, F(0))));
    OUT(5, plus(less(v2, times(L2z, e0)), times(L2, F(0))));
  }
#undef F
#undef KERNEL
#undef ODD
#undef OUT
}

/* out += K f, as open_row */
INLINE void add_free(const double *K, int depth, int n, double sx, double sy, const waves *in,
                     waves *out)
{
  for (int part = 0; part < 2; part++) {
    const double *x = part ? in->im[0] : in->re[0], *y = part ? in->im[1] : in->re[1];
    const double *z = part ? in->im[2] : in->re[2];
    double *u = part ? out->im[0] : out->re[0], *v = part ? out->im[1] : out->re[1];
    double *w = part ? out->im[2] : out->re[2];
    for (int l = 0; l < n; l++) {
      const double xy = sx * sy * K[3L * depth + l], xz = sx * K[4L * depth + l];
      const double yz = sy * K[5L * depth + l];
      u[l] += K[l] * x[l] + xy * y[l] + xz * z[l];
      v[l] += xy * x[l] + K[depth + l] * y[l] + yz * z[l];
      w[l] += xz * x[l] + yz * y[l] + K[2L * depth + l] * z[l];
    }
  }
}

/* Images: each row from the forces of the opposite one. */
static void image_rows(const sd_image_rows *r)
{
  const int sides = r->row[1][0] == r->row[0][0] ? 1 : 2;
  for (int from = 0; from < r->depth; from += WAVES) {
    const int n = r->depth - from < WAVES ? r->depth - from : WAVES;
    waves in[2], out;
    for (int side = 0; side < sides; side++) load_waves(r, side, from, n, in + side);
    for (int side = 0; side < sides; side++) {
      multiply_waves(r->images + from, r->depth, n, side ? -1.0 : 1.0, r->sy,
                     in + (sides == 2 ? 1 - side : 0), &out);
      add_free(r->K + from, r->depth, n, side ? -1.0 : 1.0, r->sy, in + side, &out);
      store_waves(r, side, from, n, &out);
    }
  }
}
