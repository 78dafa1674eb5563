#include "resume.h"

#include "atom.h"
#include "domain.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace StokesDyn {

/* Hash (FNV-1a, by words) of atom and molecule ID, which commands may change where nothing moves:
 * the 53 bits that a double holds */
static double hash_of_ids(const LAMMPS_NS::Atom *atom, int i)
{
  uint64_t h = 14695981039346656037u;
  for (LAMMPS_NS::tagint id : {atom->tag[i], atom->molecule ? atom->molecule[i] : 0})
    h = (h ^ (uint64_t) id) * 1099511628211u;
  return (double) (h >> 11);
}

void Resume::record(int i, double *row) const
{
  domain->unmap(atom->x[i], atom->image[i], row + X);
  memcpy(row + V, atom->v[i], 3 * sizeof(double));
  row[RADIUS] = atom->radius ? atom->radius[i] : 0.0;
  row[NAME] = hash_of_ids(atom, i);
  if (spins) memcpy(row + OMEGA, atom->omega[i], 3 * sizeof(double));
}

bool Resume::placed(int i, const double *row) const
{
  const double radius = atom->radius ? atom->radius[i] : 0.0;
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  for (int k = 0; k < 3; k++)
    if (!(std::fabs(x[k] - row[X + k]) <= 1e-9 * radius)) return false;
  return radius == row[RADIUS] && hash_of_ids(atom, i) == row[NAME];
}

static bool same_vector(const double *now, const double *then)
{
  double difference = 0.0, size = 0.0;
  for (int k = 0; k < 3; k++) {
    difference = std::fmax(difference, std::fabs(now[k] - then[k]));
    size = std::fmax(size, std::fabs(now[k]));
  }
  return difference <= 1e-12 * size;
}

bool Resume::moving(int i, const double *row) const
{
  return same_vector(atom->v[i], row + V) && (!spins || same_vector(atom->omega[i], row + OMEGA));
}

}    // namespace StokesDyn
