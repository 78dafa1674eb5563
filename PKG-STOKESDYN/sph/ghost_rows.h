/* A pair style or a fix that sends rows of arrays between owned particles and ghosts. */
#ifndef SD_GHOST_ROWS_H
#define SD_GHOST_ROWS_H

#include "lammps_compat.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

namespace StokesDyn {

/* Rows [width] of atoms */
struct RowsToSend {
  double *rows;
  int width;
  double *row(int i) const { return rows + (size_t) i * width; }
};

/* Rows of atoms to their ghosts, of several arrays in one message; and those of ghosts to the owners, who add
 * them up, or keep the largest */
class GhostExchange {
 public:
  virtual void forward(std::vector<RowsToSend> sent) = 0;
  virtual void reverse(double *rows, int width, bool keep_largest = false) = 0;
  void forward(double *rows, int width) { forward({{rows, width}}); }

 protected:
  /* nobody deletes one: LAMMPS owns them, as what else they are */
  ~GhostExchange() = default;
};

/* Numbers of an atom: at most comm_forward and comm_reverse, which the constructor says */
template <class Base> class GhostRows : public Base, public GhostExchange {
 public:
  using Base::Base;
  /* one array after the other, each with all its rows */
  int pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/) override
  {
    const double *begin = buf;
    for (const RowsToSend &of : arrays)
      for (int k = 0; k < n; k++) buf = std::copy_n(of.row(list[k]), of.width, buf);
    return (int) (buf - begin);
  }
  void unpack_forward_comm(int n, int first, double *buf) override
  {
    for (const RowsToSend &of : arrays) {
      const size_t numbers = (size_t) n * of.width;
      std::copy_n(buf, numbers, of.row(first));
      buf += numbers;
    }
  }
  int pack_reverse_comm(int n, int first, double *buf) override
  {
    const RowsToSend &of = arrays[0];
    std::copy_n(of.row(first), (size_t) n * of.width, buf);
    return n * of.width;
  }
  void unpack_reverse_comm(int n, int *list, double *buf) override
  {
    const RowsToSend &of = arrays[0];
    for (int k = 0; k < n; k++)
      for (int c = 0; c < of.width; c++, buf++) {
        double &mine = of.row(list[k])[c];
        mine = largest ? std::max(mine, *buf) : mine + *buf;
      }
  }

  using GhostExchange::forward;
  void forward(std::vector<RowsToSend> sent) override
  {
    int width = 0;
    for (const RowsToSend &of : sent) width += of.width;
    assert(width <= this->comm_forward);
    (void) width;
    arrays = std::move(sent);
    Compat::forward_comm(this->comm, this);
  }
  void reverse(double *rows, int width, bool keep_largest = false) override
  {
    assert(width <= this->comm_reverse);
    arrays = {{rows, width}};
    largest = keep_largest;
    Compat::reverse_comm(this->comm, this);
  }

 private:
  std::vector<RowsToSend> arrays;
  bool largest = false;
};

}    // namespace StokesDyn
#endif
