#include "vans_stream.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

VansStream::VansStream(LAMMPS *lmp, const VansSettings &settings) : set(settings), lmp(lmp)
{
  const int N = set.ncell();
  mesh = {N, set.z_ref, set.dz, set.edge.data()};
  law = {set.rho,
         set.eta,
         set.hindrance,
         {set.g[0], set.g[1], set.g[2]},
         set.rest,
         set.lift,
         set.convective.empty() ? nullptr : set.convective.data(),
         set.rules};
  fluid = {set.rho,        set.eta,       set.g[0],    set.dpdx.number(),
           set.turbulence, set.kappa,     set.phi_max, set.phi_bed,
           set.sublayer,   set.viscosity, set.driven,  set.u_top.number(),
           set.width,      set.wall_coef, set.radius,  0,
           nullptr,        set.rules};
  U = set.profile;
  U.resize(N + 1, 0.0);
  if (set.profile.empty() && set.driven && !set.u_top.is_variable()) U[N] = set.u_top.number();
  grain.assign(5 * (size_t) N, 0.0);
  if (!set.given.empty()) {
    std::copy(set.given[0].begin(), set.given[0].end(), phi());
    std::copy(set.given[1].begin(), set.given[1].end(), vx());
    std::copy(set.given[2].begin(), set.given[2].end(), drag());
  }
  for (auto *array :
       {&hindrance, &b, &length, &nut, &stress, &shear_density, &foreseen_density, &outstanding})
    array->assign(N, 0.0);
  scratch.resize(4 * (size_t) N + 4);
  solver = sd_vans_solver_create(N);
  if (!solver)
    fail(lmp,
         std::string(VansSettings::COMMAND) + ": out of memory for " + std::to_string(N) +
             " slices");
  set_classes(set.class_radii);
  profile_changed();
}

VansStream::~VansStream()
{
  sd_vans_solver_free(solver);
}

void VansStream::set_classes(const std::vector<double> &radii)
{
  if (radii == class_radii && !class_grain.empty()) return;
  const size_t N = ncell();
  class_radii = radii;
  class_grain.assign(5 * N * radii.size(), 0.0);
  for (size_t c = 0; 4 + 2 * c < set.given.size() && c < radii.size(); c++) {
    std::copy(set.given[3 + 2 * c].begin(), set.given[3 + 2 * c].end(),
              class_grain.begin() + 5 * N * c);
    std::copy(set.given[4 + 2 * c].begin(), set.given[4 + 2 * c].end(),
              class_grain.begin() + 5 * N * c + 4 * N);
  }
  fluid.nclass = (int) class_radii.size();
  fluid.class_radius = class_radii.data();
}

std::vector<double> VansStream::class_columns(int k) const
{
  const size_t N = ncell();
  std::vector<double> columns;
  for (size_t c = 0; c < class_radii.size(); c++)
    columns.insert(columns.end(), class_grain.begin() + (5 * c + k) * N,
                   class_grain.begin() + (5 * c + k + 1) * N);
  return columns;
}

void VansStream::mixing_length()
{
  const int N = ncell();
  std::vector<double> mean(phi(), phi() + N);
  if (phi_history.size() > 1) {
    std::fill(mean.begin(), mean.end(), 0.0);
    for (const auto &profile : phi_history)
      for (int n = 0; n < N; n++) mean[n] += profile[n] / (double) phi_history.size();
  }
  // `given` without the columns of the classes: one class.
  const bool have = !class_radii.empty() && (averaged || set.given.size() > 3);
  const std::vector<double> class_phi = have ? class_columns(0) : std::vector<double>();
  sd_vans_mixing_length(&mesh, &fluid, U.data(), phi(), have ? class_phi.data() : nullptr,
                        mean.data(), length.data(), scratch.data());
}

void VansStream::profile_changed()
{
  sd_vans_hindrance(ncell(), phi(), law.exponent, hindrance.data());
  mixing_length();
  sd_vans_stress(&mesh, &fluid, phi(), length.data(), U.data(), nut.data(), stress.data());
}

void VansStream::take_averages(double area, const std::vector<double> &sums,
                               const std::vector<double> &class_sums)
{
  const size_t N = ncell();
  const std::vector<double> before(phi(), phi() + N);
  sd_vans_profiles(&mesh, area, sums.data(), grain.data());
  for (size_t c = 0; c < class_radii.size(); c++)
    sd_vans_profiles(&mesh, area, class_sums.data() + c * N * SD_VANS_NSUM,
                     class_grain.data() + 5 * c * N);
  for (size_t n = 0; n < N; n++)
    if (!(phi()[n] < 1.0)) {
      if (!std::isfinite(phi()[n]))
        fail(lmp,
             std::string(VansSettings::COMMAND) + ": the average in slice " +
                 std::to_string(n + 1) +
                 " is not finite: a grain has no finite position or velocity");
      fail(lmp,
           std::string(VansSettings::COMMAND) + ": phi = " + text(phi()[n]) + " in slice " +
               std::to_string(n + 1) + " (z = " + text(mesh.z_ref + mesh.edge[n]) + " to " +
               text(mesh.z_ref + mesh.edge[n + 1]) + "): more grains than fit. Is the area " +
               text(area) + " right, or do members of clumps overlap (overlap once)?");
    }
  if (set.conserve && averaged)
    ledger.surface +=
        area * sd_vans_displace(&mesh, fluid.rho, before.data(), phi(), U.data(), scratch.data());
  phi_history.emplace_back(phi(), phi() + N);
  while ((int) phi_history.size() > set.bed_average) phi_history.pop_front();
  averaged = true;
  sd_vans_hindrance(ncell(), phi(), law.exponent, hindrance.data());
}

/* Momentum. The solve takes `moved` from the water for the grains. Its viscous part is handed to them as a force until the
 * next solve. Its drag is what
 * the exchange coefficient foresees. When the next solve comes each grain has felt its true drag, and the difference goes
 * back to the water as a
 * source in the slices of that grain. So the water gives no more and no less than the grains get, one coupling later, and
 * the drag stays
 * implicit; the ledger holds what is on its way. Grain by grain and not slice by slice: a grain sees the water at its
 * centre only, and
 * a thin slice could not bear its part of that drag if it had no momentum left. And a tenth of what is outstanding at a
 * time: the differences of
 * single couplings are mostly noise, which would shake the water of a dense bed. */
static constexpr double RETURNED = 0.1;

void VansStream::solve(double area, double T, const Given &given)
{
  const int N = ncell(), M = N - 1;
  double dt = set.period > 0.0 ? set.dt : 0.1 * T;
  const int64_t steps = sd_vans_steps(set.rules, T, &dt);
  const bool exchange_classes =
      set.classes && !class_radii.empty() && (averaged || set.given.size() > 3);
  const std::vector<double> class_phi = exchange_classes ? class_columns(0) : std::vector<double>();
  const std::vector<double> class_drag = exchange_classes ? class_columns(4)
                                                          : std::vector<double>();
  sd_vans_exchange(&mesh, &fluid, dt, U.data(), phi(), vx(), drag(),
                   exchange_classes ? class_phi.data() : nullptr,
                   exchange_classes ? class_drag.data() : nullptr, b.data());
  mixing_length();

  std::vector<double> source, moved, shear;
  sd_vans_impulse impulse = {0, 0, 0, 0};
  const bool account = !given.back.empty();
  double returned = 0.0;
  if (account) {
    moved.resize(N);
    shear.resize(N);
    ledger.transit -= given.all;
    ledger.others += given.others;
    source.assign(N, 0.0);
    // Above the surface there is no water: the slice below it pays.
    for (int n = 0; n < N; n++) outstanding[std::min(n, M - 1)] += given.back[n] / area;
    for (int n = 0; n < M; n++) {
      const double share = RETURNED * outstanding[n];
      outstanding[n] -= share;
      returned += share;
      source[n] = share / (fluid.rho * height(n) * T);
    }
  }

  const sd_status status =
      sd_vans_solve(solver, &mesh, &fluid, steps, dt, phi(), vx(), b.data(), length.data(),
                    source.empty() ? nullptr : source.data(), U.data(), nut.data(), stress.data(),
                    account ? moved.data() : nullptr, account ? shear.data() : nullptr, &impulse);
  if (status != SD_OK)
    fail(lmp,
         std::string(VansSettings::COMMAND) + ": the solve of the stream over " + text(T) + " in " +
             std::to_string(steps) + " steps: " + sd_status_string(status) +
             ". Take a shorter time between couplings");
  if (!account) return;

  for (int n = 0; n < N; n++) {
    ledger.transit += area * moved[n];
    const double solid = n < M ? phi()[n] * height(n) : 0.0;
    shear_density[n] = solid > 0.0 ? shear[n] / (T * solid) : 0.0;
    foreseen_density[n] = solid > 0.0 ? (moved[n] - shear[n]) / solid : 0.0;
  }
  ledger.transit -= area * returned;
  ledger.driving += area * impulse.driving;
  ledger.bottom += area * impulse.bottom;
  ledger.walls += area * impulse.walls;
  ledger.surface += area * impulse.surface;
}

double VansStream::momentum(double area) const
{
  return area * sd_vans_momentum(&mesh, fluid.rho, grain.data(), U.data());
}

double VansStream::transport() const
{
  double q = 0.0;
  for (int n = 0; n < ncell(); n++) q += grain[n] * grain[ncell() + n] * height(n);
  return q;
}

double VansStream::largest_stress() const
{
  return *std::max_element(stress.begin(), stress.end());
}

double VansStream::bed_elevation() const
{
  if (!set.find_bed) return set.bed;
  for (int n = ncell() - 2; n > 0; n--)
    if (grain[n] > 0.5 && grain[n] >= grain[n + 1] && grain[n] >= grain[n - 1])
      return 0.5 * (mesh.edge[n] + mesh.edge[n + 1]);
  return 0.0;
}

double VansStream::depth_over_velocity(double bed) const
{
  double flux = 0.0, depth = 0.0;
  for (int n = 0; n < ncell() - 1; n++)
    if (0.5 * (mesh.edge[n] + mesh.edge[n + 1]) > bed) {
      flux += U[n + 1] * height(n);
      depth += height(n);
    }
  return flux > 0.0 ? depth * depth / flux : 0.0;
}

/* ncell, flags, ledger, then the arrays in the order of arrays(). */
std::vector<double> VansStream::pack() const
{
  std::vector<double> out = {(double) ncell(),
                             (double) averaged,
                             0.0,
                             (double) phi_history.size(),
                             (double) class_radii.size(),
                             fluid.radius,
                             ledger.transit,
                             ledger.driving,
                             ledger.bottom,
                             ledger.walls,
                             ledger.surface,
                             ledger.others};
  for (const auto *array : {&U, &grain, &b, &length, &nut, &stress, &shear_density,
                            &foreseen_density, &outstanding, &class_radii, &class_grain})
    out.insert(out.end(), array->begin(), array->end());
  for (const auto &profile : phi_history) out.insert(out.end(), profile.begin(), profile.end());
  return out;
}

void VansStream::unpack(const std::vector<double> &in)
{
  const size_t N = ncell();
  size_t at = 12;
  if (in.size() < at || (size_t) in[0] != N)
    fail(lmp,
         std::string(VansSettings::COMMAND) + ": keyword mesh: the restart file has " +
             std::to_string(in.empty() ? 0 : (int) in[0]) + " slices, this fix has " +
             std::to_string(N));
  averaged = in[1] != 0.0;
  const size_t history = (size_t) in[3], nclass = (size_t) in[4];
  if (set.radius == 0.0) fluid.radius = in[5];
  ledger.transit = in[6];
  ledger.driving = in[7];
  ledger.bottom = in[8];
  ledger.walls = in[9];
  ledger.surface = in[10];
  ledger.others = in[11];
  std::vector<double> radii(nclass), classes(5 * N * nclass);
  for (auto *array : {&U, &grain, &b, &length, &nut, &stress, &shear_density, &foreseen_density,
                      &outstanding, &radii, &classes})
    for (double &value : *array) value = in.at(at++);
  set_classes(radii);
  class_grain = classes;
  phi_history.clear();
  for (size_t k = 0; k < history; k++) {
    phi_history.emplace_back(in.begin() + at, in.begin() + at + N);
    at += N;
  }
  sd_vans_hindrance(ncell(), phi(), law.exponent, hindrance.data());
}
