#include "scene.h"

#include "callback.h"
#include "copy.h"
#include "keywords.h"

#include "comm.h"
#include "neighbor.h"

#include "sd_cells.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Scene::Scene(const Voice &voice, Epochs &epochs, Settings &settings) :
    Pointers(voice.lmp), settings(settings), whole(voice, epochs), cloud(voice.lmp), voice(voice), epochs(epochs),
    halo(world), halo_of_points(world)
{
}

void Scene::out_of_memory()
{
  voice.fail_one("out of memory for the list of pairs");
}

// --- rows ----------------------------------------------------------------------------------------

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

void Scene::stand(const std::vector<int> &who, const Ambient &ambient)
{
  double measured[3] = {!rows_found.is(epochs.lists) || who != own ? 1.0 : 0.0, 0.0, -INFINITY};
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
  rows_found.set(epochs.lists);
  jumping = ambient.jumps();
  if (jumping) std::copy_n(ambient.jumps(), 6, jumps);
  const auto row = [&](int i, double *out) {
    copy<3>(atom->x[i], out);
    out[3] = atom->radius[i];
    out[4] = 1.0 / sqrt(ambient.viscosity(i));
  };
  columns(row, {{&x, 3}, {&a, 1}, {&w, 1}});
  for (size_t m = 0; m < row_of.size(); m++)
    if (row_of[m] >= 0) std::copy_n(&whole.x[3 * m], 3, &x[3 * (size_t) row_of[m]]);
}

void Scene::drift(double *rows, int width, double sign) const
{
  double signed_jumps[6];
  for (int d = 0; d < 6; d++) signed_jumps[d] = sign * jumps[d];
  for (size_t m = 0; m < row_of.size() && jumping; m++)
    if (row_of[m] >= 0)
      sd_add_edges(signed_jumps, &whole.edges[3 * m], rows + width * (size_t) row_of[m]);
}

void Scene::surround(bool found, const std::string &keyword)
{
  if (!found)
    voice.fail_one("keyword " + keyword + ", reaches more than 1000 images of each sphere and 1e7 "
                   "in all; is it in other units?");
  halo.extend(Lattice::of(domain).h, x, {&a, &w});
}

// --- who sees whom -------------------------------------------------------------------------------

void Scene::update(const std::vector<int> &who, const Ambient &ambient, std::vector<double> &idle)
{
  stand(who, ambient);
  turn_shells();
  if (settings.everybody()) {
    engine = engine_of_all();
    if (view() == SD_VIEW_NEAR) {
      look_for_others(ewald.count + second_level.count);
      if (!somebody_sees) return;
      surround(halo.find_or_keep(Lattice::of(domain), ewald.reach + 2.0 * extent(most), x,
                                 one_sided() ? Halo::ABOVE : Halo::OTHERS),
               "far_field: the largest radius, " + text(most));
      tell();
      place(size_with_copies(), idle);
    } else {
      cloud.gather(local(), tags, molecules, epochs.rows);
      look_for_others(cloud.size());
      place(cloud.size(), idle);
    }
    return;
  }
  engine = &sd_mobility_list;
  if (!pairs_found.is(epochs.rows))
    find_pairs();
  else if (!somebody_sees)
    return;    // nobody will ask where the spheres are
  else
    halo.extend(Lattice::of(domain).h, x, {&a, &w});
  if (has_cutoff()) {
    const sd_spheres spheres = local();
    if (sd_neighbors_reserve(&pairs, size(), candidates.first[size()]) != SD_OK) out_of_memory();
    sd_pairs_within(&candidates.pairs, &spheres, settings.cutoff, pairs.first, pairs.neighbor);
    pairs.pairs.n = size();
  }
  place(size_with_copies(), idle);
}

/* Of all ranks, where everybody sees everybody: of two there is another, and of one there is if it has
 * images, or other points. */
void Scene::look_for_others(double spheres)
{
  somebody_sees = spheres > (shells || settings.boundary.has_images() ? 0.0 : 1.0);
}

/* Until LAMMPS re-neighbours again, an atom stays within half the skin of where it was when it did
 * so last. A list made then holds with the cut-off and one skin; made later, both spheres of a pair
 * may still move a whole skin from where they are. */
void Scene::find_pairs()
{
  const double reach = settings.cutoff + (neighbor->ago == 0 ? 1.0 : 2.0) * neighbor->skin;
  const int n = size();
  if (settings.whole && settings.clumps_only)
    halo.clear();
  else
    surround(halo.find(Lattice::of(domain), reach, x), "cut_off_distance: '" + text(settings.cutoff) + "'");
  const int n_all = size_with_copies();
  sd_status status;
  if (settings.clumps_only) {
    std::vector<double> sent(n_all + 1);
    std::vector<int64_t> ids(tags), known_molecules(molecules);
    for (auto *names : {&ids, &known_molecules}) {
      for (int k = 0; k < n; k++) sent[k] = ubuf((*names)[k]).d;
      halo.refresh(sent.data(), sent.data() + n, 1);
      names->resize(n_all + 1);
      for (int k = n; k < n_all; k++) (*names)[k] = ubuf(sent[k]).i;
    }
    std::vector<int> scratch(n_all + 1);
    const sd_named known = {x.data(), ids.data(), known_molecules.data()};
    status = sd_neighbors_clump(&candidates, &known, n, n_all, reach, scratch.data());
  } else
    status = sd_neighbors_cutoff(&candidates, x.data(), n, n_all, reach);
  if (status != SD_OK) out_of_memory();
  const int sees = candidates.first[n] > 0 || (settings.boundary.has_images() && n > 0);
  somebody_sees = largest_of_all(world, sees);
  pairs_found.set(epochs.rows);
}

// Products of all pairs of fewer take a tenth of a millisecond, and keep all digits.
static const int FLOATS_FROM = 512;

/* The spheres where they stand, and what their engine may ask. */
void Scene::place(int n_all_or_copies, std::vector<double> &idle)
{
  const bool by_cloud = view() == SD_VIEW_ALL;
  sd_mobility_scene scene = {};
  scene.how = {law(), width(), &ewald, &second_level, &slab, harmless_error()};
  scene.n = size();
  scene.n_all = n_all_or_copies;
  scene.spheres = by_cloud ? cloud.spheres() : local();
  scene.pairs = view() == SD_VIEW_LIST ? &list() : nullptr;
  scene.one_sided = one_sided();
  scene.world = by_cloud ? ranks_of_cloud() : ranks();
  if (shells) place_points(n_all_or_copies, idle, scene);
  if (scene.n_all < FLOATS_FROM) scene.how.tolerance = 0.0;
  const sd_status status = sd_mobility_place(&omega, engine, &scene);
  if (status != SD_OK)
    fail_by(voice.of("set-up of the matrix-vector product by " + std::string(engine->name)), status);
}

/* How the shells of all stand, whose rows go where those of the spheres did; empty where no clump turns any */
std::vector<double> Scene::turned_shells(int n_all_or_copies)
{
  if (!settings.whole) return {};
  const size_t width = shells->sent_width(), own = width * size();
  std::vector<double> rows = shells->sent(size()), all(width * n_all_or_copies + 1);
  if (view() == SD_VIEW_ALL)
    cloud.to_all(rows.data(), all.data(), (int) width);
  else {
    std::copy_n(rows.begin(), own, all.begin());
    halo.refresh(rows.data(), &all[own], (int) width);
  }
  return all;
}

/* The same with the points of the spheres */
void Scene::place_points(int n_all_or_copies, std::vector<double> &idle, sd_mobility_scene &scene)
{
  shells->expand(n_all_or_copies, turned_shells(n_all_or_copies), view() == SD_VIEW_ALL ? cloud.spheres() : local(),
                 engine->reads_places_once ? &idle : nullptr);
  scene.n = shells->first_of_rows()[size()];
  scene.n_all = shells->first_of_all()[n_all_or_copies];
  scene.spheres = shells->all();
  scene.groups = shells->groups();
  if (view() == SD_VIEW_ALL) return;
  halo_of_points = halo.refined(shells->first_of_all());
  scene.world = halo_of_points.ranks();
}

/* They know each other's rows by the cloud. */
sd_world Scene::ranks_of_cloud()
{
  sd_world all = {};
  all.ctx = this;
  all.me = comm->me;
  all.ranks = comm->nprocs;
  all.spread = [](void *ctx, const double *rows, double *cloud_rows, int width) {
    Scene *scene = static_cast<Scene *>(ctx);
    return callback([=] { scene->cloud.to_all(rows, cloud_rows, width, scene->first_in_cloud()); });
  };
  all.collect = [](void *ctx, const double *cloud_rows, double *rows, int width) {
    Scene *scene = static_cast<Scene *>(ctx);
    return callback([=] { scene->cloud.to_own(cloud_rows, rows, width, scene->first_in_cloud()); });
  };
  return all;
}

double Scene::memory_usage() const
{
  return sizeof(int) * ((double) candidates.room + pairs.room + row_of.capacity()) +
      sizeof(double) * (double) (x.capacity() + a.capacity() + w.capacity()) +
      2.0 * sizeof(int64_t) * (double) tags.capacity() + cloud.memory_usage() + halo.memory_usage() +
      whole.memory_usage();
}

}    // namespace StokesDyn
