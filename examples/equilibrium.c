/* Hard spheres of radius 1 at equilibrium in a periodic cube, by Metropolis' method: a sphere is displaced at random
 * and stays there unless it overlaps another one. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

typedef struct {
  double edge, *x;
  /* cells^3 cells, each at least as wide as a sphere; first sphere of a cell, next one in it, or -1 */
  int cells, *first, *next;
} box;

/* 0 <= value < 1 (xorshift64*, Vigna 2016) */
static double uniform(uint64_t *state)
{
  *state ^= *state >> 12;
  *state ^= *state << 25;
  *state ^= *state >> 27;
  return (double)((*state * 2685821657736338717u) >> 11) / 9007199254740992.0;
}

static int place(double x, const box *b)
{
  const int c = (int)(x / b->edge * b->cells);
  return c < b->cells ? c : b->cells - 1;
}

static int *head(const double x[3], const box *b)
{
  return b->first + (place(x[0], b) * b->cells + place(x[1], b)) * b->cells + place(x[2], b);
}

static void put(int i, box *b)
{
  int *first = head(b->x + 3 * i, b);
  b->next[i] = *first;
  *first = i;
}

static void take(int i, box *b)
{
  int *at = head(b->x + 3 * i, b);
  while (*at != i) at = b->next + *at;
  *at = b->next[i];
}

static int overlaps(int i, const double x[3], const box *b)
{
  const int n = b->cells, c[3] = {place(x[0], b), place(x[1], b), place(x[2], b)};
  for (int m = 0; m < 27; m++) {
    const int d[3] = {(c[0] + m / 9 - 1 + n) % n, (c[1] + m / 3 % 3 - 1 + n) % n, (c[2] + m % 3 - 1 + n) % n};
    for (int j = b->first[(d[0] * n + d[1]) * n + d[2]]; j >= 0; j = b->next[j]) {
      double s = 0;
      for (int k = 0; k < 3; k++) {
        const double r = x[k] - b->x[3 * j + k];
        const double near = r - b->edge * nearbyint(r / b->edge);
        s += near * near;
      }
      if (j != i && s < 4) return 1;
    }
  }
  return 0;
}

/* Displaces each of n spheres `sweeps` times, by up to `step` along each axis.
 *   x      [n][3] centres in 0 ... edge, without overlaps; in and out
 *   edge   of the cube, at least 6
 *   state  of the random numbers, not 0; in and out
 * Returns the displacements that were accepted, or -1: edge too small, or out of memory. */
long equilibrium(int n, double *x, double edge, long sweeps, double step, uint64_t *state)
{
  const int cells = (int)(edge / 2);
  if (cells < 3) return -1;
  const int all = cells * cells * cells;
  int *room = malloc(sizeof(int) * (size_t)(all + n));
  if (room == NULL) return -1;
  box b = {edge, x, cells, room, room + all};
  for (int c = 0; c < all; c++) b.first[c] = -1;
  for (int i = 0; i < n; i++) put(i, &b);
  long accepted = 0;
  for (long m = 0; m < sweeps * n; m++) {
    const int i = (int)(uniform(state) * n);
    double y[3];
    for (int k = 0; k < 3; k++) {
      y[k] = x[3 * i + k] + step * (2 * uniform(state) - 1);
      y[k] -= edge * floor(y[k] / edge);
    }
    if (overlaps(i, y, &b)) continue;
    take(i, &b);
    for (int k = 0; k < 3; k++) x[3 * i + k] = y[k];
    put(i, &b);
    accepted++;
  }
  free(room);
  return accepted;
}
