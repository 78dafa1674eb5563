#include "sd_padded_lines.h"

#include <fftw3.h>
#include <stdlib.h>
#include <string.h>

/* So many lines at a time, which are half as many complex ones */
enum { TOGETHER = 8 };

struct sd_padded_lines {
  int n;
  /* [2 (n - 1)][TOGETHER] */
  double *period;
  fftw_plan plan;
};

sd_padded_lines *sd_padded_lines_create(int n)
{
  const int points = 2 * (n - 1), pairs = TOGETHER / 2;
  sd_padded_lines *t = calloc(1, sizeof(*t));
  if (!t) return NULL;
  t->n = n;
  t->period = fftw_malloc(sizeof(double) * TOGETHER * (size_t) points);
  fftw_complex *at = (fftw_complex *) t->period;
  if (at)
    t->plan = fftw_plan_many_dft(1, &points, pairs, at, NULL, pairs, 1, at, NULL, pairs, 1, FFTW_FORWARD,
                                 FFTW_ESTIMATE);
  if (t->plan) return t;
  sd_padded_lines_free(t);
  return NULL;
}

void sd_padded_lines_free(sd_padded_lines *t)
{
  if (!t) return;
  if (t->plan) fftw_destroy_plan(t->plan);
  fftw_free(t->period);
  free(t);
}

/* `many` lines from x on, the next one at `next`, whose numbers are `stride` apart */
static void together(const sd_padded_lines *t, int odd, double *x, long stride, long next, int many)
{
  const int last = t->n - 1;
  memset(t->period, 0, sizeof(double) * 2 * TOGETHER * (size_t) last);
  for (int j = odd; j <= last - odd; j++) {
    double *there = t->period + j * TOGETHER, *mirrored = t->period + (2 * last - j) * TOGETHER;
    for (int l = 0; l < many; l++) there[l] = x[j * stride + l * next];
    if (j == 0 || j == last) continue;
    for (int l = 0; l < TOGETHER; l++) mirrored[l] = odd ? -there[l] : there[l];
  }
  fftw_execute(t->plan);
  /* The transform of an odd line is -i times its sums. */
  for (int j = odd; j <= last - odd; j++) {
    const double *wave = t->period + j * TOGETHER;
    for (int l = 0; l < many; l++)
      x[j * stride + l * next] = !odd ? wave[l] : l % 2 ? wave[l - 1] : -wave[l + 1];
  }
}

void sd_padded_lines_apply(const sd_padded_lines *t, int odd, int d, const int *size, const int *from, const int *end,
                           double *field)
{
  const long step[3] = {(long) size[1] * size[2], size[2], 1};
  const int inner = d == 2 ? 1 : 2, outer = d == 0 ? 1 : 0;
  for (int o = from[outer]; o < end[outer]; o++)
    for (int i = from[inner]; i < end[inner]; i += TOGETHER) {
      const int left = end[inner] - i;
      together(t, odd, field + o * step[outer] + i * step[inner], step[d], step[inner],
               left < TOGETHER ? left : TOGETHER);
    }
}
