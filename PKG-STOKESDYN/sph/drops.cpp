#include "drops.h"

#include "ranks.h"

#include "atom.h"

#include <new>

using namespace LAMMPS_NS;

namespace StokesDyn {

Drops::~Drops()
{
  sd_cells_free(&cells);
}

/* In every step: drops that meet are one at once, whenever the run began and LAMMPS re-neighboured. */
void Drops::find(const sd_sph_film &film, const ToGhosts &to_ghosts)
{
  const size_t n = (size_t) film.all;
  parent.resize(n + 1);
  name.assign(n + 1, 0.0);
  if (room < n) {
    sd_cells_free(&cells);
    room = n + n / 4;
    if (sd_cells_create(&cells, (int) room) != SD_OK) throw std::bad_alloc();
  }
  sd_sph_find_drops(&film, &cells, parent.data());
  for (size_t i = 0; i < n; i++) name[i] = (double) atom->tag[i];
  int changed = 1;
  while (changed) {
    changed = sd_sph_name_drops(film.all, parent.data(), name.data());
    // who has no ghosts is in no drop of another rank
    changed = largest_of_all(world, changed && film.all > film.list->n ? 1 : 0);
    if (changed) to_ghosts(name.data());
  }
}

void Drops::keep_momentum(const sd_sph_film &film, const double *mass, const double *held, const ToGhosts &to_ghosts,
                          double *F)
{
  find(film, to_ghosts);
  place.resize((size_t) film.all + 1);
  drops.resize((size_t) film.list->n + 1);
  const sd_sph_in_drops of = {name.data(), mass, held, F};
  const int mine = sd_sph_sum_drops(&film, parent.data(), &of, drops.data(), place.data());
  std::vector<sd_sph_drop> all = from_all(world, std::vector<sd_sph_drop>(drops.begin(), drops.begin() + mine));
  count = sd_sph_join_drops((int) all.size(), all.data(), sum);
  sd_sph_find_excess(count, all.data(), mine, drops.data());
  sd_sph_keep_momentum(&film, parent.data(), place.data(), mass, drops.data(), F);
}

}    // namespace StokesDyn
