/* What the files of sd_lubrication.h share. */
#ifndef SD_LUBRICATION_INTERNAL_H
#define SD_LUBRICATION_INTERNAL_H

#include <math.h>

#include "sd_isa.h"
#include "sd_linear.h"
#include "sd_lubrication.h"

/* How far the centres of a pair are apart; and where its second sphere stands: itself, or its image */
typedef struct {
  double distance;
  int at;
} closeness;

/* Which sphere stands here: its rank, its row there, its body. As long as three numbers, as which others
 * send it: they copy bits, and IDs above 2^53 stay what they are */
typedef struct {
  double rank, row;
  int64_t body;
} identity;

/* The film of a sphere with its own image: pair k, and its block 12 */
typedef struct {
  long k;
  sd_lubrication_link film;
} own_image;

/* All of a pair, for its random forces: L_11, L_12 and L_22, d from its first sphere to the
 * second, its mean radius */
typedef struct {
  sd_pair_resistance R;
  double d[3], a;
} whole_pair;

struct sd_lubrication_work {
  sd_near near;
  /* [n_all] whose each is; n_i; u [6] */
  identity *identity;
  double *neighbours, *flow;
  /* [3 (n_all - n)] where images drift */
  double *drift;
  int drifts;
  size_t most_drifts;
  /* some u is not 0 */
  int flows;
  /* [count] */
  closeness *close;
  /* [count] where the scene is noisy, and [36 n] what spheres resist alone; else NULL or old */
  whole_pair *whole;
  double *alone;
  size_t most_whole, most_alone, most_strains;
  int noisy;
  /* films */
  own_image *image;
  long images;
  size_t image_room;
  long most_spheres, most_pairs;
};

struct sd_lubrication_kernels {
  /* as sd_lubrication_apply_both, where the others' velocities are known */
  void (*times)(const sd_lubrication *L, const double *own, const double *c, const double *V, double *out);
};

SD_KERNEL_TABLES(struct sd_lubrication_kernels, sd_lubrication);

/* Finds the pairs of a scene, `close` of each and the d of its link, and how many there are. On all ranks
 * together. SD_OK; SD_ENOMEMORY; that of refresh. */
sd_status sd_lubrication_find_pairs(sd_lubrication *L, const sd_lubrication_scene *s);

/* Of a pair, over its mean radius */
static inline double film_range_of(const sd_lubrication_scene *s, double ai, double aj)
{
  const double sum = ai + aj;
  return s->points ? s->range * 4.0 * ai * aj / (sum * sum) : s->range;
}

/* 1 up to q = 0, 0 from q = 1 on */
static inline double film_fading(double q)
{
  const double s = q > 1.0 ? 1.0 : q > 0.0 ? q : 0.0;
  return 1.0 - s * s * (3.0 - 2.0 * s);
}

/* The gap of a pair over its mean radius, and t of it */
static inline double gap_of_film(const sd_lubrication_scene *s, int i, const closeness *c)
{
  return 2.0 * (c->distance / (s->spheres.a[i] + s->spheres.a[c->at]) - 1.0);
}

static inline double weight_of_film(const sd_lubrication_scene *s, int i, const closeness *c)
{
  const double range = film_range_of(s, s->spheres.a[i], s->spheres.a[c->at]);
  return film_fading(2.0 * gap_of_film(s, i, c) / range - 1.0);
}

/* out += B V for a block of a pair */
static inline void add_product(const sd_lubrication_link *B, const double *V, double *out)
{
  double dU[3], dW[3];
  sd_cross(B->d, V, dU);
  sd_cross(B->d, V + 3, dW);
  const double F = (B->XA - B->YA) * sd_dot(B->d, V), T = (B->XC - B->YC) * sd_dot(B->d, V + 3);
  for (int e = 0; e < 3; e++) {
    out[e] += B->YA * V[e] + F * B->d[e] + B->YB21 * dW[e];
    out[3 + e] += B->YC * V[3 + e] + T * B->d[e] - B->YB12 * dU[e];
  }
}

/* Block 21 of a pair from its block 12: d turns round, and so do the signs of YB. */
static inline sd_lubrication_link exchanged(sd_lubrication_link B)
{
  const double YB12 = B.YB12;
  B.YB12 = B.YB21;
  B.YB21 = YB12;
  return B;
}

/* Block 11, 12 or 22 of a pair: b = 0, 1, 2 */
static inline sd_lubrication_link block_of(const sd_pair_resistance *R, int b, const double d[3])
{
  static const int YB12[3] = {0, 1, 3}, YB21[3] = {0, 2, 3};
  return (sd_lubrication_link){{d[0], d[1], d[2]}, R->XA[b], R->YA[b], R->YB[YB12[b]],
                               R->YB[YB21[b]],     R->XC[b], R->YC[b]};
}

/* Velocities of what stands at j, V [6 n] those of this rank */
static inline const double *motion_at(const sd_lubrication *L, const double *V, int j)
{
  return j < L->n ? V + 6 * (long) j : L->others + 6 * (long) (j - L->n);
}

/* How what stands there drifts */
static inline const double *drift_at(const sd_lubrication *L, int at)
{
  static const double still[3] = {0.0};
  return L->work->drifts && at >= L->n ? L->work->drift + 3 * (long) (at - L->n) : still;
}

/* The others' V, which no rank needs that is alone */
static inline sd_status fetch(const sd_lubrication *L, const double *V)
{
  const sd_world *world = &L->world;
  return world->refresh && world->ranks > 1 ? world->refresh(world->ctx, V, L->others, 6) : SD_OK;
}

#endif
