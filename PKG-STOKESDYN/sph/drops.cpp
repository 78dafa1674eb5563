#include "drops.h"

#include "ranks.h"

#include "atom.h"
#include "neighbor.h"

#include <new>

using namespace LAMMPS_NS;

namespace StokesDyn {

Drops::~Drops()
{
  sd_cells_free(&cells);
}

/* Until the next list of neighbours no distance changes by more than its skin. Where that could make or break a drop
 * they are found in every step: drops that meet are one at once. */
void Drops::find(const sd_sph_film &film)
{
  const bool is_new = neighbor->ago == 0;    // as whenever a run begins
  if (stay && !is_new) return;
  const size_t n = (size_t) film.all;
  const double h = film.surface->h, skin = neighbor->skin;
  parent.resize(n + 1);
  if (room < n) {
    sd_cells_free(&cells);
    room = n + n / 4;
    if (sd_cells_create(&cells, (int) room) != SD_OK) throw std::bad_alloc();
  }
  if (is_new && skin < h) {
    const int least = sd_sph_find_drops(&film, 2.0 * h + skin, &cells, parent.data());
    stay = !largest_of_all(world, least != sd_sph_find_drops(&film, 2.0 * h - skin, &cells, parent.data()) ? 1 : 0);
  } else if (is_new)
    stay = false;
  if (!stay) sd_sph_find_drops(&film, 2.0 * h, &cells, parent.data());
  make_names(film);
  of.resize(n + 1);
  mine.resize((size_t) film.list->n + 1);
  here = sd_sph_list_drops(&film, parent.data(), name.data(), of.data(), mine.data());
}

void Drops::make_names(const sd_sph_film &film)
{
  const size_t n = (size_t) film.all;
  name.resize(n + 1);
  for (size_t i = 0; i < n; i++) name[i] = (double) atom->tag[i];
  int changed = 1;
  while (changed) {
    changed = sd_sph_name_drops(film.all, parent.data(), name.data());
    // who has no ghosts is in no drop of another rank
    changed = largest_of_all(world, changed && film.all > film.list->n ? 1 : 0);
    if (changed) ghosts.forward(name.data(), 1);
  }
}

void Drops::keep_momentum(const sd_sph_film &film, const char *held, double *F)
{
  find(film);
  sd_sph_sum_drops(&film, of.data(), held, F, here, mine.data());
  std::vector<sd_sph_drop> all = from_all(world, std::vector<sd_sph_drop>(mine.begin(), mine.begin() + here));
  count = sd_sph_join_drops((int) all.size(), all.data(), sum);
  sd_sph_find_excess(count, all.data(), here, mine.data());
  sd_sph_keep_momentum(&film, of.data(), mine.data(), F);
}

}    // namespace StokesDyn
