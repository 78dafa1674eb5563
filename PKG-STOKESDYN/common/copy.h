/* N numbers from one place to another that it does not touch, in a few instructions. std::copy_n must allow
 * for places that overlap and calls the library, which in a loop over short rows costs more than all else.
 * And where a row is, and room for rows. */
#ifndef SD_COPY_H
#define SD_COPY_H

#include <cstddef>
#include <cstring>
#include <vector>

namespace StokesDyn {

template <size_t N> inline void copy(const double *from, double *to)
{
  memcpy(to, from, N * sizeof(double));
}

/* The same of a row whose width only a run knows: a point's, a force's, that with a torque, or another */
inline void copy_row(size_t width, const double *from, double *to)
{
  switch (width) {
    case 1: return copy<1>(from, to);
    case 3: return copy<3>(from, to);
    case 6: return copy<6>(from, to);
    default: memcpy(to, from, width * sizeof(double));
  }
}

/* Row i of one of LAMMPS's arrays of three numbers, whose rows stand one after the other (Memory::create),
 * without a look at its pointer: loops over all atoms wait for memory. */
inline double *atom_row(double **rows, int i)
{
  return rows[0] + 3 * (size_t) i;
}

/* Room for so many numbers, whose values do not matter; what was there is lost where it did not have that */
inline double *at_least(size_t numbers, std::vector<double> &room)
{
  if (room.size() < numbers) {
    room.clear();
    room.resize(numbers);
  }
  return room.data();
}

}    // namespace StokesDyn
#endif
