#include "sd_lubrication.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_lubrication_internal.h"
#include "sd_room.h"
#include "sd_tensor.h"

static sd_status reserve_spheres(sd_lubrication *L, const sd_lubrication_scene *s)
{
  struct sd_lubrication_work *w = L->work;
  const size_t all = (size_t) s->n_all, number = sizeof(double);
  L->n = s->n;
  L->n_all = s->n_all;
  L->world = s->world;
  if (s->n_all < w->most_spheres) return SD_OK;
  if (!sd_grow(&w->identity, sizeof(*w->identity), all) || !sd_grow(&w->neighbours, number, all) ||
      !sd_grow(&w->flow, 6 * number, all) || !sd_grow(&L->diagonal, SD_LUBRICATION_OWN * number, all) ||
      !sd_grow(&L->carried, 6 * number, all) || !sd_grow(&L->others, 6 * number, all))
    return SD_ENOMEMORY;
  w->most_spheres = s->n_all + 1;
  return SD_OK;
}

static sd_status keep_drift(sd_lubrication *L, const sd_lubrication_scene *s)
{
  struct sd_lubrication_work *w = L->work;
  const size_t others = 3 * (size_t) (s->n_all - s->n);
  w->drifts = s->drift != NULL;
  if (!w->drifts) return SD_OK;
  if (!sd_reserve(&w->drift, sizeof(double), others, &w->most_drifts)) return SD_ENOMEMORY;
  if (others > 0) memcpy(w->drift, s->drift, sizeof(double) * others);
  return SD_OK;
}

/* Once the pairs are known */
static sd_status reserve_noise(sd_lubrication *L, const sd_lubrication_scene *s)
{
  struct sd_lubrication_work *w = L->work;
  const size_t alone = 36 * (size_t) L->n;
  w->noisy = s->noisy;
  if (!s->noisy) return SD_OK;
  if (!sd_reserve(&w->whole, sizeof(*w->whole), (size_t) L->count, &w->most_whole) ||
      !sd_reserve(&w->alone, sizeof(double), alone, &w->most_alone))
    return SD_ENOMEMORY;
  if (alone > 0) memset(w->alone, 0, sizeof(double) * alone);
  return SD_OK;
}

static sd_status count_neighbours(sd_lubrication *L, const sd_lubrication_scene *s)
{
  if (s->films) return SD_OK; /* nothing is shared */
  double *n = L->work->neighbours;
  memset(n, 0, sizeof(double) * (size_t) s->n_all);
  for (long k = 0; k < L->count; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    const double t = weight_of_film(s, i, L->work->close + k);
    n[i] += t;
    if (j != i && j < L->n) n[j] += t;
  }
  return s->world.refresh ? s->world.refresh(s->world.ctx, n, n + s->n, 1) : SD_OK;
}

/* u of all, those of others from where they are known; most fluids rest */
static sd_status find_flow(sd_lubrication *L, const sd_lubrication_scene *s)
{
  double *flow = L->work->flow;
  sd_status status = SD_OK;
  memset(L->carried, 0, sizeof(double) * 6 * (size_t) s->n);
  L->work->flows = 0;
  L->work->images = 0;
  if (!s->u || s->films) return SD_OK;
  memcpy(flow, s->u, sizeof(double) * 6 * (size_t) s->n);
  if (s->world.refresh) status = s->world.refresh(s->world.ctx, flow, flow + 6 * (long) s->n, 6);
  for (long j = 0; s->drift && j < s->n_all - s->n; j++)
    for (int d = 0; d < 3; d++) flow[6 * (s->n + j) + d] += s->drift[3 * j + d];
  for (long j = 0; j < 6 * (long) s->n_all; j++) L->work->flows |= flow[j] != 0.0;
  if (status != SD_OK || !L->work->flows) return status;
  if (!sd_reserve(&L->strain, sizeof(double), 7 * (size_t) s->n, &L->work->most_strains)) return SD_ENOMEMORY;
  memset(L->strain, 0, sizeof(double) * 7 * (size_t) s->n);
  return SD_OK;
}

/* V_inf of a pair at x, each of its two spheres 6 numbers */
static void rigid_part(const double *const x[2], const double a[2], const double *const u[2],
                       double V[2][6])
{
  double mean[6], d[3];
  for (int e = 0; e < 6; e++) mean[e] = (a[0] * u[0][e] + a[1] * u[1][e]) / (a[0] + a[1]);
  sd_minus(x[1], x[0], d);
  for (int k = 0; k < 2; k++) { /* x_1 - c = -a_2 d/(a_1 + a_2), x_2 - c = a_1 d/(a_1 + a_2) */
    const double part = (k ? a[0] : -a[1]) / (a[0] + a[1]),
                 arm[3] = {part * d[0], part * d[1], part * d[2]};
    sd_cross(mean + 3, arm, V[k]);
    for (int e = 0; e < 3; e++) {
      V[k][e] += mean[e];
      V[k][3 + e] = mean[3 + e];
    }
  }
}

/* Of the two spheres of a pair, as one rigid body: V_inf, and e */
typedef struct {
  double V[2][6], e[2][6];
} carriage;

/* What the flow does to sphere i, the first or the second of a pair, from its own block and that with
 * the other */
static void film_carry(sd_lubrication *L, long i, int second, sd_lubrication_link own,
                       sd_lubrication_link with, const carriage *c)
{
  double force[6] = {0.0}, *strain = L->strain + 7 * i;
  add_product(&own, c->V[second], force);
  add_product(&with, c->V[!second], force);
  add_product(&own, c->e[second], strain);
  add_product(&with, c->e[!second], strain);
  for (int k = 0; k < 6; k++) {
    L->carried[6 * i + k] += force[k];
    strain[6] += c->e[second][k] * force[k];
  }
}

/* What the flow does to pair k: to its first sphere, and to its second if that is this rank's */
static void add_carried(sd_lubrication *L, const sd_lubrication_scene *s, long k,
                        const sd_pair_resistance *R)
{
  const int i = L->pair[k][0], j = L->pair[k][1], at = L->work->close[k].at;
  const sd_spheres *p = &s->spheres;
  const double *flow = L->work->flow, *d = L->link[k].d;
  const double *u[2] = {flow + 6 * (long) i, flow + 6 * (long) at};
  const sd_lubrication_link B12 = block_of(R, 1, d);
  carriage c;
  rigid_part((const double *const[]){p->x + 3 * (long) i, p->x + 3 * (long) at},
             (const double[]){p->a[i], p->a[at]}, u, c.V);
  for (int q = 0; q < 12; q++) c.e[q / 6][q % 6] = c.V[q / 6][q % 6] - u[q / 6][q % 6];
  /* L V is of velocities without the drift: what that makes of V_inf is left */
  for (int q = 0; q < 3; q++) c.V[1][q] -= drift_at(L, at)[q];
  film_carry(L, i, 0, block_of(R, 0, d), B12, &c);
  if (j < L->n && j != i) film_carry(L, j, 1, block_of(R, 2, d), exchanged(B12), &c);
}

/* x^1.2, 0 < x <= 1; pow() would take a good part of all. x^-0.2 by Newton's steps from a guess,
 * its bits over -5, within 0.04; each step squares the error and takes it threefold: 7e-16. */
static double shared(double x)
{
  uint64_t bits;
  double root;
  memcpy(&bits, &x, sizeof bits);
  bits = 0x4cb8cccccccccc00u - bits / 5;
  memcpy(&root, &bits, sizeof root);
  for (int k = 0; k < 4; k++) {
    const double square = root * root;
    root *= 1.2 - 0.2 * x * square * square * root;
  }
  return x / root;
}

/* t [ w D + (1 - w) Q^T D Q ] or t times the film; eta: of the pair. model: what the model resists of
 * an approach, fading from contact to the range */
static sd_status resistance_of(const sd_lubrication *L, const sd_lubrication_scene *s, long k,
                               double eta, sd_pair_resistance *R, double *model)
{
  const closeness *c = L->work->close + k;
  const int i = L->pair[k][0];
  const double *n = L->work->neighbours, ai = s->spheres.a[i], aj = s->spheres.a[c->at];
  const double gap = gap_of_film(s, i, c), t = weight_of_film(s, i, c);
  const double scale = t * eta, xi = gap > s->gap ? gap : s->gap, apart = gap > 0.0 ? gap : 0.0;
  const double fading = film_fading(apart / film_range_of(s, ai, aj)), closest = 0.01 * (ai + aj);
  if (!s->films) {
    *model = fading * sd_rpy_approach((1.0 + 0.5 * apart) * (ai + aj), ai, aj, eta);
    const double share = shared(2.0 * t / (n[i] + n[c->at]));
    return sd_two_sphere_correction(s->functions, ai, aj, xi, scale * share, scale * (1.0 - share),
                                    R);
  }
  sd_film film;
  const sd_status status = s->points
      ? sd_film_between(s->films, s->points[i], s->points[c->at], ai, aj, xi, &film)
      : sd_film_at(s->films, ai, aj, xi, &film);
  if (status != SD_OK) return status;
  *R = sd_film_resistance(&film, c->distance > closest ? c->distance : closest, scale);
  *model = fading * eta * film.shells_approach;
  return SD_OK;
}

/* Films: forces are L V - carried; the drift of pair k, R its film, goes into `carried`. */
static void film_drift(sd_lubrication *L, long k, const sd_pair_resistance *R)
{
  const int i = L->pair[k][0], j = L->pair[k][1];
  const double *d = L->link[k].d, *drift = drift_at(L, L->work->close[k].at);
  const sd_lubrication_link B12 = block_of(R, 1, d), B22 = block_of(R, 2, d);
  const double V[6] = {-drift[0], -drift[1], -drift[2], 0.0, 0.0, 0.0};
  add_product(&B12, V, L->carried + 6 * (long) i);
  if (j < L->n && j != i) add_product(&B22, V, L->carried + 6 * (long) j);
}

/* Keeps the film of a sphere with its own image for the stress; 0: out of memory. */
static int film_remember(sd_lubrication *L, long k, const sd_pair_resistance *R)
{
  struct sd_lubrication_work *w = L->work;
  if (!sd_extend(&w->image, sizeof(*w->image), (size_t) w->images + 1, &w->image_room)) return 0;
  w->image[w->images++] = (own_image){k, block_of(R, 1, L->link[k].d)};
  return 1;
}

/* L_ii += a block 11 or 22 of a pair, in which YB12 is YB21 */
static void film_add_own(sd_lubrication *L, long i, const sd_lubrication_link *l)
{
  const double *d = l->d;
  double *FU = L->diagonal + SD_LUBRICATION_OWN * i, *TW = FU + 6, *FW = TW + 6;
  for (int p = 0; p < 3; p++) {
    const int q = (p + 1) % 3, r = (p + 2) % 3;
    FU[p] += l->YA + (l->XA - l->YA) * d[p] * d[p];
    TW[p] += l->YC + (l->XC - l->YC) * d[p] * d[p];
    FU[sd_symmetric3_at(p, q)] += (l->XA - l->YA) * d[p] * d[q];
    TW[sd_symmetric3_at(p, q)] += (l->XC - l->YC) * d[p] * d[q];
    FW[3 * p + r] += l->YB21 * d[q];
    FW[3 * p + q] -= l->YB21 * d[r];
  }
}

static sd_status add_pair(sd_lubrication *L, const sd_lubrication_scene *s, long k)
{
  const int i = L->pair[k][0], j = L->pair[k][1];
  const closeness *c = L->work->close + k;
  const double *w = s->spheres.w;
  const double eta = 0.5 * (1.0 / (w[i] * w[i]) + 1.0 / (w[c->at] * w[c->at]));
  sd_pair_resistance R;
  const sd_status status = resistance_of(L, s, k, eta, &R, L->model + k);
  if (status != SD_OK) return status;
  sd_lubrication_link *link = L->link + k, own = block_of(&R, 0, link->d);
  if (s->noisy && k < L->count)
    L->work->whole[k] = (whole_pair){
        R, {link->d[0], link->d[1], link->d[2]}, 0.5 * (s->spheres.a[i] + s->spheres.a[c->at])};
  if (L->work->flows && i < L->n) add_carried(L, s, k, &R);
  if (s->films && s->drift && i < L->n) film_drift(L, k, &R);
  if (i < L->n) film_add_own(L, i, &own);
  *link = block_of(&R, 1, link->d);
  if (j == i) { /* an image on either side: what their 12 and 21 have in UW and WU cancels */
    link->YB12 = link->YB21 = 0.0;
    film_add_own(L, i, link);
    if (s->films && !film_remember(L, k, &R)) return SD_ENOMEMORY;
    *link = (sd_lubrication_link){.XA = 0.0};
  } else if (j < L->n) {
    own = block_of(&R, 2, link->d);
    film_add_own(L, j, &own);
  }
  return SD_OK;
}

sd_status sd_lubrication_place(sd_lubrication *L, const sd_lubrication_scene *scene)
{
  if (!L->work) L->work = calloc(1, sizeof(*L->work));
  if (!L->work) return SD_ENOMEMORY;
  sd_status status = reserve_spheres(L, scene);
  if (status == SD_OK) status = keep_drift(L, scene);
  if (status == SD_OK) status = sd_lubrication_find_pairs(L, scene);
  if (status == SD_OK) status = reserve_noise(L, scene);
  if (status == SD_OK) status = count_neighbours(L, scene);
  if (status == SD_OK) status = find_flow(L, scene);
  if (status != SD_OK) return status;
  memset(L->diagonal, 0, sizeof(double) * SD_LUBRICATION_OWN * (size_t) L->n);
  const long pairs = L->count + L->beyond;
  for (long k = 0; k < pairs && status == SD_OK; k++) {
    /* the second sphere of a pair may be anywhere in memory */
    sd_fetch(L->diagonal + SD_LUBRICATION_OWN * (long) L->pair[k + 6 < pairs ? k + 6 : k][1]);
    status = add_pair(L, scene, k);
  }
  return status;
}

void sd_lubrication_add_own(sd_lubrication *L, int i, const double B[36], const double E[6])
{
  double *FU = L->diagonal + SD_LUBRICATION_OWN * (long) i, *TW = FU + 6, *FW = TW + 6;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      if (p >= q) FU[sd_symmetric3_at(p, q)] += B[6 * p + q];
      if (p >= q) TW[sd_symmetric3_at(p, q)] += B[6 * (3 + p) + 3 + q];
      FW[3 * p + q] += B[6 * p + 3 + q];
    }
  for (long e = 0; e < 36 && L->work->noisy; e++) L->work->alone[36L * i + e] += B[e];
  for (long k = 0; k < 6; k++) L->carried[6L * i + k] += E[k];
}

void sd_lubrication_add_block(const sd_lubrication_link *l, double B[36])
{
  const double *d = l->d;
  for (int p = 0; p < 3; p++) { /* q, r: the next two, (d x v)_p = d_q v_r - d_r v_q */
    const int q = (p + 1) % 3, r = (p + 2) % 3;
    double *F = B + 6 * p, *T = F + 18;
    for (int e = 0; e < 3; e++) {
      F[e] += (l->XA - l->YA) * d[p] * d[e];
      T[3 + e] += (l->XC - l->YC) * d[p] * d[e];
    }
    F[p] += l->YA;
    T[3 + p] += l->YC;
    F[3 + r] += l->YB21 * d[q];
    F[3 + q] -= l->YB21 * d[r];
    T[r] -= l->YB12 * d[q];
    T[q] += l->YB12 * d[r];
  }
}

void sd_lubrication_own_block(const sd_lubrication *L, long i, double B[36])
{
  const double *FU = L->diagonal + SD_LUBRICATION_OWN * i, *TW = FU + 6, *FW = TW + 6;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      B[6 * p + q] = FU[sd_symmetric3_at(p, q)];
      B[6 * (3 + p) + 3 + q] = TW[sd_symmetric3_at(p, q)];
      B[6 * p + 3 + q] = B[6 * (3 + q) + p] = FW[3 * p + q];
    }
}

void sd_lubrication_free(sd_lubrication *L)
{
  if (L->work) {
    sd_near_free(&L->work->near);
    free(L->work->identity);
    free(L->work->neighbours);
    free(L->work->flow);
    free(L->work->close);
    free(L->work->drift);
    free(L->work->image);
    free(L->work->whole);
    free(L->work->alone);
    free(L->work);
  }
  free(L->pair);
  free(L->link);
  free(L->model);
  free(L->diagonal);
  free(L->carried);
  free(L->strain);
  free(L->others);
  memset(L, 0, sizeof(*L));
}
