/* From LAMMPS atoms to the core's arrays and back: who sees whom, on which rank. The only room that
 * knows ghosts.
 *
 * Vectors of the core have a row of 3 numbers (6 with rotation) for each sphere of this rank that
 * takes part, in the order of who(). Atoms that take no part have none, so they cost nothing. */
#ifndef SD_SCENE_H
#define SD_SCENE_H

#include "images.h"
#include "pointers.h"

#include "sd_mobility.h"
#include "sd_neighbor.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Pair;
}

namespace StokesDyn {

class Scene : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    sd_tensor tensor = SD_TENSOR_RPY;
    sd_taper taper = SD_TAPER_NONE;
    double cutoff = 0.0;    // INFINITY: no cut-off
    bool clumps_only = false;
    bool rotation = false;    // vectors have force and torque, 6 numbers an atom
    /* how everybody sees everybody: all pairs, Ewald sums, or what costs less */
    enum { AUTO, DIRECT, EWALD };
    int far_field = AUTO;
    /* error of a product by Ewald sums over the rms of F/(6 pi eta a) */
    double far_field_tolerance = 0.0;
    bool everybody() const { return std::isinf(cutoff) && !clumps_only; }
  } settings;

  Scene(LAMMPS_NS::LAMMPS *lmp, LAMMPS_NS::Pair *pair, const std::string &command);
  ~Scene();
  Scene(const Scene &) = delete;
  Scene &operator=(const Scene &) = delete;

  /* Other settings, or a new run. */
  void init();
  /* Which spheres of which ranks the engine sees, since the last update(). */
  sd_view view() const { return engine->view; }

  /* The spheres of this step: row k is the atom who[k] of this rank, in a fluid of viscosity
   * eta[k]. Finds the pairs again if LAMMPS has re-neighboured, or if they are others than before
   * on any rank.
   * Errors: a clump that the ghosts do not cover, or wider than half the periodic box. */
  void update(const std::vector<int> &who, const std::vector<double> &eta);
  const std::vector<int> &who() const { return own; }
  int size() const { return (int) own.size(); }

  /* The clumps of which this rank owns an atom, each once; lone spheres (molecule 0) are none. */
  struct Clump {
    int64_t molecule;
    int begin, end;    // its spheres: member[begin] ... member[end-1], in order of tag
  };
  std::vector<Clump> clumps;
  std::vector<int> member;    // owned or ghost atom: the images closest to the first owned one
  std::vector<int> owned;     // the same sphere as an atom of this rank, -1: another rank has it
  std::vector<int64_t> member_tag;
  /* Finds them if LAMMPS has re-neighboured; did it? Errors as of update(). */
  bool update_clumps();

  /* Of all atoms: row(i, out) writes the row of the owned atom i, only where it goes to a ghost.
   * ghosts [width nghost], in order of LAMMPS. */
  void refresh_ghosts(std::vector<double> &ghosts, int width,
                      const std::function<void(int, double *)> &row);
  /* Of the spheres: rows [width size()] -> ghosts [width (size_with_ghosts() - size())] */
  void refresh_ghosts(const double *rows, double *ghosts, int width);

  void lists_are_stale() { stale = clumps_stale = true; }

  /* View LIST: who sees whom since the last update(), in rows; ghosts that take part come after
   * this rank's spheres. */
  const sd_pairs &list() const { return filtered ? pairs.pairs : candidates.pairs; }
  int size_with_ghosts() const { return (int) a.size(); }
  sd_spheres local() const { return {x.data(), a.data(), w.data()}; }
  /* Since the last update(): does one sphere see another, or an image of itself, on any rank? Does
   * that of row k see nobody? */
  bool anybody_sees() const { return somebody_sees; }
  bool alone(int k) const
  {
    return view() == SD_VIEW_LIST ? list().first[k] == list().first[k + 1] : !somebody_sees;
  }
  /* View NEAR; else nullptr */
  const sd_ewald *splitting() const { return view() == SD_VIEW_NEAR ? &ewald : nullptr; }
  /* The box around an open cloud whose sum is split: six numbers to keep, as the next box depends
   * on the last one. */
  std::vector<double> open_box() const;
  void set_open_box(const std::vector<double> &box);
  sd_law law() const { return {settings.tensor, settings.taper, settings.cutoff}; }

  /* View ALL: the spheres of all ranks that take part, in order of tag, the same on every rank. */
  int cloud_size() const { return n_all; }
  sd_spheres cloud() const { return {all_x.data(), all_a.data(), all_w.data()}; }
  const std::vector<int64_t> &cloud_molecules() const { return all_molecule; }
  /* From rows of this rank's spheres to rows of the cloud, and, summed over the ranks, back. */
  void to_cloud(const double *own_rows, double *cloud_rows, int width);
  void from_cloud(const double *cloud_rows, double *own_rows, int width);

  /* u = Omega F since the last update(): context of sd_mobility_apply. */
  sd_mobility *mobility() { return &omega; }
  /* Sum over all ranks, in the core's signature: ctx is a Scene. */
  static sd_status sum(void *ctx, double *values, int count);

  int pack_forward_comm(int n, int *list, double *buf);
  void unpack_forward_comm(int n, int first, double *buf);
  double memory_usage() const;

 private:
  LAMMPS_NS::Pair *pair;
  std::string command;

  bool stale = true, clumps_stale = true;
  /* does pairs differ from candidates? */
  bool filtered = false;
  bool somebody_sees = false;
  /* atoms of this rank's spheres: those of the last update() */
  std::vector<int> own;
  /* view LIST: spheres, those of ghosts after our own */
  std::vector<double> x, a, w;
  /* [nghost] row of a ghost, -1: takes no part */
  std::vector<int> row_of_ghost;
  /* [nlocal] row of an atom, -1: takes no part */
  std::vector<int> row_of;
  sd_neighbors candidates, pairs;

  // of all atoms, for the clumps
  std::vector<int64_t> tag, molecule;
  std::vector<int> order;
  sd_neighbors rows;    // one for each clump

  // view ALL: the spheres of all ranks in order of tag: nothing depends on the decomposition
  /* [n_all] place of each sphere, the ranks' spheres one after the other */
  std::vector<int> place_of;
  /* [nprocs] */
  std::vector<int> spheres_of_rank;
  std::vector<double> all_x, all_a, all_w, in_order_of_rank;
  std::vector<int64_t> all_molecule;
  int n_all = 0;

  // view NEAR: images behind our own spheres, in x, a, w
  Images images;
  sd_ewald ewald = {};
  /* its parameters, as they were last told */
  std::string said;
  bool told = false;

  const sd_mobility_engine *engine = &sd_mobility_list;
  sd_mobility omega;

  // of a communication
  double *ghost_rows = nullptr;
  int row_width = 0;
  const std::function<void(int, double *)> *row_writer = nullptr;

  int width() const { return settings.rotation ? 6 : 3; }
  const double *positions() const;
  bool periodic() const;
  bool split();
  sd_ewald_sizes sizes_of_all(double largest);
  sd_ewald_sizes measure(sd_ewald_box &box);
  void tell();
  void place_rows(const std::vector<double> &eta);
  void place_ghosts();
  void find_pairs();
  void look_up(std::vector<int64_t> &ids, std::vector<int64_t> &molecules);
  /* Spheres among which clumps are checked: those of this rank. */
  struct Checked {
    int n;
    const double *x;
    const int64_t *molecule;
  };
  void check_clumps(const Checked &of, const sd_neighbors &list, bool one_row);
  void gather(const std::vector<double> &eta);
  void send_rows(double *ghosts, int width, const std::function<void(int, double *)> &row);
  void shares(int width, std::vector<int> &counts, std::vector<int> &displs) const;
  void place(int n_all);
  [[noreturn]] void complain_about_clumps(const Checked &of, const std::set<int64_t> &suspect);
  [[noreturn]] void out_of_memory();
};

}    // namespace StokesDyn
#endif
