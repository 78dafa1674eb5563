/* From LAMMPS atoms to the core's arrays and back: which spheres take part, and who has the row of each.
 *
 * Vectors of the core have a row of 3 numbers (6 with rotation) for each sphere that takes part.
 * Where clumps must be whole (SceneSettings::whole) those of a clump are all on the rank that owns it,
 * side by side (whole_clumps.h), after the lone spheres of this rank; else every rank has the rows
 * of its own atoms. Atoms that take no part have none, so they cost nothing. Who sees whom, and copies of
 * those that are near behind the rows, is a matter of the engine (engine.h). */
#ifndef SD_SCENE_H
#define SD_SCENE_H

#include "copy.h"
#include "pointers.h"
#include "scene_settings.h"
#include "whole_clumps.h"

#include <cstdint>
#include <initializer_list>
#include <vector>

namespace StokesDyn {

/* Rows of numbers [width n] taken apart: so many columns of each, from the first one on, to a vector of
 * their own [count n] */
struct Columns {
  std::vector<double> *to;
  size_t count;
};
inline void take_apart(const std::vector<double> &rows, size_t n, std::initializer_list<Columns> all)
{
  size_t width = 0, at = 0;
  for (const Columns &columns : all) width += columns.count;
  for (const Columns &columns : all) {
    columns.to->reserve(columns.count * (n + 1));    // data() is a place even where there are no rows
    columns.to->resize(columns.count * n);
    for (size_t k = 0; k < n; k++)
      copy_row(columns.count, rows.data() + width * k + at, columns.to->data() + columns.count * k);
    at += columns.count;
  }
}

class Ambient;
class Halo;

class Scene : protected LAMMPS_NS::Pointers {
 public:
  Scene(const Voice &voice, Epochs &epochs, const Ambient &, const SceneSettings &);

  const SceneSettings &settings;
  /* Since when all of this is as it is */
  const Epochs &all_epochs() const { return epochs; }
  WholeClumps whole;

  /* The atoms of this rank that take part, in the fluid of this step: the rows, and where they
   * stand. whole stands already. */
  void stand(const std::vector<int> &who);
  const std::vector<int> &who() const { return own; }
  int size() const { return (int) tags.size(); }
  /* Numbers of a row */
  int width() const { return settings.rotation ? 6 : 3; }
  int64_t tag(int k) const { return tags[k]; }
  int64_t molecule(int k) const { return molecules[k]; }
  const std::vector<int64_t> &all_tags() const { return tags; }
  const std::vector<int64_t> &all_molecules() const { return molecules; }
  /* Rows of this rank's lone spheres come first; whole: row of a member, -1: it takes no part */
  int lone() const { return (int) lone_atoms.size(); }
  int row_of_member(int m) const { return row_of[m]; }
  /* Rows [width size()], at least one: row(i, out) writes what goes of atom i, which may be one that
   * takes no part. And back: take(i, row) for every atom of this rank that takes part. On all ranks
   * together. */
  template <class Row> std::vector<double> rows(int width, const Row &row) const
  {
    std::vector<double> out(width * (tags.size() + 1));
    rows_to(width, row, [&](size_t k) { return &out[width * k]; });
    return out;
  }
  /* The same taken apart, where row(i, out) writes all numbers of a row */
  template <class Row> void columns(const Row &row, std::initializer_list<Columns> all) const
  {
    size_t width = 0;
    for (const Columns &columns : all) width += columns.count;
    together.resize(width * (tags.size() + 1));
    rows_to((int) width, row, [&](size_t k) { return &together[width * k]; });
    take_apart(together, tags.size(), all);
  }
  template <class Take> void to_atoms(int width, const double *rows, const Take &take) const
  {
    some_to_atoms(width, [=](size_t k) { return rows + width * k; }, take);
  }
  /* The same of rows wherever they are: room(k), at(k) [width]; nullptr: that one does not go */
  template <class Row, class Room> void rows_to(int width, const Row &row, const Room &room) const
  {
    for (size_t k = 0; k < lone_atoms.size(); k++)
      if (double *out = room(k)) row(lone_atoms[k], out);
    if (!settings.whole) return;
    whole.gather_to(width, row, [&](size_t m) {
      return row_of[m] >= 0 ? room(row_of[m]) : nullptr;
    });
  }
  template <class At, class Take> void some_to_atoms(int width, const At &at, const Take &take) const
  {
    for (size_t k = 0; k < lone_atoms.size(); k++)
      if (const double *row = at(k)) take(lone_atoms[k], row);
    if (!settings.whole) return;
    const auto all = [&](const auto &give) {
      for (size_t m = 0; m < row_of.size(); m++)
        if (const double *row = row_of[m] >= 0 ? at(row_of[m]) : nullptr) give(m, row);
    };
    whole.scatter(width, all, take);
  }
  /* Rows [width n] that begin with velocities, from those of atoms to those of the images that the
   * rows stand for; sign -1: back */
  void drift(double *rows, int width, double sign) const;
  /* By how much the velocity of an image grows with each edge of the box, in the order of Lattice::h;
   * nullptr: not at all */
  const double *drift_of_images() const;

  /* Where the spheres of the rows stand, and with those behind them, their copies, since they were brought */
  sd_spheres local() const { return {x.data(), a.data(), w.data()}; }
  int size_with_copies() const { return (int) a.size(); }
  const std::vector<double> &places() const { return x; }
  void bring(Halo &copies);
  /* Radii, on all ranks */
  double largest() const { return most; }
  double smallest() const { return least; }

  double memory_usage() const;

 private:
  Epochs &epochs;
  const Ambient &ambient;

  Stamp found;
  /* atoms that take part; those whose rows are the first here; rows of the members of whole */
  std::vector<int> own, lone_atoms, row_of;
  std::vector<int64_t> tags, molecules;
  /* rows, then copies */
  std::vector<double> x, a, w;
  /* of columns(): kept, since what a step asks the system for and gives back is cleared each time */
  mutable std::vector<double> together;
  double most = 0.0, least = 0.0;

  void find_rows();
  void sort_lone_atoms();
};

}    // namespace StokesDyn
#endif
