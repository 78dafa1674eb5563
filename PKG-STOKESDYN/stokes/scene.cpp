#include "scene.h"

#include "callback.h"
#include "keywords.h"
#include "lammps_compat.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Scene::Scene(LAMMPS *lmp, Pair *pair, const std::string &command) :
    Pointers(lmp), pair(pair), command(command), candidates(), pairs(), rows(), images(lmp->world),
    omega()
{
}

Scene::~Scene()
{
  sd_neighbors_free(&candidates);
  sd_neighbors_free(&pairs);
  sd_neighbors_free(&rows);
  sd_mobility_free(&omega);
}

void Scene::init()
{
  lists_are_stale();
  told = false;
}

const double *Scene::positions() const
{
  static const double none[3] = {0.0, 0.0, 0.0};
  return atom->nlocal + atom->nghost > 0 ? atom->x[0] : none;
}

void Scene::out_of_memory()
{
  fail_one(lmp, command + ": out of memory for the list of pairs");
}

void Scene::update(const std::vector<int> &who, const std::vector<double> &eta)
{
  int changed = stale || who != own;
  own = who;
  if (settings.everybody()) {
    place_rows(eta);
    engine = split() ? &sd_mobility_ewald : &sd_mobility_all_pairs;
    if (view() == SD_VIEW_NEAR) {
      somebody_sees = ewald.count > (ewald.box.periodic ? 0.0 : 1.0);
      if (!somebody_sees) return;
      tell();
      images.find(ewald.box, ewald.reach, x, a, w);
      place(size_with_ghosts());
    } else {
      gather(eta);
      somebody_sees = n_all > 1;
      place(n_all);
    }
    return;
  }
  engine = &sd_mobility_list;
  MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, world);
  if (!changed && !somebody_sees) return;    // nobody will ask where the spheres are
  if (changed) {
    row_of.assign(atom->nlocal, -1);
    for (size_t k = 0; k < own.size(); k++) row_of[own[k]] = k;
  }
  place_rows(eta);
  place_ghosts();
  if (changed) find_pairs();

  filtered = std::isfinite(settings.cutoff);
  if (filtered) {
    const sd_spheres spheres = local();
    if (sd_neighbors_reserve(&pairs, size(), candidates.first[size()]) != SD_OK) out_of_memory();
    sd_pairs_within(&candidates.pairs, &spheres, settings.cutoff, pairs.first, pairs.neighbor);
    pairs.pairs.n = size();
  }
  place(size_with_ghosts());
}

/* Our own spheres. */
void Scene::place_rows(const std::vector<double> &eta)
{
  x.resize(3 * own.size());
  a.resize(own.size());
  w.resize(own.size());
  for (size_t k = 0; k < own.size(); k++) {
    std::copy_n(atom->x[own[k]], 3, &x[3 * k]);
    a[k] = atom->radius[own[k]];
    w[k] = 1.0 / sqrt(eta[k]);
  }
}

/* Ghosts of spheres that take part, behind them. */
void Scene::place_ghosts()
{
  std::vector<double> sent;    // radius, 0: takes no part; and w
  refresh_ghosts(sent, 2, [this](int i, double *out) {
    const int k = row_of[i];
    out[0] = k < 0 ? 0.0 : a[k];
    out[1] = k < 0 ? 0.0 : w[k];
  });
  row_of_ghost.assign(atom->nghost, -1);
  for (int g = 0; g < atom->nghost; g++) {
    if (!(sent[2 * g] > 0.0)) continue;
    row_of_ghost[g] = size_with_ghosts();
    const double *xg = atom->x[atom->nlocal + g];
    x.insert(x.end(), xg, xg + 3);
    a.push_back(sent[2 * g]);
    w.push_back(sent[2 * g + 1]);
  }
}

/* The spheres where they stand, and what their engine may ask. */
void Scene::place(int n_all_or_ghosts)
{
  const bool cloud = view() == SD_VIEW_ALL;
  sd_mobility_scene scene = {};
  scene.how = {law(), width(), view() == SD_VIEW_NEAR ? &ewald : nullptr};
  scene.n = size();
  scene.n_all = n_all_or_ghosts;
  scene.spheres = cloud ? this->cloud() : local();
  scene.pairs = view() == SD_VIEW_LIST ? &list() : nullptr;
  scene.world.ctx = this;
  scene.world.me = comm->me;
  scene.world.ranks = comm->nprocs;
  scene.world.sum = sum;
  scene.world.refresh = [](void *ctx, const double *rows, double *ghosts, int width) {
    return callback([=] {
      static_cast<Scene *>(ctx)->refresh_ghosts(rows, ghosts, width);
      return SD_OK;
    });
  };
  scene.world.spread = [](void *ctx, const double *rows, double *all, int width) {
    return callback([=] {
      static_cast<Scene *>(ctx)->to_cloud(rows, all, width);
      return SD_OK;
    });
  };
  scene.world.collect = [](void *ctx, const double *all, double *rows, int width) {
    return callback([=] {
      static_cast<Scene *>(ctx)->from_cloud(all, rows, width);
      return SD_OK;
    });
  };
  scene.world.exchange = [](void *ctx, const double *send, const int *to, double *receive,
                            const int *from) {
    return callback([=] {
      exchange_numbers(static_cast<Scene *>(ctx)->world, send, to, receive, from);
      return SD_OK;
    });
  };
  const sd_status status = sd_mobility_place(&omega, engine, &scene);
  if (status != SD_OK)
    fail_by(lmp, status,
            command + ": the spheres of a product by " + engine->name + ": " +
                sd_status_string(status));
}

/* Until LAMMPS re-neighbours again, an atom stays within half the skin of where it was when it did
 * so last. A list made then holds with the cut-off and one skin; made later, both spheres of a pair
 * may still move a whole skin from where they are. */
void Scene::find_pairs()
{
  const double reach = settings.cutoff + (neighbor->ago == 0 ? 1.0 : 2.0) * neighbor->skin;
  const int n = size(), n_and_ghosts = size_with_ghosts();
  std::vector<int64_t> ids, molecules;
  sd_status status;
  if (settings.clumps_only) {
    std::vector<int> scratch(n_and_ghosts + 1);
    look_up(ids, molecules);
    const sd_named known = {x.data(), ids.data(), molecules.data()};
    status = sd_neighbors_clump(&candidates, &known, n, n_and_ghosts, reach, 0, scratch.data());
  } else
    status = sd_neighbors_cutoff(&candidates, x.data(), n, n_and_ghosts, reach);
  if (status != SD_OK) out_of_memory();
  if (settings.clumps_only && std::isinf(settings.cutoff))
    check_clumps({n, x.data(), molecules.data()}, candidates, false);
  int sees = candidates.first[n] > 0, any;
  MPI_Allreduce(&sees, &any, 1, MPI_INT, MPI_MAX, world);
  somebody_sees = any;
  stale = false;
}

/* Tags and molecule IDs of the spheres, by row. Not every atom style sends molecule IDs to
 * ghosts. */
void Scene::look_up(std::vector<int64_t> &ids, std::vector<int64_t> &molecules)
{
  std::vector<double> sent;
  refresh_ghosts(sent, 1, [this](int i, double *out) { *out = ubuf(atom->molecule[i]).d; });
  ids.resize(size_with_ghosts() + 1);
  molecules.resize(size_with_ghosts() + 1);
  for (int k = 0; k < size(); k++) {
    ids[k] = atom->tag[own[k]];
    molecules[k] = atom->molecule[own[k]];
  }
  for (int g = 0; g < atom->nghost; g++)
    if (const int k = row_of_ghost[g]; k >= 0) {
      ids[k] = atom->tag[atom->nlocal + g];
      molecules[k] = ubuf(sent[g]).i;
    }
}

void Scene::refresh_ghosts(std::vector<double> &ghosts, int width,
                           const std::function<void(int, double *)> &row)
{
  ghosts.resize((size_t) width * atom->nghost + 1);
  send_rows(ghosts.data(), width, row);
}

void Scene::refresh_ghosts(const double *sphere_rows, double *ghosts, int width)
{
  if (view() == SD_VIEW_NEAR) {
    images.refresh(sphere_rows, ghosts, width);
    return;
  }
  const auto row = [=](int i, double *out) {
    if (row_of[i] >= 0) std::copy_n(sphere_rows + width * (size_t) row_of[i], width, out);
  };
  if (size_with_ghosts() - size() == atom->nghost) {    // all of them take part, in this order
    send_rows(ghosts, width, row);
    return;
  }
  std::vector<double> sent;
  refresh_ghosts(sent, width, row);
  for (int g = 0; g < atom->nghost; g++)
    if (row_of_ghost[g] >= 0)
      std::copy_n(&sent[width * (size_t) g], width,
                  ghosts + width * (size_t) (row_of_ghost[g] - size()));
}

void Scene::send_rows(double *ghosts, int width, const std::function<void(int, double *)> &row)
{
  ghost_rows = ghosts;
  row_width = width;
  row_writer = &row;
  Compat::forward_comm(comm, pair);
}

/* The cloud: the spheres of all ranks, sorted by tag. */
void Scene::gather(const std::vector<double> &eta)
{
  struct Sphere {
    double x[3], a, w;
    int64_t tag, molecule;
  };
  std::vector<Sphere> ours;
  for (size_t k = 0; k < own.size(); k++) {
    const int i = own[k];
    const double *xi = atom->x[i];
    ours.push_back({{xi[0], xi[1], xi[2]}, atom->radius[i], 1.0 / sqrt(eta[k]), atom->tag[i],
                    atom->molecule ? atom->molecule[i] : 0});
  }
  spheres_of_rank = from_all(world, std::vector<int>(1, size()));
  const std::vector<Sphere> all = from_all(world, ours);
  n_all = all.size();
  std::vector<int> by_tag(n_all);
  for (int j = 0; j < n_all; j++) by_tag[j] = j;
  std::sort(by_tag.begin(), by_tag.end(), [&all](int p, int q) {
    return all[p].tag < all[q].tag;
  });

  all_x.resize(3 * (size_t) n_all);
  for (auto *v : {&all_a, &all_w}) v->resize(n_all);
  all_molecule.resize(n_all);
  place_of.resize(n_all);
  for (int k = 0; k < n_all; k++) {
    const Sphere &s = all[by_tag[k]];
    place_of[by_tag[k]] = k;
    std::copy_n(s.x, 3, &all_x[3 * (size_t) k]);
    all_a[k] = s.a;
    all_w[k] = s.w;
    all_molecule[k] = s.molecule;
  }
}

/* Numbers that each rank has, and where they begin when they stand one rank after the other */
void Scene::shares(int width, std::vector<int> &counts, std::vector<int> &displs) const
{
  int n = 0;
  for (int k : spheres_of_rank) {
    counts.push_back(width * k);
    displs.push_back(width * n);
    n += k;
  }
}

void Scene::to_cloud(const double *own_rows, double *cloud_rows, int width)
{
  const size_t m = width;
  const double *from = own_rows;
  if (comm->nprocs > 1) {
    std::vector<int> counts, displs;
    shares(width, counts, displs);
    in_order_of_rank.resize(m * n_all + 1);
    MPI_Allgatherv(const_cast<double *>(own_rows), m * own.size(), MPI_DOUBLE,
                   in_order_of_rank.data(), counts.data(), displs.data(), MPI_DOUBLE, world);
    from = in_order_of_rank.data();
  }
  for (int j = 0; j < n_all; j++) std::copy_n(from + m * j, m, cloud_rows + m * place_of[j]);
}

void Scene::from_cloud(const double *cloud_rows, double *own_rows, int width)
{
  const size_t m = width;
  in_order_of_rank.resize(m * n_all + 1);
  double *to = comm->nprocs > 1 ? in_order_of_rank.data() : own_rows;
  for (int j = 0; j < n_all; j++) std::copy_n(cloud_rows + m * place_of[j], m, to + m * j);
  if (comm->nprocs == 1) return;
  std::vector<int> counts, displs;
  shares(width, counts, displs);
  MPI_Reduce_scatter(in_order_of_rank.data(), own_rows, counts.data(), MPI_DOUBLE, MPI_SUM, world);
}

sd_status Scene::sum(void *ctx, double *values, int count)
{
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, static_cast<Scene *>(ctx)->world);
  return SD_OK;
}

int Scene::pack_forward_comm(int n, int *list, double *buf)
{
  for (int k = 0; k < n; k++, buf += row_width) {
    const int i = list[k];
    if (i < atom->nlocal)
      (*row_writer)(i, buf);
    else    // ghosts pass on what they have from a neighbour
      std::copy_n(ghost_rows + row_width * (size_t) (i - atom->nlocal), row_width, buf);
  }
  return n * row_width;
}

void Scene::unpack_forward_comm(int n, int first, double *buf)
{
  std::copy_n(buf, (size_t) n * row_width, ghost_rows + row_width * (size_t) (first - atom->nlocal));
}

double Scene::memory_usage() const
{
  return sizeof(int) *
      ((double) candidates.capacity + pairs.capacity + row_of.capacity() + row_of_ghost.capacity()) +
      sizeof(double) * (x.capacity() + a.capacity() + w.capacity() + 5.0 * n_all) +
      images.memory_usage();
}

}    // namespace StokesDyn
