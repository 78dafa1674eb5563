#include "sd_sph_drops.h"

#include "sd_sph_tension_internal.h"

#include <stdlib.h>
#include <string.h>

void sd_sph_find_drops(const sd_sph_film *f, int *parent)
{
  for (int i = 0; i <= f->all; i++) parent[i] = i;
  sd_sph_loops_of_films()->links(f, parent);
}

int sd_sph_name_drops(int all, int *parent, double *name)
{
  int changed = 0;
  for (int i = 0; i < all; i++) {
    const int root = sd_sph_root_of_drop(parent, i);
    if (name[i] < name[root]) name[root] = name[i];
  }
  for (int i = 0; i < all; i++) {
    const double of_drop = name[sd_sph_root_of_drop(parent, i)];
    changed |= of_drop < name[i];
    name[i] = of_drop;
  }
  return changed;
}

int sd_sph_sum_drops(const sd_sph_film *f, int *parent, const double *name, const double *mass,
                     const double *held, const double *F, sd_sph_drop *out, int *place)
{
  int count = 0;
  for (int i = 0; i < f->all; i++) place[i] = -1;
  for (int i = 0; i < f->list->n; i++) {
    if (!sd_sph_in_drop(f, i)) continue;
    int *at = &place[sd_sph_root_of_drop(parent, i)];
    if (*at < 0) {
      *at = count++;
      out[*at] = (sd_sph_drop){.name = name[i]};
    }
    sd_sph_drop *drop = &out[*at];
    for (int d = 0; d < 3; d++) drop->F[d] += F[3 * (size_t) i + d];
    drop->mass += mass[i];
    if (held[i] > drop->held) drop->held = held[i];
  }
  return count;
}

static int by_name(const void *a, const void *b)
{
  const double one = ((const sd_sph_drop *) a)->name, two = ((const sd_sph_drop *) b)->name;
  return (one > two) - (one < two);
}

/* Parts of one drop, which stand beside each other, become one. */
static int drops_add_up(int count, sd_sph_drop *drops)
{
  int last = -1;
  for (int k = 0; k < count; k++) {
    if (last < 0 || drops[last].name != drops[k].name) {
      drops[++last] = drops[k];
      continue;
    }
    for (int d = 0; d < 3; d++) drops[last].F[d] += drops[k].F[d];
    drops[last].mass += drops[k].mass;
    if (drops[k].held > drops[last].held) drops[last].held = drops[k].held;
  }
  return last + 1;
}

int sd_sph_keep_momentum(const sd_sph_film *f, int *parent, const int *place, const double *mass, int count,
                         sd_sph_drop *mine, int all_count, sd_sph_drop *everywhere, double *F, double sum[3])
{
  qsort(everywhere, (size_t) all_count, sizeof(sd_sph_drop), by_name);
  const int drops = drops_add_up(all_count, everywhere);
  memset(sum, 0, 3 * sizeof(double));
  for (int k = 0; k < drops; k++)
    for (int d = 0; d < 3 && everywhere[k].held > 0.0; d++) sum[d] += everywhere[k].F[d];
  /* F of mine becomes the force per mass that is given back */
  for (int k = 0; k < count; k++) {
    const sd_sph_drop *whole =
        bsearch(&mine[k], everywhere, (size_t) drops, sizeof(sd_sph_drop), by_name);
    for (int d = 0; d < 3; d++) mine[k].F[d] = whole->held > 0.0 ? 0.0 : whole->F[d] / whole->mass;
  }
  for (int i = 0; i < f->list->n; i++) {
    if (!sd_sph_in_drop(f, i)) continue;
    const sd_sph_drop *drop = &mine[place[sd_sph_root_of_drop(parent, i)]];
    for (int d = 0; d < 3; d++) F[3 * (size_t) i + d] -= mass[i] * drop->F[d];
  }
  return drops;
}
