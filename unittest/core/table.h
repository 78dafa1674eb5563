/* Reference tables: lines of numbers and names separated by commas, after lines that begin with # and one line of
 * column names. */
#ifndef TABLE_H
#define TABLE_H

#include "check.h"

#include <string.h>

enum { TABLE_COLUMNS = 64 };

typedef struct {
  FILE *file;
  char line[4096];
  char *column[TABLE_COLUMNS]; /* of the present row */
  int columns;
} table;

static inline int table_next(table *t)
{
  for (;;) {
    if (!fgets(t->line, sizeof(t->line), t->file)) {
      fclose(t->file);
      return 0;
    }
    if (t->line[0] != '#') break;
  }
  t->columns = 0;
  for (char *p = t->line; p && t->columns < TABLE_COLUMNS; t->columns++) {
    t->column[t->columns] = p;
    p = strpbrk(p, ",\n");
    if (p) *p++ = 0;
    if (p && *p == 0) p = NULL;
  }
  if (t->columns < TABLE_COLUMNS) t->columns++;
  return 1;
}

static inline table table_open(const char *name)
{
  char path[1024];
  table t = {0};
  snprintf(path, sizeof(path), "%s%s", TEST_DATA, name);
  t.file = fopen(path, "r");
  if (!t.file) fail_msg("%s cannot be opened", path);
  table_next(&t); /* names */
  return t;
}

static inline double table_number(const table *t, int column)
{
  assert_true(column < t->columns && *t->column[column]);
  return strtod(t->column[column], NULL);
}

/* Centres x [3n] and radii a [n] of a cluster of cluster_geometry.csv; returns n. */
static inline int table_cluster(const char *name, double *x, double *a)
{
  int n = 0;
  table t = table_open("cluster_geometry.csv");
  while (table_next(&t)) {
    if (strcmp(t.column[0], name)) continue;
    a[n] = table_number(&t, 2);
    for (int d = 0; d < 3; d++) x[3 * n + d] = table_number(&t, 3 + d);
    n++;
  }
  assert_true(n > 0);
  return n;
}

/* Random rotation, row-major */
static inline void random_rotation(uint64_t *seed, double R[9])
{
  double q[4], norm;
  do {
    norm = 0.0;
    for (int i = 0; i < 4; i++) {
      q[i] = uniform(seed, -1.0, 1.0);
      norm += q[i] * q[i];
    }
  } while (norm > 1.0 || norm < 0.01);
  const double w = q[0], x = q[1], y = q[2], z = q[3], s = 2.0 / norm;
  R[0] = 1 - s * (y * y + z * z), R[1] = s * (x * y - z * w), R[2] = s * (x * z + y * w);
  R[3] = s * (x * y + z * w), R[4] = 1 - s * (x * x + z * z), R[5] = s * (y * z - x * w);
  R[6] = s * (x * z - y * w), R[7] = s * (y * z + x * w), R[8] = 1 - s * (x * x + y * y);
}

/* Fisher-Yates */
static inline void random_order(uint64_t *seed, int n, int *order)
{
  for (int k = 0; k < n; k++) order[k] = k;
  for (int k = n - 1; k > 0; k--) {
    const int j = (int) uniform(seed, 0.0, k + 1.0), o = order[k];
    order[k] = order[j];
    order[j] = o;
  }
}

#endif
