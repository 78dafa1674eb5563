#include "sd_sph_tension.h"

#include "sd_constants.h"
#include "sd_interval.h"
#include "sd_linear.h"
#include "sd_sph_symmetric.h"
#include "sd_sph_tension_internal.h"

#include <math.h>
#include <string.h>

static const sd_sph_film_loops *loops_of_films(void)
{
  return SD_KERNELS_OF(sd_sph_film_loops, baseline, sd_isa_of(SD_ISA_BEST));
}

// --- what a plane surface hides --------------------------------------------------------------------

/* Over the plane at z of h = 1, with y from its middle: the integral of W, and that of y^2 W over 2 (D-1). */
static double of_plane(sd_sph_kernel kernel, int dimension, double z, double *beta)
{
  enum { PARTS = 128 };
  const double edge = sqrt(fmax(4.0 - z * z, 0.0)), step = edge / PARTS;
  double W1 = 0.0;
  *beta = 0.0;
  for (int k = 0; k <= PARTS; k++) {
    const double y = step * k, part = (k == 0 || k == PARTS ? 1.0 : k % 2 ? 4.0 : 2.0) * step / 3.0,
                 ring = part * (dimension == 3 ? 2.0 * SD_PI * y : 2.0) *
        sd_sph_W(kernel, dimension, sqrt(z * z + y * y), 1.0);
    W1 += ring;
    *beta += ring * y * y / (2.0 * (dimension - 1));
  }
  return W1;
}

void sd_sph_surface_make(sd_sph_kernel kernel, int dimension, double h, sd_sph_surface *s)
{
  const double step = 2.0 / (SD_SPH_DEPTHS - 1);
  double unused, before = of_plane(kernel, dimension, 0.0, &s->beta[0]);
  s->kernel = kernel;
  s->dimension = dimension;
  s->h = h;
  s->W0 = sd_sph_W(kernel, dimension, 0.0, h);
  s->S0[0] = 0.5;
  for (int k = 1; k < SD_SPH_DEPTHS; k++) {
    const double middle = of_plane(kernel, dimension, step * (k - 0.5), &unused),
                 here = of_plane(kernel, dimension, step * k, &s->beta[k]);
    s->S0[k] = s->S0[k - 1] + step / 6.0 * (before + 4.0 * middle + here);
    before = here;
  }
  for (int m = 0; m <= SD_SPH_STARTS; m++)
    s->start[m] = (unsigned char) sd_interval(s->S0, SD_SPH_DEPTHS - 1, 0.5 + 0.5 * m / SD_SPH_STARTS);
}

double sd_sph_depth(const sd_sph_surface *s, double S)
{
  enum { INTERVALS = SD_SPH_DEPTHS - 1 };
  if (!(S > s->S0[0])) return 0.0;
  if (S >= s->S0[INTERVALS]) return 2.0 * s->h;
  int k = s->start[(int) (fmin(2.0 * S - 1.0, 1.0) * SD_SPH_STARTS)];
  while (S >= s->S0[k + 1]) k++;
  const double part = (S - s->S0[k]) / (s->S0[k + 1] - s->S0[k]);
  return (k + part) * 2.0 * s->h / INTERVALS;
}

static double beta_at(const sd_sph_surface *s, double z)
{
  const double at = z / (2.0 * s->h) * (SD_SPH_DEPTHS - 1);
  const int low = at < SD_SPH_DEPTHS - 2 ? (int) at : SD_SPH_DEPTHS - 2;
  return s->beta[low] + (at - low) * (s->beta[low + 1] - s->beta[low]);
}

/* Near the centre of a curvature 1 + k z vanishes: not below this. */
#define LEAST_PART 0.3

/* Sums of products of one, two and three eigenvalues k */
typedef struct {
  double k, kk, kkk;
} invariants;

static invariants invariants_of(const sd_sph_symmetric *E)
{
  const sd_sph_symmetric C = sd_sph_cofactors(E);
  return (invariants){E->a[0] + E->a[1] + E->a[2], C.a[0] + C.a[1] + C.a[2], sd_sph_determinant(E, &C)};
}

/* sum of k/(1 + k z) over the eigenvalues of E: the derivative of the product of all 1 + k z, over it; and one by one
 * only where the bound counts. All 1 + k z are above it where the sums of products of what they have more are
 * positive. */
static double at_surface(const sd_sph_symmetric *E, const invariants *of, double z)
{
  static const double MORE = 1.0 - LEAST_PART;
  const double k = z * of->k, kk = z * z * of->kk, kkk = z * z * z * of->kkk;
  if (3.0 * MORE + k > 0.0 && MORE * (3.0 * MORE + 2.0 * k) + kk > 0.0 && MORE * (MORE * (MORE + k) + kk) + kkk > 0.0)
    return (of->k + z * (2.0 * of->kk + 3.0 * z * of->kkk)) / (1.0 + k + kk + kkk);
  const double *e = E->a, full[9] = {e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2]};
  double each[3], unused[9], kappa = 0.0;
  sd_eigen(3, full, each, unused);
  for (int i = 0; i < 3; i++) kappa += each[i] / fmax(1.0 + each[i] * z, LEAST_PART);
  return kappa;
}

double sd_sph_surface_curvature(const sd_sph_surface *s, const double *A, double S, int curved)
{
  const sd_sph_symmetric E = s->dimension == 3
      ? (sd_sph_symmetric){{A[0], A[4], A[8], 0.5 * (A[1] + A[3]), 0.5 * (A[2] + A[6]), 0.5 * (A[5] + A[7])}}
      : (sd_sph_symmetric){{A[0] + A[4]}};
  const invariants of = invariants_of(&E);
  double z = sd_sph_depth(s, S), kappa = at_surface(&E, &of, z);
  for (int round = 0; curved && round < 2; round++) {
    z = sd_sph_depth(s, S + kappa * s->h * beta_at(s, z));
    kappa = at_surface(&E, &of, z);
  }
  const double most = 2.0 * (s->dimension - 1) / s->h;
  return fmax(-most, fmin(most, kappa));
}

// --- sums, walls, normals --------------------------------------------------------------------------

static int film_is_wall(const sd_sph_film *f, int i)
{
  return f->wall && f->wall[i];
}

static double volume_of(const sd_sph_film *f, int i)
{
  return fabs(f->x4[4 * (size_t) i + 3]);
}

size_t sd_sph_skin_size(const sd_sph_film *f)
{
  size_t size = SD_SPH_LANES;
  for EACH_NEAR(f, row, i)
    if (!f->wall && !sd_sph_sums_wait(f, i)) size += (size_t) f->list->count[i];
  return size;
}

void sd_sph_film_sums(const sd_sph_film *f, const sd_sph_film_rows *rows, sd_sph_skin *skin)
{
  loops_of_films()->sums(f, rows->sums, skin);
  for EACH_NEAR(f, row, i)
    if (!sd_sph_sums_wait(f, i))
      rows->sums[8 * (size_t) i + (film_is_wall(f, i) ? 4 : 0)] += f->surface->W0 * volume_of(f, i);
}

void sd_sph_film_wetness(const sd_sph_film *f, const sd_sph_film_rows *rows, double *wet)
{
  for EACH_NEAR(f, row, i) {
    const double S = rows->sums[8 * (size_t) i], Sw = rows->sums[8 * (size_t) i + 4];
    wet[i] = film_is_wall(f, i) && Sw <= 0.98 ? fmin(1.0, S / fmax(1.0 - Sw, 0.02)) : 0.0;
  }
}

void sd_sph_film_wet_walls(const sd_sph_film *f, const double *contact, const sd_sph_film_rows *rows)
{
  memset(rows->beside, 0, sizeof(double) * 8 * (size_t) f->list->n);
  loops_of_films()->wet_walls(f, contact, rows);
}

static double length3(const double *a)
{
  return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static void make_unit(double *n)
{
  const double length = length3(n);
  for (int d = 0; d < 3; d++) n[d] /= length;
}

/* What the wall says of the surface at a particle, a row of at_wall; 0 where the fluid shows no
 * direction along the wall, as in the middle of a wetted one. sums: S Gf | Sw Gw. */
static void contact_line(const sd_sph_surface *s, const double *sums, const double *beside, double row[8])
{
  const double *Gf = sums + 1, *Gw = sums + 5, of_walls = beside[6], h = s->h, Gw_size = length3(Gw);
  if (!(of_walls > 0.0) || !(Gw_size * h > 1e-3)) return;
  double e[3], t[3], along = 0.0;
  for (int d = 0; d < 3; d++) {
    e[d] = -Gw[d] / Gw_size;
    along -= Gf[d] * e[d];
  }
  for (int d = 0; d < 3; d++) t[d] = -Gf[d] - along * e[d];
  if (!(length3(t) * h > 1e-3)) return;
  make_unit(t);
  const double size = hypot(beside[4], beside[5]), cosine = beside[4] / size, sine = beside[5] / size,
               nw = fmin(1.0, 2.0 * of_walls), height = sd_sph_depth(s, 1.0 - of_walls);
  for (int d = 0; d < 3; d++) {
    row[d] = sine * t[d] + cosine * e[d];
    row[4 + d] = sine * e[d] - cosine * t[d];
  }
  row[3] = nw;
  row[7] = fmax(0.01 * h, (1.0 - nw) * height);
}

void sd_sph_film_normals(const sd_sph_film *f, const sd_sph_film_rows *rows)
{
  static const double FROM = 0.1, TO = 0.3;    // of h |G|
  const double h = f->surface->h;
  for EACH_NEAR(f, row, i) {
    if (sd_sph_sums_wait(f, i)) continue;
    const double *of = rows->sums + 8 * (size_t) i, *beside = rows->beside ? rows->beside + 8 * (size_t) i : NULL;
    double *S_G = rows->whole + 4 * (size_t) i, *n = rows->surface + 4 * (size_t) i;
    double *contact = rows->at_wall ? rows->at_wall + 8 * (size_t) i : NULL;
    memcpy(S_G, of, 4 * sizeof(double));
    memset(n, 0, 4 * sizeof(double));
    if (contact) memset(contact, 0, 8 * sizeof(double));
    if (film_is_wall(f, i)) {
      n[3] = -1.0;
      continue;
    }
    for (int c = 0; c < 4 && beside; c++) S_G[c] += beside[c];
    const double size = length3(S_G + 1);
    if (!(size * h > FROM) || (f->x4[4 * (size_t) i + 3] < 0.0 && !(of[4] > 0.0))) continue;
    n[3] = fmin(1.0, (size * h - FROM) / (TO - FROM));
    for (int d = 0; d < 3; d++) n[d] = -S_G[1 + d] / size;
    if (!beside) continue;
    contact_line(f->surface, of, beside, contact);
    if (!(contact[3] > 0.0)) continue;
    for (int d = 0; d < 3; d++) n[d] += contact[3] * (contact[d] - n[d]);
    make_unit(n);
  }
}

// --- curvature -------------------------------------------------------------------------------------

/* M^-1, eigenvalues of M kept above 0.05: a particle with few neighbours has a noisy gradient, but a bounded one. */
static sd_sph_symmetric bounded_inverse(const sd_sph_symmetric *M)
{
  static const double LEAST = 0.05;
  sd_sph_symmetric B = sd_sph_cofactors(M);
  const double det = sd_sph_determinant(M, &B), *m = M->a;
  if (sd_sph_above(M, LEAST)) {
    for (int c = 0; c < 6; c++) B.a[c] *= 1.0 / det;
    return B;
  }
  const double full[9] = {m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2]};
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  double w[3], V[9];
  sd_eigen(3, full, w, V);
  for (int c = 0; c < 6; c++) {
    B.a[c] = 0.0;
    for (int k = 0; k < 3; k++) B.a[c] += V[3 * row[c] + k] * V[3 * column[c] + k] / fmax(w[k], LEAST);
  }
  return B;
}

/* N M^-1 of a row of turns */
static void corrected_gradient(int dimension, const double *row, double gradient[9])
{
  sd_sph_symmetric M;
  memcpy(M.a, row, sizeof(M.a));
  if (dimension == 2) {
    M.a[2] = 1.0;
    M.a[4] = M.a[5] = 0.0;
  }
  const sd_sph_symmetric B = bounded_inverse(&M);
  for (int a = 0; a < 3; a++) {
    const double *N = row + 6 + 3 * a;
    gradient[3 * a] = N[0] * B.a[0] + N[1] * B.a[3] + N[2] * B.a[4];
    gradient[3 * a + 1] = N[0] * B.a[3] + N[1] * B.a[1] + N[2] * B.a[5];
    gradient[3 * a + 2] = N[0] * B.a[4] + N[1] * B.a[5] + N[2] * B.a[2];
  }
}

/* P A P, P = I - n n^T: a normal keeps its length, and does not turn along itself. What sums say of that comes from
 * neighbours that stand deeper the further they are along a bent surface: a circle had 5 % too much by it. */
static void along_surface(const double *n, double A[9])
{
  for (int side = 0; side < 2; side++)
    for (int k = 0; k < 3; k++) {
      const int at = side ? 3 * k : k, step = side ? 1 : 3;
      const double out = n[0] * A[at] + n[1] * A[at + step] + n[2] * A[at + 2 * step];
      for (int d = 0; d < 3; d++) A[at + d * step] -= out * n[d];
    }
}

size_t sd_sph_skin_weights(const sd_sph_film *f, const sd_sph_film_rows *rows, const sd_sph_skin *skin)
{
  size_t size = 0;
  for EACH_NEAR(f, row, i)
    if (rows->surface[4 * (size_t) i + 3] > 0.0) size += (size_t) skin->count[row];
  return size;
}

void sd_sph_film_curvatures(const sd_sph_film *f, const sd_sph_film_rows *rows, const double *v4, sd_sph_skin *skin,
                            double *kappa)
{
  double gradient[9];
  loops_of_films()->turns(f, rows, v4, skin);
  for (int row = 0; row < skin->size; row++) {
    const int i = skin->who[row], curved = !rows->at_wall || !(rows->at_wall[8 * (size_t) i + 3] > 0.0);
    corrected_gradient(f->surface->dimension, skin->turns + SD_SPH_SKIN_SUMS * (size_t) row, gradient);
    along_surface(rows->surface + 4 * (size_t) i, gradient);
    kappa[i] = sd_sph_surface_curvature(f->surface, gradient, rows->whole[4 * (size_t) i], curved);
  }
}

void sd_sph_film_means(const sd_sph_skin *skin, const double *k, double *mean)
{
  loops_of_films()->means(skin, k, mean);
}

void sd_sph_film_sharpen(const sd_sph_film *f, const sd_sph_film_rows *rows, const sd_sph_skin *skin,
                         const double *kappa, double *once, const double *twice)
{
  static const double SHARPER = 2.8, DEEPER = 0.16;
  const double deeper = DEEPER / (f->surface->dimension - 1) * f->surface->h;
  for (int row = 0; row < skin->size; row++) {
    const int i = skin->who[row];
    const double nw = rows->at_wall ? rows->at_wall[8 * (size_t) i + 3] : 0.0;
    const double k = (1.0 - nw) * (once[i] + SHARPER * (once[i] - twice[i])) + nw * kappa[i];
    once[i] = k * (1.0 + deeper * k);
  }
}

void sd_sph_film_inwards(const sd_sph_film *f, const sd_sph_film_rows *rows, const sd_sph_skin *skin, const double *ks,
                         double *k)
{
  loops_of_films()->means(skin, ks, k);
  for (int row = 0; row < skin->size; row++) {
    const int i = skin->who[row];
    const double w = rows->surface[4 * (size_t) i + 3];
    k[i] = w * ks[i] + (1.0 - w) * k[i];
    rows->surface[4 * (size_t) i] = ks[i];
  }
  for (int j = f->list->n; j < f->all; j++)
    if (rows->surface[4 * (size_t) j + 3] > 0.0) rows->surface[4 * (size_t) j] = ks[j];
  loops_of_films()->inwards(f, rows, k);
}

// --- force -----------------------------------------------------------------------------------------

void sd_sph_tension_forces(const sd_sph_film *f, const sd_sph_tension *t, const sd_sph_film_rows *rows,
                           const sd_sph_skin *skin, const double *k, double *F, double *area)
{
  const double factor = 2.0 * (f->surface->dimension + 2) * t->friction;
  for EACH_NEAR(f, row, i) {
    const double *S_G = rows->whole + 4 * (size_t) i, w = rows->surface[4 * (size_t) i + 3], V = volume_of(f, i);
    if (w < 0.0) continue;
    for (int d = 0; d < 3; d++) F[3 * (size_t) i + d] = 2.0 * t->sigma * V * k[i] * S_G[1 + d];
    if (w > 0.0 || S_G[0] > 0.0) area[i] = 2.0 * V * length3(S_G + 1);
  }
  for (int row = 0; row < skin->size; row++) {
    const int i = skin->who[row];
    const double rub = factor * rows->surface[4 * (size_t) i + 3] * volume_of(f, i),
                 *rubs = skin->turns + SD_SPH_SKIN_SUMS * (size_t) row + 16;
    for (int d = 0; d < 3; d++) F[3 * (size_t) i + d] += rub * rubs[d];
  }
}

void sd_sph_dry_walls(const sd_sph_film *f, double sigma, const sd_sph_film_rows *rows, const double *k,
                      const double *P, double *F)
{
  for EACH_NEAR(f, row, i) {
    const double *of = rows->sums + 8 * (size_t) i, *G = rows->whole + 4 * (size_t) i + 1;
    if (film_is_wall(f, i) || !(of[4] > 0.0)) continue;
    const double push = 2.0 * volume_of(f, i) * fmax(0.0, fmin(P[i], sigma * k[i]));
    for (int d = 0; d < 3; d++) F[3 * (size_t) i + d] += push * (of[1 + d] + of[5 + d] - G[d]);
  }
}

double sd_sph_capillary_step(double sigma, double rho, double h)
{
  return 0.25 * sqrt(rho * h * h * h / (2.0 * SD_PI * sigma));
}

double sd_sph_surface_friction(double sigma, double rho, double h)
{
  return 0.15 * sqrt(sigma * rho * h);
}

double sd_sph_ohnesorge(double mu, double sigma, double rho, double R)
{
  return mu / sqrt(rho * sigma * R);
}
