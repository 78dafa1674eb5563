/* Of the stream of fix hydro/vans: what restart files hold of it. */
#include "vans_stream.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

std::vector<SavedNumbers> VansStream::saved()
{
  std::vector<SavedNumbers> all = {{"felt", &felt, 1},
                                   {"ledger", &ledger.transit, sizeof(ledger) / sizeof(double)},
                                   {"series", &series.blocks, sizeof(series) / sizeof(double)}};
  const struct {
    const char *name;
    std::vector<double> &values;
  } arrays[] = {{"U", U},
                {"rate", rate},
                {"grain", grain},
                {"class_grain", class_grain},
                {"b", b},
                {"length", length},
                {"nut", nut},
                {"stress", stress},
                {"shear", shear_density},
                {"foreseen", foreseen_density},
                {"outstanding", outstanding},
                {"drag_density", drag_density},
                {"upward", upward},
                {"pressure", pressure}};
  for (const auto &array : arrays) all.push_back({array.name, array.values.data(), array.values.size()});
  return all;
}

void VansStream::save(NamedState &state)
{
  state.put("z_ref", mesh.z_ref);
  state.put("edge", set.edge);
  state.put("volume", volume);
  state.put("surface", {(double) wet.ncell, drive});
  state.put("wet", wet_edge);
  state.put("averaged", averaged);
  state.put("classes_averaged", classes_averaged);
  state.put("density_known", density_known);
  state.put("radius", fluid.radius);
  state.put("class_radii", class_radii);
  state.put("class_limits", class_limits);
  state.put("class_volumes", class_volumes);
  state.put(set.voice.lmp->world, saved());
  std::vector<double> history;
  for (const auto &profile : phi_history)
    history.insert(history.end(), profile.begin(), profile.end());
  state.put("phi_history", history);
}

void VansStream::check_mesh(const NamedState &state) const
{
  const size_t N = ncell();
  const auto edge = state.get("edge");
  const Voice what = set.voice.of("keyword mesh");
  if (edge.size() != N + 1)
    what.fail("the restart file has " + std::to_string((int) edge.size() - 1) +
              " slices, this fix has " + std::to_string(N));
  double shift = std::fabs(state.get("z_ref", 0.0) - mesh.z_ref);
  for (size_t n = 0; n <= N; n++) shift = std::max(shift, std::fabs(edge[n] - mesh.edge[n]));
  if (!(shift <= 1e-9 * mesh.edge[N]))
    what.fail("the restart file has another mesh: its edges differ by up to " + text(shift) +
              " from those of this fix");
}

void VansStream::load_surface(const NamedState &state)
{
  double now[2];
  if (!state.get("surface", now, 2)) return;
  drive = now[1];
  if (fluid.held) fluid.gx = drive;
  if (!set.follows()) return;
  volume = state.get("volume", -1.0);
  wet.ncell = (int) now[0];
  state.get("wet", wet_edge.data(), wet_edge.size());
}

void VansStream::load(const NamedState &state)
{
  check_mesh(state);
  averaged = state.get("averaged", 0.0) != 0.0;
  density_known = state.get("density_known", 0.0) != 0.0;
  if (set.radius == 0.0) fluid.radius = state.get("radius", 0.0);
  set_classes(state.get("class_radii"), state.get("class_limits"), state.get("class_volumes"));
  state.get(set.voice.lmp->world, saved());
  classes_averaged = state.get("classes_averaged", 1.0) != 0.0;
  load_surface(state);
  const size_t N = ncell();
  const auto history = state.get("phi_history");
  phi_history.clear();
  for (size_t at = 0; at + N <= history.size(); at += N)
    phi_history.emplace_back(history.begin() + at, history.begin() + at + N);
  sd_hindrance_of(set.law.drag, ncell(), phi(), set.law.exponent, hindrance.data());
}
