#include "sd_waves.h"

#include <math.h>
#include <stdlib.h>

#include "sd_constants.h"
#include "sd_linear.h"

typedef struct {
  int n[3];
  double k[3], square;
} wave;

/* By |k|, then by n, so that every rank and every compiler takes the same of equally long ones */
static int by_length(const void *pa, const void *pb)
{
  const wave *a = pa, *b = pb;
  if (a->square != b->square) return a->square < b->square ? -1 : 1;
  for (int d = 0; d < 3; d++)
    if (a->n[d] != b->n[d]) return a->n[d] < b->n[d] ? -1 : 1;
  return 0;
}

/* One of each pair +-k with |k| <= radius, into out if there is one. Returns how many. An edge a
 * has n = k.a/(2 pi), so |n| is at most |k||a|/(2 pi). Those beyond SD_WAVES_MOST, as a very skew
 * box has them, are left out: along one edge alone there are enough. */
static long waves_within(const sd_ewald_box *b, const double G[3][3], double radius, wave *out)
{
  const double *t = b->tilt, c = radius / (2.0 * SD_PI);
  const double lengths[3] = {b->edge[0], hypot(t[0], b->edge[1]),
                             hypot(hypot(t[1], t[2]), b->edge[2])};
  int most[3];
  for (int d = 0; d < 3; d++) most[d] = (int) fmin(SD_WAVES_MOST, c * lengths[d]);
  const int x = most[0], y = most[1], z = most[2];
  long count = 0;
  for (int l = 0; l <= x; l++)
    for (int m = l > 0 ? -y : 0; m <= y; m++)
      for (int n = l > 0 || m > 0 ? -z : 1; n <= z; n++) {
        wave w = {.n = {l, m, n}};
        for (int d = 0; d < 3; d++) w.k[d] = l * G[0][d] + m * G[1][d] + n * G[2][d];
        w.square = sd_dot(w.k, w.k);
        if (w.square > radius * radius) continue;
        if (out) out[count] = w;
        count++;
      }
  return count;
}

/* Two directions across k and one |k| make a pair of waves; the rest of the lists stays 0, and
 * waves without directions neither take nor give anything. */
int sd_wave_list_of(const sd_ewald_box *box, sd_wave_list *list)
{
  double G[3][3];
  int harmonics = 0;
  *list = (sd_wave_list){0};
  if (!box || !box->periodic) return 0;
  const double volume = sd_ewald_volume(box);
  if (!(volume > 0.0 && volume < INFINITY)) return 0;
  sd_ewald_reciprocal(box, G);
  /* A cubic box has just so many pairs within 3 times its longest wave, and a ball of that size
   * holds about as many of any box; where there are fewer, it grows. */
  double radius = 3.05 * 2.0 * SD_PI / cbrt(volume);
  while (waves_within(box, G, radius, NULL) < SD_WAVES_MOST) radius *= 1.1;
  wave *w = malloc(sizeof(wave) * (size_t) waves_within(box, G, radius, NULL));
  if (!w) return -1;
  qsort(w, (size_t) waves_within(box, G, radius, w), sizeof(wave), by_length);
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    double e[2][3];
    const double k = sqrt(w[m].square), unit[3] = {w[m].k[0] / k, w[m].k[1] / k, w[m].k[2] / k};
    sd_across(unit, e[0]);
    sd_cross(unit, e[0], e[1]);
    list->k[m] = k;
    list->strength[m] = 2.0 / (w[m].square * volume);
    for (int d = 0; d < 3; d++) {
      list->n[d][m] = w[m].n[d];
      list->e[0][d][m] = e[0][d];
      list->e[1][d][m] = e[1][d];
      harmonics = abs(w[m].n[d]) > harmonics ? abs(w[m].n[d]) : harmonics;
    }
  }
  free(w);
  return harmonics;
}
