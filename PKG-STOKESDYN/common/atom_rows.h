/* Rows of numbers for those atoms that have some. Every atom has a pointer, eight bytes; only the
 * few that need one have a row. A fix keeps one of these and hands LAMMPS's callbacks on: atoms
 * migrate, are sorted, created and deleted. */
#ifndef SD_ATOM_ROWS_H
#define SD_ATOM_ROWS_H

#include <cstdlib>
#include <memory>
#include <vector>

namespace StokesDyn {

class AtomRows {
 public:
  explicit AtomRows(int columns) : width(columns), nothing(columns, 0.0) {}

  int columns() const { return width; }
  bool has(int i) const { return rows[i] != nothing.data(); }
  /* To read: zeros for an atom that has none. */
  const double *operator[](int i) const { return rows[i]; }
  /* To write: of an atom that has one. */
  double *row(int i) { return rows[i]; }
  /* To write: made of zeros if the atom has none. */
  double *give(int i);
  void take(int i);
  void clear();
  /* As grow_arrays, copy_arrays, pack_exchange, unpack_exchange of a fix. */
  void grow(int nmax) { rows.resize(nmax, nothing.data()); }
  void copy(int i, int j);
  int pack(int i, double *buffer) const;
  int unpack(int i, const double *buffer);
  int most_packed() const { return width + 1; }
  double bytes() const;

 private:
  enum { ROWS_OF_A_BLOCK = 1024 };
  int width;
  /* the row of those that have none; its address never changes */
  std::vector<double> nothing;
  /* [nmax] */
  std::vector<double *> rows;
  std::vector<std::unique_ptr<double[]>> blocks;
  /* the next one last */
  std::vector<double *> spare;
};

/* An array for LAMMPS, fix->array_atom: one block, since its libraries read it as such, so that
 * every atom has a row. Rows of zeros that nobody writes to are memory that the system has promised
 * and not yet given. */
class AtomArray {
 public:
  explicit AtomArray(int columns) : width(columns) {}

  int columns() const { return width; }
  /* array[i][column]; it moves when grow() is called */
  double **array() { return rows.data(); }
  double *row(int i);    // to write
  void zero(int i);
  void grow(int nmax);
  void copy(int i, int j);
  double bytes() const { return (double) rows.capacity() * (sizeof(double) * width + 9); }

 private:
  struct Free {
    void operator()(double *p) const { free(p); }
  };
  int width;
  std::unique_ptr<double[], Free> block;
  std::vector<double *> rows;    // [nmax]
  std::vector<char> written;     // not zeros
};

}    // namespace StokesDyn
#endif
