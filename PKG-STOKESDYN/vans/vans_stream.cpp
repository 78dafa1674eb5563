#include "vans_stream.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

VansStream::VansStream(const VansSettings &settings) :
    set(settings), told(set.voice), mesh(set.mesh), wet(set.mesh), fluid(set.fluid), U(set.profile),
    wet_edge(set.edge), solver(sd_vans_solver_create(&wet), sd_vans_solver_free)
{
  const int N = ncell();
  if (!solver) set.voice.fail_one("out of memory for " + std::to_string(N) + " slices");
  U.resize(N + 1, 0.0);
  rate.assign(N + 1, 0.0);
  wet.edge = wet_edge.data();
  if (set.follows()) {
    wet.dz = 0.0;
    wet.ncell = sd_vans_fill(&mesh, nullptr, set.surface, wet_edge.data());
  }
  drive = mean_drive = sd_vans_drive(&fluid);
  if (set.profile.empty() && fluid.driven && !set.u_top.is_variable()) U[N] = fluid.u_top;
  fluid.radius = set.radius;
  grain.assign(SD_VANS_ROWS * (size_t) N, 0.0);
  for (auto *array :
       {&hindrance, &b, &length, &nut, &stress, &shear_density, &foreseen_density, &outstanding})
    array->assign(N, 0.0);
  drag_density.assign(2 * (size_t) N, 0.0);
  if (set.upflow) upward.assign(N, 0.0), pressure.assign(N, 0.0);
  scratch.resize(2 * (size_t) N + 2);
  set_classes(set.class_radii);
  take_given(set.given);
}

/* Averages of classes that stay are kept; the means of bins are sums over ranks, whose last digit
 * depends on these. */
void VansStream::set_classes(const std::vector<double> &radii, const std::vector<double> &limits,
                             const std::vector<double> &volumes)
{
  const size_t N = ncell(), profile = SD_VANS_ROWS * N;
  const bool same = limits == class_limits && (!limits.empty() || radii == class_radii);
  if (!same || class_grain.size() != profile * radii.size()) {
    class_grain.assign(profile * radii.size(), 0.0);
    classes_averaged = radii.empty();
  }
  class_radii = radii;
  class_limits = limits;
  class_volumes = volumes;
  fluid.nclass = (int) class_radii.size();
  fluid.class_radius = class_radii.data();
  fluid.class_volume = volumes.empty() ? nullptr : class_volumes.data();
}

void VansStream::take_given(const std::vector<std::vector<double>> &columns)
{
  given = columns;
  const size_t profile = SD_VANS_ROWS * (size_t) ncell();
  const auto put = [this](size_t column, double *at) {
    std::copy(given[column].begin(), given[column].end(), at);
  };
  if (!given.empty()) {
    put(0, phi());
    put(1, row(SD_VANS_VX));
    put(2, row(SD_VANS_DRAG));
  }
  for (size_t c = 0; 4 + 2 * c < given.size(); c++) {
    put(3 + 2 * c, &class_grain[profile * c]);
    put(4 + 2 * c, &class_grain[profile * c + SD_VANS_DRAG * ncell()]);
  }
  density_known = false;
  profile_changed();
}

/* `given` without the columns of the classes: one class. */
const double *VansStream::classes() const
{
  return !class_radii.empty() && (averaged || given.size() > 3) ? class_grain.data() : nullptr;
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
  /* of the classes phi counts, in rows as long as the mesh of the water */
  std::vector<double> of_classes;
  const size_t profile = SD_VANS_ROWS * (size_t) N, wet_profile = SD_VANS_ROWS * (size_t) wet.ncell;
  if (classes() && set.follows()) {
    of_classes.assign(wet_profile * class_radii.size(), 0.0);
    for (size_t c = 0; c < class_radii.size(); c++)
      std::copy_n(&class_grain[c * profile], wet.ncell, &of_classes[c * wet_profile]);
  }
  const sd_vans_mixture now = {U.data(), phi(), of_classes.empty() ? classes() : of_classes.data(), mean.data()};
  sd_vans_mixing_length(&wet, &fluid, &now, length.data(), scratch.data());
}

void VansStream::profile_changed()
{
  sd_hindrance_of(set.law.drag, ncell(), phi(), set.law.exponent, hindrance.data());
  mixing_length();
  const sd_vans_flow flow = {U.data(), nut.data(), stress.data()};
  sd_vans_stress(&wet, &fluid, phi(), length.data(), &flow);
  fill_above();
}

void VansStream::no_average(int n, double area)
{
  const std::string slice = "slice " + std::to_string(n + 1);
  if (!std::isfinite(phi()[n]))
    set.voice.fail("the average in " + slice +
                   " is not finite: a grain has no finite position or velocity");
  set.voice.fail("phi = " + text(phi()[n]) + " in " + slice + " (z = " +
                 text(mesh.z_ref + mesh.edge[n]) + " to " + text(mesh.z_ref + mesh.edge[n + 1]) +
                 "): more grains than fit. Is the area " + text(area) +
                 (set.point ? " right, and are slices as high as grains (grains point)?"
                            : " right, or do members of clumps overlap (overlap once)?"));
}

void VansStream::take_averages(double area, const double *sums, const double *forces)
{
  const size_t N = ncell(), profile = SD_VANS_ROWS * N;
  const std::vector<double> before(phi(), phi() + N);
  sd_vans_profiles(&mesh, area, sums, grain.data());
  for (size_t c = 0; c < class_radii.size(); c++)
    sd_vans_profiles(&mesh, area, sums + (1 + c) * profile, class_grain.data() + c * profile);
  for (size_t n = 0; n < N; n++)
    if (!(phi()[n] < 1.0)) no_average((int) n, area);
  if (set.follows())
    move_surface(area, before);
  else if (set.conserve && averaged)
    ledger.surface +=
        area * sd_vans_displace(&mesh, &mesh, fluid.rho, before.data(), phi(), U.data(), scratch.data());
  sd_vans_force_density(&mesh, area, forces, drag_density.data());
  density_known = true;
  if (set.upflow) {
    sd_vans_rise(&mesh, grain.data(), flux, !averaged, upward.data());
    sd_vans_borne(&mesh, &drag_density[N], pressure.data());
  }
  phi_history.emplace_back(phi(), phi() + N);
  while ((int) phi_history.size() > set.bed_average) phi_history.pop_front();
  averaged = classes_averaged = true;
  sd_hindrance_of(set.law.drag, ncell(), phi(), set.law.exponent, hindrance.data());
}

/* The surface goes where the water that there is fills the mesh between the grains. */
void VansStream::move_surface(double area, const std::vector<double> &before)
{
  if (volume < 0.0) {
    volume = sd_vans_volume(&wet, phi());
    return;
  }
  wet_before = wet_edge;
  sd_vans_mesh old = wet;
  old.edge = wet_before.data();
  const int cells = sd_vans_fill(&mesh, phi(), volume, wet_edge.data());
  if (cells == 0) {
    wet_edge = wet_before;      // whoever catches the error may go on
    set.voice.of("keyword surface")
        .fail("the water rises above the mesh, which ends at z = " +
              text(mesh.z_ref + mesh.edge[ncell() - 1]) + ": give the mesh more slices");
  }
  wet.ncell = cells;
  if (set.conserve)
    ledger.surface += area * sd_vans_displace(&old, &wet, fluid.rho, before.data(), phi(), U.data(),
                                              scratch.data());
  fill_above();
}

/* Above the surface the water, if there were any, moves with it. */
void VansStream::fill_above()
{
  const int M = wet.ncell - 1, N = ncell();
  if (!set.follows()) return;
  for (int n = M + 1; n <= N; n++) U[n] = U[M];
  for (int n = M + 1; n < N; n++) b[n] = length[n] = nut[n] = stress[n] = 0.0;
}

/* With the depth adjusted: what comes into the reach and does not pass stays there. A stream along -x comes
 * in at the other end. The surface moves with the next averages. */
void VansStream::take_inflow(double T)
{
  if (set.reach == 0.0 || volume < 0.0) return;
  const double along = std::copysign(1.0, fluid.discharge),
               passes = along * sd_vans_momentum(&wet, 1.0, phi(), U.data());
  volume = sd_vans_inflow(volume, along * fluid.discharge, passes, set.reach, T);
}

void VansStream::feel_pressure(double gx)
{
  felt = set.yade() ? 0.0 : fluid.held ? fluid.rho * (gx - mean_drive) : fluid.dpdx;
}

void VansStream::sample()
{
  const double now[SD_VANS_SERIES] = {transport(), largest_stress()};
  sd_vans_series_add(&series, now);
}

/* Once each: a solve that covers more time than the drag allows, and drag that the limits of b keep
 * from the water; with conserve yes the books bring that back. The time of the solve counts,
 * however long the grains have moved since the last one: the water loses b T of its slip before it
 * knows what drag the grains felt. Past grains that are held it need not know. */
void VansStream::tell_limits(double T, double dt, bool held, const double cut[2])
{
  int slice = 0;
  const double rate = sd_vans_drag_rate(&mesh, &fluid, U.data(), hindrance.data(), grain.data(),
                                        &slice);
  if (set.couple == VansSettings::TWO && !held && rate * T > 3.0)
    told.warn(VansTold::FAR_APART,
              "the couplings are too far apart: drag changes the water at z = " +
                  text(mesh.z_ref + mesh.edge[slice]) + " at the rate b = " + text(rate) + ", b T = " +
                  text(rate * T) + " for the time T = " + text(T) +
                  " of one solve. Above 3 the drag overshoots, more with every coupling. Use a T of at most " +
                  text(3.0 / rate) +
                  (set.period > 0.0 ? ": a shorter period of keyword solve, and N steps that take as long"
                                    : ": fewer steps N"));
  const double force = std::fabs(fluid.rho * drive) * wet.edge[wet.ncell - 1];
  if (!set.conserve && cut[0] > 0.05 * cut[1] && cut[1] > 0.01 * force)
    told.warn(VansTold::CUT_OFF,
              text(100.0 * cut[0] / cut[1]) +
                  " % of the drag does not reach the water: the exchange coefficient b is at most 1/(10 dt) = " +
                  text(0.1 / dt) + ", and this drag needs a b of up to " + text(rate) +
                  ". Use a step dt of keyword solve of at most " + text(0.1 / rate) + ", or " +
                  (set.yade() ? "rules consistent" : "conserve yes"));
}

/* Viscosity alone rubs on a bottom without grains. In a slice that goes beyond its layer that is too little; the
 * errors are those of the page vans_stream. */
void VansStream::tell_bottom()
{
  constexpr double HIGHEST = 20.0, FINE = 5.0;
  if (told.has(VansTold::HIGH_BOTTOM) || set.yade() || fluid.turbulence == SD_VANS_LAMINAR || phi()[0] > 0.0) return;
  const double size = sd_vans_bottom_slice(&mesh, &fluid, U.data());
  if (!(size > HIGHEST)) return;
  told.warn(VansTold::HIGH_BOTTOM,
            "keyword mesh: the lowest slice has no grains and is " + text(size) +
                " nu/u_star high: above 20 the bottom rubs too little and the stream becomes too fast, twice as fast "
                "at 100; give the lowest slices a height of at most " +
                text(FINE / size * sd_vans_height(&mesh, 0)) +
                ", 5 nu/u_star (mesh file NAME has slices of different heights)");
}

/* The eddy viscosity of a step is that of the velocity before it. Of a mode that dies at the rate r (1 - r dt)/(1 + r
 * dt) is left, so that it changes its sign in every step where r dt is above 1. Side walls are half of the step before,
 * and of (1 - 1.5 r dt)/(1 + 0.5 r dt): they grow from r dt = 2 on. */
void VansStream::tell_swings(double dt)
{
  if (told.has(VansTold::SWINGS)) return;
  double time = 2.0 / sd_vans_wall_rate(&wet, &fluid, U.data());    // infinite without walls
  if (fluid.turbulence != SD_VANS_LAMINAR)
    time = std::min(time, wet.edge[wet.ncell - 1] / std::sqrt(std::fabs(largest_stress()) / fluid.rho));
  if (!(dt > time)) return;
  told.warn(VansTold::SWINGS,
            "keyword solve: the step dt = " + text(dt) + " is longer than the time " + text(time) +
                " in which eddies over the depth, or side walls, take the momentum of the stream: the velocity swings "
                "from step to step, as both are those of the velocity before; use a dt of at most " + text(0.1 * time));
}

/* b, and what it has too much at the start as a source. */
void VansStream::exchange(double T, double dt, bool held, std::vector<double> &rest)
{
  /* exact for any sizes, unless the user has a radius of his own or the grains are given */
  const bool by_radius = set.yade() || set.radius > 0.0 || !density_known;
  const sd_vans_means grains = {grain.data(), set.classes ? classes() : nullptr,
                                by_radius ? nullptr : drag_density.data()};
  double cut[2] = {0.0, 0.0};
  if (set.law.felt_by_volume) {
    rest.resize(ncell());
    sd_vans_exchange_by_law(&mesh, &fluid, U.data(), hindrance.data(), &grains, b.data(), rest.data());
  } else
    sd_vans_exchange(&mesh, &fluid, dt, U.data(), &grains, b.data(), cut);
  tell_limits(T, dt, held, cut);
  /* grains above the surface have no water */
  std::fill(b.begin() + wet.ncell, b.end(), 0.0);
  if (!rest.empty()) std::fill(rest.begin() + wet.ncell, rest.end(), 0.0);
}

/* What the drag foreseen in the last solve was more than the true one goes back to the water, as a source
 * over the time T. Returns how much. */
double VansStream::give_back(double area, double T, const Given &given, std::vector<double> &source)
{
  std::vector<double> back = given.back;
  sd_vans_share_out(&wet, phi(), given.lost, back.data());
  source.resize(ncell());
  return sd_vans_give_back(&wet, ncell(), fluid.rho * area, T, back.data(), outstanding.data(), source.data());
}

/* What passed in a solve, into the ledger */
void VansStream::keep_books(double area, double T, const Given &given, const sd_vans_books &books)
{
  sd_vans_ledger_solve(&ledger, area, ncell(), &books, !given.back.empty());
  if (!given.back.empty()) {
    std::fill(shear_density.begin(), shear_density.end(), 0.0);
    std::fill(foreseen_density.begin(), foreseen_density.end(), 0.0);
    sd_vans_hand_over(&wet, phi(), T, &books, shear_density.data(), foreseen_density.data());
  }
  ledger.others += given.others;
}

void VansStream::solve(double area, double T, double dt, const Given &given)
{
  const int64_t steps = sd_vans_steps(fluid.rules, T, &dt);
  std::vector<double> rest, source, moved(ncell()), shear(ncell());
  if (!fluid.held) drive = sd_vans_drive(&fluid);
  exchange(T, dt, given.held, rest);
  mixing_length();

  const double returned = given.back.empty() ? 0.0 : give_back(area, T, given, source);
  source.resize(std::max(source.size(), rest.size()));
  for (size_t n = 0; n < rest.size(); n++) source[n] += rest[n];
  const sd_vans_column water = {phi(), row(SD_VANS_VX), b.data(), length.data(),
                                source.empty() ? nullptr : source.data()};
  const sd_vans_flow flow = {U.data(), nut.data(), stress.data()};
  sd_vans_books books = {moved.data(), shear.data(), 0, 0, 0, 0, 0};
  std::copy(U.begin(), U.end(), rate.begin());
  const sd_status status = sd_vans_solve(solver.get(), &fluid, &water, steps, dt, &flow, &books);
  if (status != SD_OK)
    set.voice.fail("the solve of the stream over " + text(T) + " in " + std::to_string(steps) +
                   " steps: " + sd_status_string(status) +
                   ". Take a shorter time between couplings");

  fill_above();
  for (size_t n = 0; n < U.size(); n++) rate[n] = (U[n] - rate[n]) / T;
  take_inflow(T);
  drive = books.drive;
  mean_drive = books.driving / (fluid.rho * T * sd_vans_volume(&wet, phi()));
  if (fluid.held) fluid.gx = drive;    // for what else asks how strong the stream is
  if (!rest.empty()) sd_vans_take_out_rest(&wet, fluid.rho, T, rest.data(), &books);
  keep_books(area, T, given, books);
  ledger.transit -= given.all + returned;
  tell_bottom();
  tell_swings(dt);
}
