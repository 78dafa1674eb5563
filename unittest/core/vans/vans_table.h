/* Tables of unittest/data/vans: "# key = value" lines, one line of column names, then numbers; a column may end before
 * the others. */
#ifndef VANS_TABLE_H
#define VANS_TABLE_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VANS_MAX_COLUMNS = 40, VANS_MAX_ROWS = 1100, VANS_MAX_KEYS = 40 };

typedef struct {
  int columns, keys;
  char name[VANS_MAX_COLUMNS][32], key[VANS_MAX_KEYS][32], value[VANS_MAX_KEYS][96];
  int rows[VANS_MAX_COLUMNS];
  double data[VANS_MAX_COLUMNS][VANS_MAX_ROWS];
} vans_table;

static vans_table *vans_read(const char *case_name)
{
  char path[1024], line[8192];
  const char *slash = strrchr(__FILE__, '/');
  snprintf(path, sizeof path, "%.*s/../../data/vans/%s.csv", (int) (slash - __FILE__), __FILE__,
           case_name);
  FILE *file = fopen(path, "r");
  if (!file) {
    fprintf(stderr, "cannot read %s\n", path);
    abort();
  }
  vans_table *t = calloc(1, sizeof *t);
  int header = 1;
  while (fgets(line, sizeof line, file)) {
    line[strcspn(line, "\r\n")] = '\0';
    if (line[0] == '#') {
      if (sscanf(line, "# %31[^ =] = %95[^\n]", t->key[t->keys], t->value[t->keys]) == 2) t->keys++;
      continue;
    }
    int c = 0;
    for (char *p = line;; c++) {
      char *end = strchr(p, ',');
      if (end) *end = '\0';
      if (header)
        snprintf(t->name[c], sizeof t->name[c], "%.31s", p);
      else if (*p)
        t->data[c][t->rows[c]++] = strtod(p, NULL);
      if (!end) break;
      p = end + 1;
    }
    if (header) t->columns = c + 1;
    header = 0;
  }
  fclose(file);
  return t;
}

/* NULL if there is no such column */
static double *vans_find(vans_table *t, const char *name)
{
  for (int c = 0; c < t->columns; c++)
    if (strcmp(t->name[c], name) == 0) return t->data[c];
  return NULL;
}

static double *vans_column(vans_table *t, const char *name)
{
  double *found = vans_find(t, name);
  if (!found) {
    fprintf(stderr, "no column %s\n", name);
    abort();
  }
  return found;
}

/* The first number of a key, or the n-th. */
static double vans_key(const vans_table *t, const char *key, int nth)
{
  for (int k = 0; k < t->keys; k++)
    if (strcmp(t->key[k], key) == 0) {
      char *p = (char *) t->value[k];
      double v = 0.0;
      for (int i = 0; i <= nth; i++) v = strtod(p, &p);
      return v;
    }
  fprintf(stderr, "no key %s\n", key);
  abort();
}

/* Largest difference relative to the largest entry of the reference. */
static double vans_difference(const double *a, const double *reference, int n)
{
  double worst = 0.0, largest = 0.0;
  for (int i = 0; i < n; i++) {
    const double d = a[i] > reference[i] ? a[i] - reference[i] : reference[i] - a[i],
                 s = reference[i] > 0 ? reference[i] : -reference[i];
    if (!(d <= worst)) worst = d;
    if (s > largest) largest = s;
  }
  return largest > 0.0 ? worst / largest : worst;
}

#endif
