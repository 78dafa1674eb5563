#include "films_factor.h"

#include "atom.h"
#include "domain.h"

#include "sd_hash.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The lattice, and a fingerprint of radii and viscosities */
enum { EDGES = 6, PRINT = EDGES, SIZE, NUMBERS };

/* Over the radius: in steps of a hundredth films always change too much (volume fractions from 0.3 on). */
static const double FAR = 0.01;

void FilmsFactor::find_numbers()
{
  const Lattice lattice = Lattice::of(domain);
  const bool periodic = lattice.periodic[0] || lattice.periodic[1] || lattice.periodic[2];
  const sd_spheres s = scene.local();
  numbers.assign(NUMBERS, 0.0);
  if (periodic) std::copy_n(lattice.h, EDGES, numbers.begin());
  for (int k = 0; k < scene.size(); k++) {
    const double row[2] = {s.a[k], s.w[k]};
    sd_hash_add_row((uint64_t) scene.tag(k), row, 2, &numbers[PRINT]);
  }
  MPI_Allreduce(MPI_IN_PLACE, &numbers[PRINT], 2, MPI_DOUBLE, MPI_SUM, world);
}

/* Does the memory say where a factor of these spheres was made, and was that near? */
bool FilmsFactor::known(const FixStokesDynamicsState &memory) const
{
  const std::vector<double> &made_of = memory.global.made_of;
  double sums[SD_MOVED];
  return memory.moved_since_made(scene.who(), sums) && sd_moved_far(sums) < FAR && made_of.size() == NUMBERS &&
      std::equal(made_of.begin(), made_of.begin() + EDGES, numbers.begin()) &&
      std::fabs(made_of[PRINT] - numbers[PRINT]) <= 1e-8 * numbers[SIZE];
}

void FilmsFactor::make_there(const FixStokesDynamicsState &memory)
{
  const std::vector<double> then = scene.rows(3, [&](int i, double *out) {
    double d[3];
    memory.from_made(i, d);
    for (int c = 0; c < 3; c++) out[c] = atom->x[i][c] - d[c];
  });
  const size_t of_bodies = SD_TIE_OF_BODY * (size_t) sd_bodies_count(&bodies.bodies);
  std::vector<double> scratch(of_bodies + SD_TIE_OF_SPHERE * (size_t) scene.size() + 1);
  bodies.films_at(then);
  // where that fails it is made anew in the solve
  sd_tie_make(&bodies.bodies, {scratch.data(), &scratch[of_bodies]});
  bodies.films_back();
}

void FilmsFactor::recall(const FixStokesDynamicsState &memory)
{
  if (!bodies.films_by_places()) return forget();
  find_numbers();
  if (!known(memory)) return;
  if (!rows.is(scene.all_epochs().rows)) make_there(memory);
  bodies.bodies.tie->keep = 1;
}

void FilmsFactor::note(FixStokesDynamicsState &memory)
{
  if (!bodies.films_by_places()) return;
  rows.set(scene.all_epochs().rows);
  if (bodies.bodies.tie->anew) memory.made_here(scene.who(), numbers);
}

}    // namespace StokesDyn
