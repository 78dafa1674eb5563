/* The stream of fix hydro/vans: its profiles and what moves them on, the same on every rank. Knows
 * no atoms: the fix brings sums over all of them. */
#ifndef SD_VANS_STREAM_H
#define SD_VANS_STREAM_H

#include "restart.h"
#include "sd_vans_books.h"
#include "sd_vans_steady.h"
#include "vans_settings.h"
#include "vans_told.h"

#include <deque>
#include <memory>
#include <vector>

namespace StokesDyn {

class VansStream {
 public:
  explicit VansStream(const VansSettings &settings);

  const VansSettings &set;
  VansTold told;
  const sd_vans_mesh &mesh;
  /* the slices of the water and one above its surface: the mesh itself unless the surface moves */
  sd_vans_mesh wet;
  /* as the settings have it, and what changes in a run */
  sd_vans_fluid fluid;
  /* [N+1]; rate: dU/dt, mean of the last solve */
  std::vector<double> U, rate;
  /* profile of all grains, and one after the other those of the classes */
  std::vector<double> grain, class_grain;
  std::vector<double> class_radii;
  /* of bins: their limits, one more, and the volume of the grains in each; empty: classes are radii */
  std::vector<double> class_limits, class_volumes;
  /* [N] */
  std::vector<double> hindrance, b, length, nut, stress;
  /* [N] per volume of grains: force of the viscous stress, impulse of the drag that the last solve
   * foresaw */
  std::vector<double> shear_density, foreseen_density;
  /* [2][N] force of the drag on the grains per volume of mixture, along x and z */
  std::vector<double> drag_density;
  /* [N] velocity of the water along z, with upflow; and what rises */
  std::vector<double> upward;
  /* [N] what the water bears besides its own weight, in the middle of the slices; with upflow */
  std::vector<double> pressure;
  double flux = 0.0;
  /* what drives the stream, gravity and pressure gradient, an acceleration */
  double drive = 0.0;
  /* pressure gradient along x that the grains feel until the next coupling */
  double felt = 0.0;
  /* the same, mean of the last solve */
  double mean_drive = 0.0;
  /* samples of the transport rate and of the largest stress, one a coupling */
  sd_vans_series series = {};
  /* are there averages? */
  bool averaged = false;
  /* also of the classes that there are now? A run may begin with others than the last one had. */
  bool classes_averaged = true;

  /* six numbers of a restart file; others: spheres that are averaged but not in the group, or all of them
   * where momentum is not accounted for */
  sd_vans_ledger ledger = {};

  int ncell() const { return mesh.ncell; }
  sd_vans_ambient ambient() const { return {&mesh, &set.law, U.data(), hindrance.data()}; }
  double *phi() { return grain.data(); }
  double *row(int k) { return grain.data() + (size_t) k * mesh.ncell; }
  void set_classes(const std::vector<double> &radii, const std::vector<double> &limits = {},
                   const std::vector<double> &volumes = {});
  const double *bins() const { return class_limits.empty() ? nullptr : class_limits.data(); }
  /* Columns as read_given has them, or none. */
  void take_given(const std::vector<std::vector<double>> &columns);
  /* From now on the water keeps its velocities. */
  void rest() { rate.assign(rate.size(), 0.0); }
  /* U or phi set from outside: hindrance, eddy viscosity and stress follow. */
  void profile_changed();

  /* New averages from sums over all grains, then of each class; forces [2][N] of the drag in each
   * slice, along x and z. */
  void take_averages(double area, const double *sums, const double *forces);
  /* Since the last solve, impulses along x. */
  struct Given {
    /* [N] what the drag foreseen then was more than the true one; empty: momentum is not accounted
     * for */
    std::vector<double> back;
    /* what the last solve had for grains that have gone since */
    double lost = 0.0;
    /* what the grains got from the water; spheres outside the group of it */
    double all = 0.0, others = 0.0;
    /* the water moves on alone, past grains that are held: what it gives them now counts as given
     * to others */
    bool held = false;
  };
  /* Over the time T in steps of about dt. */
  void solve(double area, double T, double dt, const Given &given);

  /* The end of a coupling. */
  void sample();
  /* What drives the water besides gravity gx is a pressure, which drives the grains in it too. */
  void feel_pressure(double gx);
  double transport() const { return sd_vans_transport(&mesh, grain.data()); }
  double surface() const { return wet.z_ref + wet.edge[wet.ncell - 1]; }

  double largest_stress() const { return sd_vans_largest_stress(&mesh, stress.data()); }
  double bed_elevation() const { return sd_vans_bed_elevation(&mesh, grain.data()); }

  void save(NamedState &state);
  void load(const NamedState &state);

 private:
  std::vector<double> wet_edge, wet_before;
  /* of water per area, which stays when the surface moves; < 0: not known yet */
  double volume = -1.0;
  const std::unique_ptr<sd_vans_solver, void (*)(sd_vans_solver *)> solver;
  std::vector<std::vector<double>> given;
  /* [N] momentum that is to go back to the water */
  std::vector<double> outstanding;
  /* ni_capart: the last profiles of phi */
  std::deque<std::vector<double>> phi_history;
  std::vector<double> scratch;
  /* is drag_density that of the profile? */
  bool density_known = false;

  const double *classes() const;
  void move_surface(double area, const std::vector<double> &phi_before);
  void take_inflow(double T);
  void fill_above();
  void mixing_length();
  void exchange(double T, double dt, bool held, std::vector<double> &rest);
  double give_back(double area, double T, const Given &given, std::vector<double> &source);
  void keep_books(double area, double T, const Given &given, const sd_vans_books &books);
  void tell_limits(double T, double dt, bool held, const double cut[2]);
  void tell_bottom();
  void tell_swings(double dt);
  [[noreturn]] void no_average(int n, double area);
  void check_mesh(const NamedState &state) const;
  void load_surface(const NamedState &state);
  std::vector<SavedNumbers> saved();
};

}    // namespace StokesDyn
#endif
