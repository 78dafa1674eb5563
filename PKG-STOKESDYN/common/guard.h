/* One guard for all styles: memory of C++ that is not there (std::bad_alloc), wherever it was asked
 * for below an entry point, ends the run on all ranks with "out of memory" and the way out. The
 * styles themselves know nothing of it: the table of styles (stokesdynplugin.cpp) makes them as
 * Guarded ones. Other exceptions are LAMMPS's own and pass. */
#ifndef SD_GUARD_H
#define SD_GUARD_H

#include "keywords.h"
#include "rows_fix.h"

#include <new>
#include <string>
#include <type_traits>

namespace StokesDyn {

template <class Body>
auto guarded(LAMMPS_NS::LAMMPS *lmp, const char *kind, const char *style, const Body &body)
{
  try {
    return body();
  } catch (const std::bad_alloc &) {
    fail_one(lmp,
             std::string(kind) + " " + style +
                 ": out of memory on this rank: fewer atoms on each (more ranks), or a shorter "
                 "cut-off, a coarser grid, a smaller shell");
  }
}

template <class Style> class GuardedFix final : public Style {
 public:
  GuardedFix(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : Style(lmp, narg, arg)
  {
    if constexpr (std::is_base_of_v<RowsFix, Style>) this->listen();
  }

  void init() override { guard([&] { Style::init(); }); }
  void setup(int flag) override { guard([&] { Style::setup(flag); }); }
  void setup_pre_exchange() override { guard([&] { Style::setup_pre_exchange(); }); }
  void setup_pre_force(int flag) override { guard([&] { Style::setup_pre_force(flag); }); }
  void initial_integrate(int flag) override { guard([&] { Style::initial_integrate(flag); }); }
  void post_integrate() override { guard([&] { Style::post_integrate(); }); }
  void pre_exchange() override { guard([&] { Style::pre_exchange(); }); }
  void pre_force(int flag) override { guard([&] { Style::pre_force(flag); }); }
  void post_force(int flag) override { guard([&] { Style::post_force(flag); }); }
  void final_integrate() override { guard([&] { Style::final_integrate(); }); }
  void end_of_step() override { guard([&] { Style::end_of_step(); }); }
  void post_run() override { guard([&] { Style::post_run(); }); }
  void write_restart(FILE *file) override { guard([&] { Style::write_restart(file); }); }
  void restart(char *buffer) override { guard([&] { Style::restart(buffer); }); }
  void grow_arrays(int nmax) override { guard([&] { Style::grow_arrays(nmax); }); }
  void unpack_restart(int i, int nth) override { guard([&] { Style::unpack_restart(i, nth); }); }
  int unpack_exchange(int i, double *buffer) override
  {
    return guard([&] { return Style::unpack_exchange(i, buffer); });
  }
  double compute_scalar() override
  {
    return guard([&] { return Style::compute_scalar(); });
  }
  double compute_vector(int k) override
  {
    return guard([&] { return Style::compute_vector(k); });
  }
  double compute_array(int i, int k) override
  {
    return guard([&] { return Style::compute_array(i, k); });
  }

 private:
  template <class Body> auto guard(const Body &body)
  {
    return guarded(this->lmp, "Fix", Style::STYLE, body);
  }
};

template <class Style> class GuardedCompute final : public Style {
 public:
  GuardedCompute(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : Style(lmp, narg, arg) {}

  void init() override { guard([&] { Style::init(); }); }
  void setup() override { guard([&] { Style::setup(); }); }
  double compute_scalar() override
  {
    return guard([&] { return Style::compute_scalar(); });
  }
  void compute_vector() override { guard([&] { Style::compute_vector(); }); }
  void compute_array() override { guard([&] { Style::compute_array(); }); }
  void compute_peratom() override { guard([&] { Style::compute_peratom(); }); }

 private:
  template <class Body> auto guard(const Body &body)
  {
    return guarded(this->lmp, "Compute", Style::STYLE, body);
  }
};

template <class Style> class GuardedPair final : public Style {
 public:
  explicit GuardedPair(LAMMPS_NS::LAMMPS *lmp) : Style(lmp) {}

  void settings(int narg, char **arg) override { guard([&] { Style::settings(narg, arg); }); }
  void coeff(int narg, char **arg) override { guard([&] { Style::coeff(narg, arg); }); }
  void init_style() override { guard([&] { Style::init_style(); }); }
  void setup() override { guard([&] { Style::setup(); }); }
  void compute(int eflag, int vflag) override { guard([&] { Style::compute(eflag, vflag); }); }
  void read_restart(FILE *file) override { guard([&] { Style::read_restart(file); }); }
  void read_restart_settings(FILE *file) override
  {
    guard([&] { Style::read_restart_settings(file); });
  }

 private:
  template <class Body> auto guard(const Body &body)
  {
    return guarded(this->lmp, "Pair style", Style::STYLE, body);
  }
};

}    // namespace StokesDyn
#endif
