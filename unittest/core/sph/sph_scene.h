/* Random particles for the tests of the pair sums. */
#ifndef SD_SPH_SCENE_H
#define SD_SPH_SCENE_H

#include "sd_sph_order.h"

#include "check.h"

#include <string.h>

enum { N = 23, ALL = N * (N - 1) / 2 };

static uint64_t seed = 4711;

static inline double random_number(void)
{
  return uniform(&seed, 0.0, 1.0);
}

/* Two classes of particles in a box of a few h, velocities and both signs of pressure, all pairs in a half
 * list. */
typedef struct {
  double x[3 * N], v[3 * N], rho[N + 1], P[N], A[N], m[N + 1];
  double x4[4 * (N + 1)], v4[4 * (N + 1)];
  int cls[N + 1], phase[N + 1], first[N], count[N], flat[ALL + 1], *neighbor[N];
  sd_sph_list list;
  sd_sph_particles p;
  sd_sph_parameters types[4];
  sd_sph_coefficients pair[4];
  sd_sph_model model;
} scene;

static inline void coefficients(scene *s)
{
  for (int k = 0; k < 4; k++) s->pair[k] = sd_sph_coefficients_of(&s->model, &s->types[k]);
}

static inline void build(scene *s, sd_sph_kernel kernel, int dimension, int classes, int artvisc,
                  int tenscorr, sd_sph_friction friction)
{
  memset(s, 0, sizeof(*s));
  const sd_sph_parameters one = {0.3, 20.0, 0.07, 0.4, 0.25, 0.7},
                          two = {0.36, 25.0, 0.05, 0.3, 0.27, 0.8},
                          mean = {0.33, 22.5, 0.06, 0.35, 0.26, 0.75},
                          table[4] = {one, mean, mean, two};
  s->model = (sd_sph_model){.kernel = kernel,
                            .dimension = dimension,
                            .artvisc = artvisc,
                            .tenscorr = tenscorr,
                            .friction = friction,
                            .eta = 1.3e-3,
                            .epsilon = 0.21,
                            .nclasses = classes,
                            .pair = s->pair};
  for (int k = 0; k < 4; k++) s->types[k] = table[k];
  coefficients(s);
  int *next = s->flat;
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) {
      s->x[3 * i + d] = d < dimension ? random_number() : 0.0;
      s->v[3 * i + d] = d < dimension ? random_number() - 0.5 : 0.0;
    }
    s->cls[i] = classes > 1 ? i % 2 : 0;
    s->m[i] = s->cls[i] ? 1.3 : 0.9;
    s->rho[i] = 900.0 + 200.0 * random_number();
    s->P[i] = 5e4 * (s->rho[i] - 1000.0);
    s->A[i] = s->P[i] / (s->rho[i] * s->rho[i]);
    s->first[i] = i;
    s->neighbor[i] = next;
    for (int j = i + 1; j < N; j++)
      *next++ = j | 1 << 30;    // marked as LAMMPS marks neighbours; the mask removes it
    s->count[i] = N - 1 - i;
  }
  s->rho[N] = 1.0;
  s->list = (sd_sph_list){N, (1 << 30) - 1, s->first, s->count, s->neighbor};
  s->p = (sd_sph_particles){.n = N, .x4 = s->x4, .v4 = s->v4, .m = s->m, .cls = s->cls, .mass = 0.9};
  sd_sph_pack_x(N, s->x, NULL, NULL, 0.0, s->x4);
  sd_sph_pack_pressures(&s->model, N, s->P, 0.0, s->rho, s->x4);
  sd_sph_pack_v(N, s->v, s->rho, s->v4);
}

/* Neighbours with their memory. */
typedef struct {
  int *neighbor[N], own[N], count[N], pool[2 * ALL + 2 * SD_SPH_LANES * (N + 1)];
} neighbours;

/* The list both ways of the first n particles, the others as ghosts. */
static inline sd_sph_both both_ways(const scene *s, neighbours *room, int n)
{
  sd_sph_both both = {n, room->neighbor, room->own, room->count};
  const sd_sph_list half = {n, s->list.mask, s->first, s->count, s->neighbor};
  assert_true(sd_sph_both_size(&half, n) <= sizeof(room->pool) / sizeof(int));
  sd_sph_both_ways(&half, N, room->pool, &both);
  return both;
}

static inline sd_sph_near near_in(neighbours *room)
{
  return (sd_sph_near){0.0, room->pool, room->neighbor, room->own, room->count};
}

/* The middle of a step, and the diffusion, of all particles. */
static inline void sum_middle(const scene *s, double *sums)
{
  neighbours around, close;
  const sd_sph_both both = both_ways(s, &around, N);
  const sd_sph_near near = near_in(&close);
  sd_sph_middle(&s->model, &both, &s->p, sums, &near);
}

static inline void diffuse(const scene *s, double *rate)
{
  neighbours around;
  const sd_sph_both both = both_ways(s, &around, N);
  sd_sph_diffusion(&s->model, &both, &s->p, rate);
}

static inline void forces_of(const scene *s, double *f4)
{
  neighbours around;
  const sd_sph_both both = both_ways(s, &around, N);
  if (sd_sph_corrects(&s->model))
    sd_sph_corrected_forces(&s->model, &both, &s->p, f4, NULL);
  else
    sd_sph_forces(&s->model, &s->list, &s->p, 0, f4, NULL);
}

/* Everybody sees everybody, and masses as if the box filled the support: M near the unit matrix. */
static inline void fill(scene *s)
{
  for (int k = 0; k < 4; k++) s->types[k].h *= 3.0;
  coefficients(s);
  for (int i = 0; i < N; i++) s->m[i] *= 10000.0 / N;
  s->p.mass *= 10000.0 / N;
}

#endif
