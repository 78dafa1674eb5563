#include "sd_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_room.h"

void sd_noise_free(sd_noise *s)
{
  for (int k = 0; k <= SD_NOISE_MOST; k++) free(s->row[k]);
  free(s->work);
  memset(s, 0, sizeof(*s));
}

/* The process after m products */
typedef struct {
  sd_noise *s;
  const sd_noise_matrix *M;
  int m;
  /* |w|; T: diagonal, and what couples k and k + 1 */
  double length, alpha[SD_NOISE_MOST], beta[SD_NOISE_MOST];
  /* p and c; c of the product before */
  double p[SD_NOISE_MOST], c[SD_NOISE_MOST], before[SD_NOISE_MOST];
} process;

static double noise_dot(long n, const double *a, const double *b)
{
  double sum = 0.0;
  for (long j = 0; j < n; j++) sum += a[j] * b[j];
  return sum;
}

static void noise_divide(long n, double *v, double by)
{
  for (long j = 0; j < n; j++) v[j] /= by;
}

/* --- a product --- */

/* out = P v, back: P^T v, also in its place */
static sd_status take_half(const sd_noise_matrix *M, int back, const double *v, double *out)
{
  if (M->half) return (back ? M->half_back : M->half)(M->half_ctx, v, out);
  for (long j = 0; j < M->n; j++) out[j] = M->D[j] > 0.0 ? sqrt(M->D[j]) * v[j] : 0.0;
  return SD_OK;
}

/* out = A v = P^T M P v */
static sd_status noise_apply(const process *q, const double *v, double *out)
{
  const sd_noise_matrix *M = q->M;
  double *force = q->s->work;
  sd_status status = take_half(M, 0, v, force);
  if (status == SD_OK) status = M->apply(M->ctx, force, out);
  return status == SD_OK ? take_half(M, 1, out, out) : status;
}

/* u less its components along the first `count` vectors, which are added to h; square: that of u
 * before. One sum over the ranks. */
static sd_status orthogonalise(const process *q, int count, double *u, double *h, double *square)
{
  const long n = q->M->n;
  double sums[SD_NOISE_MOST + 1];
  for (int k = 0; k < count; k++) sums[k] = noise_dot(n, q->s->row[k], u);
  sums[count] = noise_dot(n, u, u);
  const sd_status status = sd_world_sum(&q->M->world, sums, count + 1);
  if (status != SD_OK) return status;
  for (int k = 0; k < count; k++) {
    const double *v = q->s->row[k];
    h[k] += sums[k];
    for (long j = 0; j < n; j++) u[j] -= sums[k] * v[j];
  }
  *square = sums[count];
  return isfinite(*square) ? SD_OK : SD_ENOTFINITE;
}

/* One vector more, and row m of T. The second pass takes off what rounding left of the first; the
 * length after it is that before it less next to nothing. */
static sd_status extend(process *q)
{
  const int m = q->m;
  sd_noise *s = q->s;
  double h[SD_NOISE_MOST + 1] = {0.0}, square, left = 0.0;
  const size_t n = (size_t) q->M->n;
  sd_status status =
      sd_reserve(s->row + m + 1, sizeof(double), n, s->room + m + 1) ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) status = noise_apply(q, s->row[m], s->row[m + 1]);
  for (int pass = 0; pass < 2 && status == SD_OK; pass++)
    status = orthogonalise(q, m + 1, s->row[m + 1], h, pass ? &left : &square);
  if (status != SD_OK) return status;
  q->alpha[m] = h[m];
  q->beta[m] = sqrt(left);
  if (left > 0.0) noise_divide(q->M->n, s->row[m + 1], q->beta[m]);
  q->m++;
  return SD_OK;
}

/* --- roots of T --- */

/* p = T^1/2 e1 and c = T^-1/2 e1: over the eigenvectors z of T, with z_1 of each */
static sd_status take_roots(process *q)
{
  const int m = q->m;
  double d[SD_NOISE_MOST], e[SD_NOISE_MOST], work[2 * SD_NOISE_MOST];
  memcpy(q->before, q->c, sizeof(q->c));
  memcpy(d, q->alpha, sizeof(d));
  memcpy(e, q->beta, sizeof(e));
  double *Z = malloc(sizeof(double) * (size_t) m * (size_t) m);
  if (!Z) return SD_ENOMEMORY;
  sd_status status = sd_tridiagonal_eigen(m, d, e, Z, work);
  if (status == SD_OK && !(d[0] > 0.0)) status = SD_EINDEFINITE;
  for (int j = 0; j < m && status == SD_OK; j++) {
    q->p[j] = q->c[j] = 0.0;
    for (int k = 0; k < m; k++) {
      const double *z = Z + (long) k * m;
      q->p[j] += z[j] * z[0] * sqrt(d[k]);
      q->c[j] += z[j] * z[0] / sqrt(d[k]);
    }
  }
  free(Z);
  return status;
}

/* e of the last product, as the first rank has it: LAPACK's last digits need not be those of another
 * processor, and a rank that went on alone would wait for ever. */
static sd_status find_error(const process *q, double *error)
{
  double dc[SD_NOISE_MOST], sum = 0.0;
  for (int k = 0; k < q->m; k++) dc[k] = q->c[k] - (k + 1 < q->m ? q->before[k] : 0.0);
  for (int k = 0; k < q->m; k++) {
    sum += q->alpha[k] * dc[k] * dc[k];
    if (k + 1 < q->m) sum += 2.0 * q->beta[k] * dc[k] * dc[k + 1];
  }
  *error = sd_world_me(&q->M->world) == 0 ? sqrt(fmax(sum, 0.0)) : 0.0;
  return sd_world_sum(&q->M->world, error, 1);
}

/* --- all of it --- */

/* Coupled to nothing new: the vectors span all that A makes of w, and the roots are exact. */
static const double NOTHING = 1e-12;

static sd_status noise_begin(process *q, const double *w)
{
  const sd_noise_matrix *M = q->M;
  sd_noise *s = q->s;
  if (!sd_reserve(s->row, sizeof(double), (size_t) M->n, s->room) ||
      !sd_reserve(&s->work, sizeof(double), (size_t) M->n, &s->work_room))
    return SD_ENOMEMORY;
  for (long j = 0; j < M->n; j++) s->row[0][j] = M->D[j] > 0.0 ? w[j] : 0.0;
  double square = noise_dot(M->n, s->row[0], s->row[0]);
  const sd_status status = sd_world_sum(&M->world, &square, 1);
  if (status != SD_OK) return status;
  q->length = sqrt(square);
  if (q->length > 0.0) noise_divide(M->n, s->row[0], q->length);
  return isfinite(square) ? SD_OK : SD_ENOTFINITE;
}

static sd_status noise_iterate(process *q, const double *w, double tolerance, sd_noise_report *report)
{
  *report = (sd_noise_report){0};
  sd_status status = noise_begin(q, w);
  while (status == SD_OK && q->length > 0.0) {
    if ((status = extend(q)) != SD_OK) break;
    report->products = q->m;
    /* LAPACK's last digits need not be those of another rank: what is not positive there is so here */
    if ((status = sd_world_agree(&q->M->world, take_roots(q))) != SD_OK) break;
    if (q->beta[q->m - 1] <= NOTHING * fabs(q->alpha[q->m - 1])) {
      report->error = 0.0;
      break;
    }
    if ((status = find_error(q, &report->error)) != SD_OK || report->error < tolerance) break;
    if (q->m == SD_NOISE_MOST) status = SD_EMAXITER;
  }
  return status;
}

/* out = |w| V coefficients */
static void noise_combine(const process *q, const double *coefficients, double *out)
{
  memset(out, 0, sizeof(double) * (size_t) q->M->n);
  for (int k = 0; k < q->m; k++) {
    const double c = q->length * coefficients[k], *v = q->s->row[k];
    for (long j = 0; j < q->M->n; j++) out[j] += c * v[j];
  }
}

sd_status sd_noise_velocities(sd_noise *s, const sd_noise_matrix *M, const double *w, double tolerance,
                              double *y, sd_noise_report *report)
{
  process q = {.s = s, .M = M};
  const sd_status status = noise_iterate(&q, w, tolerance, report);
  if (status != SD_OK && status != SD_EMAXITER) return status;
  noise_combine(&q, q.p, y);
  if (M->half_inverse) {
    const sd_status last = M->half_inverse(M->half_ctx, y, y);
    return last == SD_OK ? status : last;
  }
  for (long j = 0; j < M->n; j++) y[j] = M->D[j] > 0.0 ? y[j] / sqrt(M->D[j]) : 0.0;
  return status;
}

void sd_noise_join(long n, double scale, const double *other, double *y)
{
  for (long j = 0; j < n; j++) y[j] = scale * (y[j] + (other ? other[j] : 0.0));
}
