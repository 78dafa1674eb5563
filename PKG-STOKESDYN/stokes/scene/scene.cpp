#include "scene.h"

#include "ambient.h"
#include "halo.h"

#include "atom.h"
#include "domain.h"

#include "sd_cells.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Scene::Scene(const Voice &voice, Epochs &epochs, const Ambient &ambient, const SceneSettings &settings) :
    Pointers(voice.lmp), settings(settings), whole(voice, epochs), epochs(epochs), ambient(ambient)
{
}

/* Rows of fewer spheres stay in the cache, whatever their order is. */
static const size_t SORTED_FROM = 16384;

/* As they stand in space, as in the cells of the engine, and not as LAMMPS sorts its atoms, so that what is
 * near a sphere is near it in memory too */
void Scene::sort_lone_atoms()
{
  const size_t n = lone_atoms.size();
  if (n < SORTED_FROM) return;
  std::vector<double> places(3 * n);
  std::vector<int> order(n), unsorted(lone_atoms);
  for (size_t k = 0; k < n; k++) std::copy_n(atom->x[unsorted[k]], 3, &places[3 * k]);
  if (sd_cells_sort(places.data(), (int) n, order.data()) != SD_OK) throw std::bad_alloc();
  for (size_t k = 0; k < n; k++) lone_atoms[k] = unsorted[order[k]];
}

/* Who has which row, and who that is. */
void Scene::find_rows()
{
  lone_atoms.clear();
  row_of.clear();
  for (int i : own)
    if (!settings.whole || atom->molecule[i] == 0) lone_atoms.push_back(i);
  sort_lone_atoms();
  size_t n = lone_atoms.size();
  if (settings.whole) {
    std::vector<char> active(atom->nlocal + 1, 0);
    for (int i : own) active[i] = 1;
    const std::vector<double> in = whole.gather(1, [&](int i, double *out) { *out = active[i]; });
    for (int m = 0; m < whole.size(); m++) row_of.push_back(in[m] != 0.0 ? (int) n++ : -1);
  }
  tags.resize(n);
  molecules.resize(n);
  const std::vector<double> who = rows(2, [this](int i, double *out) {
    out[0] = ubuf((int64_t) atom->tag[i]).d;
    out[1] = ubuf(atom->molecule ? (int64_t) atom->molecule[i] : (int64_t) 0).d;
  });
  for (size_t k = 0; k < n; k++) {
    tags[k] = ubuf(who[2 * k]).i;
    molecules[k] = ubuf(who[2 * k + 1]).i;
  }
}

void Scene::stand(const std::vector<int> &who)
{
  double measured[3] = {!found.is(epochs.lists) || who != own ? 1.0 : 0.0, 0.0, -INFINITY};
  for (int i : who) {
    measured[1] = std::max(measured[1], atom->radius[i]);
    measured[2] = std::max(measured[2], -atom->radius[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, measured, 3, MPI_DOUBLE, MPI_MAX, world);
  own = who;
  most = measured[1];
  least = -measured[2];
  if (measured[0] != 0.0) {
    epochs.rows.advance();
    find_rows();
  }
  found.set(epochs.lists);
  const auto row = [&](int i, double *out) {
    copy<3>(atom->x[i], out);
    out[3] = atom->radius[i];
    out[4] = 1.0 / sqrt(ambient.viscosity(i));
  };
  columns(row, {{&x, 3}, {&a, 1}, {&w, 1}});
  for (size_t m = 0; m < row_of.size(); m++)
    if (row_of[m] >= 0) std::copy_n(&whole.x[3 * m], 3, &x[3 * (size_t) row_of[m]]);
}

const double *Scene::drift_of_images() const
{
  return ambient.jumps();
}

void Scene::drift(double *rows, int width, double sign) const
{
  const double *jumps = ambient.jumps();
  double signed_jumps[6];
  for (int d = 0; d < 6 && jumps; d++) signed_jumps[d] = sign * jumps[d];
  for (size_t m = 0; m < row_of.size() && jumps; m++)
    if (row_of[m] >= 0)
      sd_add_edges(signed_jumps, &whole.edges[3 * m], rows + width * (size_t) row_of[m]);
}

void Scene::bring(Halo &copies)
{
  copies.extend(Lattice::of(domain).h, x, {&a, &w});
}

double Scene::memory_usage() const
{
  return sizeof(int) * (double) row_of.capacity() +
      sizeof(double) * (double) (x.capacity() + a.capacity() + w.capacity()) +
      2.0 * sizeof(int64_t) * (double) tags.capacity() + whole.memory_usage();
}

}    // namespace StokesDyn
