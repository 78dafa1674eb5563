#ifndef SURFACE_DROP_H
#define SURFACE_DROP_H

#include "sd_sph_tension.h"

#include "check.h"

#include <math.h>
#include <string.h>

enum { MOST = 6000 };

/* Particles, all of this rank, with lists of all that are nearer than 2 h. */
typedef struct {
  int n, wall[MOST + 1], *neighbor[MOST], own[MOST], count[MOST], *pool;
  double x4[4 * (MOST + 1)], v4[4 * (MOST + 1)];
  double sums[8 * MOST], beside[8 * MOST], contact[4 * (MOST + 1)], whole[4 * MOST];
  double surface[4 * (MOST + 1)], at_wall[8 * MOST], kappa[MOST + 1], F[3 * MOST], area[MOST];
  double turns[SD_SPH_SKIN_SUMS * MOST], own_of_skin[2 * MOST], k[MOST];
  sd_sph_film_rows rows;
  size_t first[MOST];
  int who[MOST], count_of_skin[MOST];
  const int *skin_of[MOST];
  sd_sph_skin skin;
  sd_sph_surface plane;
  sd_sph_both list;
  sd_sph_film film;
} drop;

static drop all_of_it;

static inline drop *begin(int dimension, double h)
{
  drop *s = &all_of_it;
  free(s->pool);
  free(s->skin.pool);
  free(s->skin.weight);
  memset(s, 0, sizeof(*s));
  sd_sph_surface_make(SD_SPH_WENDLAND, dimension, h, &s->plane);
  return s;
}

static inline void add(drop *s, double x, double y, double z, double V, int wall)
{
  assert_true(s->n < MOST);
  const double row[4] = {x, y, z, V};
  memcpy(s->x4 + 4 * s->n, row, sizeof(row));
  s->wall[s->n++] = wall;
}

static inline double distance(const drop *s, int i, int j)
{
  double r2 = 0.0;
  for (int d = 0; d < 3; d++) r2 += (s->x4[4 * i + d] - s->x4[4 * j + d]) * (s->x4[4 * i + d] - s->x4[4 * j + d]);
  return sqrt(r2);
}

static inline void find_neighbours(drop *s, int walls)
{
  for (int round = 0; round < 2; round++) {
    size_t size = 0;
    for (int i = 0; i < s->n; i++) {
      if (round) s->neighbor[i] = s->pool + size;
      s->count[i] = s->own[i] = 0;
      for (int j = 0; j < s->n; j++)
        if (j != i && distance(s, i, j) < 2.0 * s->plane.h) {
          if (round) s->pool[size + s->count[i]] = j;
          s->own[i] += j < i;
          s->count[i]++;
        }
      while (s->count[i] % SD_SPH_LANES) {
        if (round) s->pool[size + s->count[i]] = s->n;
        s->count[i]++;
      }
      size += (size_t) s->count[i];
    }
    if (!round) s->pool = malloc(sizeof(int) * (size + 1));
  }
  for (int d = 0; d < 3; d++) s->x4[4 * s->n + d] = 1e10;
  s->list = (sd_sph_both){s->n, s->neighbor, s->own, s->count};
  s->film = (sd_sph_film){&s->plane, &s->list, s->n, s->x4, walls ? s->wall : NULL, NULL, 0};
  s->rows = (sd_sph_film_rows){s->sums,    walls ? s->beside : NULL,  s->whole,
                               s->surface, walls ? s->at_wall : NULL};
}

/* Rings of particles of one volume, as a drop at rest has them; 2-D. */
static inline void disk(drop *s, double R, double dx, double x, double y)
{
  const int rings = (int) floor(R / dx + 0.5);
  for (int k = 0; k < rings; k++) {
    const double in = R * k / rings, out = R * (k + 1) / rings, r = sqrt(0.5 * (in * in + out * out));
    const int count = (int) floor(2.0 * 3.141592653589793 * r / dx + 0.5);
    for (int m = 0; m < count; m++) {
      const double at = 2.0 * 3.141592653589793 * (m + 0.31 * k) / count;
      add(s, x + r * cos(at), y + r * sin(at), 0.0, 3.141592653589793 * (out * out - in * in) / count, 0);
    }
  }
}

#endif
