/* Rows of numbers that follow their atoms, which migrate, are sorted, created and deleted: of a fix
 * that is a RowsFix (rows_fix.h), or that hands LAMMPS's callbacks on itself. */
#ifndef SD_ATOM_ROWS_H
#define SD_ATOM_ROWS_H

#include <cstdlib>
#include <memory>
#include <vector>

namespace StokesDyn {

class RowsOfAtoms {
 public:
  explicit RowsOfAtoms(int columns) : width(columns) {}
  virtual ~RowsOfAtoms() = default;

  int columns() const { return width; }
  virtual bool has(int i) const = 0;
  /* To read: zeros for an atom that has none. */
  virtual const double *operator[](int i) const = 0;
  /* To write: made of zeros if the atom has none. */
  virtual double *give(int i) = 0;
  virtual void take(int i) = 0;
  virtual void grow(int nmax) = 0;
  virtual double bytes() const = 0;

  /* As copy_arrays, pack_exchange, unpack_exchange of a fix. */
  void copy(int i, int j);
  int pack(int i, double *buffer) const;
  int unpack(int i, const double *buffer);
  int most_packed() const { return width + 1; }

 protected:
  const int width;
};

/* For those atoms that have some. Every atom has a pointer, eight bytes; only the few that need one
 * have a row. */
class AtomRows final : public RowsOfAtoms {
 public:
  explicit AtomRows(int columns) : RowsOfAtoms(columns), nothing(columns, 0.0) {}

  bool has(int i) const override { return rows[i] != nothing.data(); }
  const double *operator[](int i) const override { return rows[i]; }
  /* To write: of an atom that has one. */
  double *row(int i) { return rows[i]; }
  double *give(int i) override;
  void take(int i) override;
  void clear();
  void grow(int nmax) override { rows.resize(nmax, nothing.data()); }
  double bytes() const override;

 private:
  enum { ROWS_OF_A_BLOCK = 1024 };
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
class AtomArray final : public RowsOfAtoms {
 public:
  explicit AtomArray(int columns) : RowsOfAtoms(columns) {}

  /* array[i][column]; it moves when grow() is called */
  double **array() { return rows.data(); }
  bool has(int i) const override { return written[i]; }
  const double *operator[](int i) const override { return rows[i]; }
  double *give(int i) override;
  void take(int i) override;
  void grow(int nmax) override;
  double bytes() const override { return (double) rows.capacity() * (sizeof(double) * width + 9); }

 private:
  struct Free {
    void operator()(double *p) const { free(p); }
  };
  std::unique_ptr<double[], Free> block;
  std::vector<double *> rows;    // [nmax]
  std::vector<char> written;     // not zeros
};

}    // namespace StokesDyn
#endif
