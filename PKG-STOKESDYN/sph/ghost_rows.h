/* A pair style or a fix that sends rows of one array at a time between owned particles and ghosts. */
#ifndef SD_GHOST_ROWS_H
#define SD_GHOST_ROWS_H

#include "lammps_compat.h"

#include <algorithm>
#include <cassert>

namespace StokesDyn {

template <class Base> class GhostRows : public Base {
 public:
  using Base::Base;
  int pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/) override
  {
    for (int k = 0; k < n; k++) buf = std::copy_n(row(list[k]), columns, buf);
    return n * columns;
  }
  void unpack_forward_comm(int n, int first, double *buf) override
  {
    std::copy_n(buf, (size_t) n * columns, row(first));
  }
  int pack_reverse_comm(int n, int first, double *buf) override
  {
    std::copy_n(row(first), (size_t) n * columns, buf);
    return n * columns;
  }
  void unpack_reverse_comm(int n, int *list, double *buf) override
  {
    for (int k = 0; k < n; k++)
      for (int c = 0; c < columns; c++, buf++) {
        double &mine = row(list[k])[c];
        mine = largest ? std::max(mine, *buf) : mine + *buf;
      }
  }

 protected:
  /* Rows [width] of atoms to their ghosts; and those of ghosts to the owners, who add them up, or keep the
   * largest. width: at most comm_forward and comm_reverse, which the constructor says */
  void forward(double *rows, int width)
  {
    assert(width <= this->comm_forward);
    array = rows;
    columns = width;
    Compat::forward_comm(this->comm, this);
  }
  void reverse(double *rows, int width, bool keep_largest = false)
  {
    assert(width <= this->comm_reverse);
    array = rows;
    columns = width;
    largest = keep_largest;
    Compat::reverse_comm(this->comm, this);
  }

 private:
  double *array = nullptr;
  int columns = 0;
  bool largest = false;

  double *row(int i) const { return array + (size_t) i * columns; }
};

}    // namespace StokesDyn
#endif
