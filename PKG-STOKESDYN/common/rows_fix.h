/* Rows of numbers that follow their atoms, which migrate, are sorted, created and deleted, and the fix
 * that keeps them, with what restart files hold of it. */
#ifndef SD_ROWS_FIX_H
#define SD_ROWS_FIX_H

#include "fix.h"

#include "keywords.h"
#include "restart.h"

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
  virtual double *writable(int i) = 0;
  virtual void erase(int i) = 0;
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
  double *writable(int i) override;
  void erase(int i) override;
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
  const double *operator[](int i) const override { return &block[(size_t) width * i]; }
  double *writable(int i) override
  {
    written[i] = 1;
    return &block[(size_t) width * i];
  }
  void erase(int i) override;
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

/* A fix that keeps such rows: LAMMPS's callbacks, handed on to all of them. */
class RowsFix : public LAMMPS_NS::Fix {
 public:
  RowsFix(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) :
      Fix(lmp, narg, arg), voice(lmp, "Fix " + std::string(style))
  {
  }
  ~RowsFix() override;

  const Voice voice;

  /* Asks LAMMPS to call back, when the constructor of the style has ended well. LAMMPS finds a callback by
   * the place of its fix in the list of fixes; a fix whose constructor fails never gets a place, so that its
   * callbacks could not be taken back. */
  void listen();
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return maxsize_restart(); }
  int maxsize_restart() override;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

 protected:
  /* The words of the fix command from the fourth on */
  Keywords keywords(int narg, char **arg) const
  {
    return Keywords(lmp, voice.command, words(narg, arg), 3);
  }
  /* Once, in the constructor. all: what it keeps; restarts: in restart files too. output: which of them is
   * array_atom, or nullptr. WITH_BORDERS: ghosts have rows as well (pack_border). moving: rows that follow
   * their atoms but are not in files; the fix writes them there in its own way, if at all. */
  enum Borders { NO_BORDERS, WITH_BORDERS };
  void keep(const std::vector<RowsOfAtoms *> &all, AtomArray *output, bool restarts,
            Borders borders = NO_BORDERS, const std::vector<RowsOfAtoms *> &moving = {});
  /* Before the rows of an atom are written to a restart file within a run. Between runs they stay as the last
   * one has left them, so that the next one, also from the file, knows who has been changed since. */
  virtual void record(int /*i*/) {}
  bool within_run() const;
  /* Do the rows of a restart file stand? */
  virtual bool restored() const { return true; }
  /* Atom i is not the one that the restart file has in its place: atoms were deleted between read_restart and
   * this fix. An error; internal fixes, which nobody can give before, begin anew. */
  virtual void another_in_file(int i);
  /* What else restart files hold: numbers, and whatever these two add before and after. The numbers are
   * in their places when read_state() is called, and asked for after write_state(); on all ranks together. */
  virtual std::vector<SavedNumbers> saved() { return {}; }
  virtual void write_state(NamedState &) {}
  virtual void read_state(const NamedState &) {}

 private:
  /* all of them, those of files first */
  std::vector<RowsOfAtoms *> kept;
  size_t in_files = 0;
  AtomArray *shown = nullptr;
  /* of LAMMPS's callbacks: which it wants, and which it has */
  std::vector<int> wanted, added;
};

}    // namespace StokesDyn
#endif
