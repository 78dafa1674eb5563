/* N numbers from one place to another that it does not touch, in a few instructions. std::copy_n must allow
 * for places that overlap and calls the library, which in a loop over short rows costs more than all else. */
#ifndef SD_COPY_H
#define SD_COPY_H

#include <cstddef>
#include <cstring>

namespace StokesDyn {

template <size_t N> inline void copy(const double *from, double *to)
{
  memcpy(to, from, N * sizeof(double));
}

}    // namespace StokesDyn
#endif
