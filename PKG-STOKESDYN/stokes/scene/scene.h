/* From LAMMPS atoms to the core's arrays and back: who has the row of a sphere, who sees whom.
 *
 * Vectors of the core have a row of 3 numbers (6 with rotation) for each sphere that takes part.
 * Where clumps must be whole (Settings::whole) those of a clump are all on the rank that owns it,
 * side by side (whole_clumps.h), after the lone spheres of this rank; else every rank has the rows
 * of its own atoms. Atoms that take no part have none, so they cost nothing. Around the rows stand
 * copies of those that are near, of other ranks and images (halo.h). */
#ifndef SD_SCENE_H
#define SD_SCENE_H

#include "ambient.h"
#include "boundary.h"
#include "cloud.h"
#include "copy.h"
#include "halo.h"
#include "pointers.h"
#include "shells.h"
#include "whole_clumps.h"

#include "sd_mobility.h"
#include "sd_neighbor.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
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

class Scene : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    sd_tensor tensor = SD_TENSOR_RPY;
    sd_taper taper = SD_TAPER_NONE;
    double cutoff = 0.0;    // INFINITY: no cut-off
    bool clumps_only = false;
    bool rotation = false;    // vectors have force and torque, 6 numbers an atom
    /* clumps must be whole: they are rigid, or their spheres see each other and nobody else */
    bool whole = false;
    Boundary boundary;    // walls and periods
    /* how everybody sees everybody: all pairs, Ewald sums, or what costs less */
    enum { AUTO, DIRECT, EWALD };
    int far_field = AUTO;
    /* error of a product by Ewald sums over the rms of F/(6 pi eta a) */
    double far_field_tolerance = 0.0;
    // relative residual at which a solve ends: products of floats have none far below 1e-6
    double residual = 1e-3;
    /* periodic sums are split into two positive parts, for noise: sd_ewald_choose_positive; 0: not so */
    double positive = 0.0;
    bool everybody() const { return std::isinf(cutoff) && !clumps_only; }
  } &settings;

  Scene(const Voice &voice, Epochs &epochs, Settings &settings);

  /* Which spheres of which ranks the engine sees, since the last update(). */
  sd_view view() const { return engine->view; }
  /* Since when all of this is as it is */
  const Epochs &all_epochs() const { return epochs; }
  WholeClumps whole;
  /* Those of all ranks, in view ALL */
  Cloud cloud;
  /* Spheres are shells of points, which are what the engine sees; nullptr: they are points */
  Shells *shells = nullptr;
  /* With shells: finds which each sphere has, and turns those of clumps, when the rows stand */
  std::function<void()> fit, orient;
  void turn_shells()
  {
    if (!shells) return;
    fit();
    shells->free_rows(size(), a.data());
    orient();
  }

  // --- rows

  /* The atoms of this rank that take part, in the fluid of this step: the rows, and where they
   * stand. whole stands already. */
  void stand(const std::vector<int> &who, const Ambient &ambient);
  /* The same, and the engine's pairs: anew if LAMMPS has re-neighboured, or if the spheres are
   * others than before on any rank. idle: room that nobody else uses until this returns, for the places
   * of points; an engine that reads them later on has room of its own. */
  void update(const std::vector<int> &who, const Ambient &ambient, std::vector<double> &idle);
  const std::vector<int> &who() const { return own; }
  int size() const { return (int) tags.size(); }
  int64_t tag(int k) const { return tags[k]; }
  int64_t molecule(int k) const { return molecules[k]; }
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
  template <class Row> void columns(const Row &row, std::initializer_list<Columns> all)
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
  const double *drift_of_images() const { return jumping ? jumps : nullptr; }

  /* Rows and copies */
  int size_with_copies() const { return (int) a.size(); }
  sd_spheres local() const { return {x.data(), a.data(), w.data()}; }
  double largest() const { return most; }
  double smallest() const { return least; }
  // --- who sees whom, since the last update()

  const sd_pairs &list() const { return has_cutoff() ? pairs.pairs : candidates.pairs; }
  /* Does one sphere see another, or an image of itself, on any rank? Does that of row k see
   * nobody? Near a wall every sphere sees itself. */
  bool anybody_sees() const { return somebody_sees; }
  bool alone(int k) const
  {
    const bool listed = view() == SD_VIEW_LIST && !settings.boundary.has_images();
    return listed ? list().first[k] == list().first[k + 1] : !somebody_sees;
  }
  /* LAMMPS's, which is periodic in all directions or in none */
  static sd_ewald_box lattice_box(const LAMMPS_NS::Domain *domain);
  /* View NEAR, but for a slab; else nullptr */
  const sd_ewald *splitting() const
  {
    return view() == SD_VIEW_NEAR && engine != &sd_mobility_slab ? &ewald : nullptr;
  }
  /* The box around an open cloud whose sum is split, or the heights of a slab: six numbers to keep, as
   * the next box depends on the last one. */
  std::vector<double> open_box() const;
  void set_open_box(const std::vector<double> &box);
  sd_law law() const
  {
    return {settings.tensor, settings.taper, settings.cutoff, settings.boundary.image_wall()};
  }

  /* u = Omega F since the last update(): context of sd_mobility_apply. */
  sd_mobility *mobility() { return &omega; }
  /* What the core may ask of the other ranks: of the rows of spheres */
  sd_world ranks() const { return halo.ranks(); }

  double memory_usage() const;

 private:
  const Voice voice;
  Epochs &epochs;

  Stamp rows_found, pairs_found;
  bool somebody_sees = false;
  /* atoms that take part; those whose rows are the first here; rows of the members of whole */
  std::vector<int> own, lone_atoms, row_of;
  std::vector<int64_t> tags, molecules;
  /* rows, then copies */
  std::vector<double> x, a, w;
  /* of columns(): kept, since what a step asks the system for and gives back is cleared each time */
  std::vector<double> together;
  double most = 0.0, least = 0.0;
  /* by how much the velocity of an image grows with each edge of the box: Ambient::jumps */
  double jumps[6] = {0.0};
  bool jumping = false;
  Halo halo, halo_of_points;
  Owned<sd_neighbors, sd_neighbors_free> candidates, pairs;

  /* slab: ewald is that of its taller box */
  sd_ewald ewald = {};
  sd_ewald_level second_level = {};
  sd_slab slab = {};
  /* its parameters, as they were last told */
  std::string said;
  Stamp told;

  const sd_mobility_engine *engine = &sd_mobility_list;
  Owned<sd_mobility, sd_mobility_free> omega;

  const int *first_in_cloud() const { return shells ? shells->first_of_all().data() : nullptr; }
  int width() const { return settings.rotation && !shells ? 6 : 3; }
  /* how far a sphere's points are from its centre; their radius, and how many there are */
  double extent(double a) const { return shells ? shells->extent(a) : 0.0; }
  double grain(double a) const { return shells ? shells->grain(a) : a; }
  int points(double a) const { return shells ? shells->points(a) : 1; }
  double points_here() const { return shells ? shells->first_of_rows()[size()] : size(); }
  bool has_cutoff() const { return std::isfinite(settings.cutoff); }
  bool periodic() const;
  bool split();
  /* of a product, for sd_mobility_how.tolerance; 0: a solve goes on below the rounding of floats */
  double harmless_error() const;
  /* with which spheres, by their points, have far_field_tolerance */
  double tolerance_of_sums() const;
  const sd_mobility_engine *engine_of_all();
  sd_status choose(const sd_ewald_box &box, const sd_ewald_sizes &sizes);
  [[noreturn]] void no_grid(double count, const std::string &where, sd_status status) const;
  void refuse_images(double each, double images, double largest) const;
  /* Does the engine take each pair across a border on one side alone? */
  bool one_sided() const { return engine == &sd_mobility_ewald && !ewald.images.wall.sign; }
  void split_slab();
  sd_slab_spheres measure_slab(const sd_slab_walls &walls) const;
  sd_ewald_sizes sizes_of_all(double largest) const;
  sd_ewald_sizes measure(sd_ewald_box &box) const;
  void tell();
  void find_rows();
  void sort_lone_atoms();
  /* copies: found, or too many for this keyword's reach */
  void surround(bool found, const std::string &keyword);
  void find_pairs();
  void look_for_others(double spheres);
  void place(int n_all_or_copies, std::vector<double> &idle);
  std::vector<double> turned_shells(int n_all_or_copies);
  void place_points(int n_all_or_copies, std::vector<double> &idle, sd_mobility_scene &scene);
  sd_world ranks_of_cloud();
  [[noreturn]] void out_of_memory();
};

}    // namespace StokesDyn
#endif
