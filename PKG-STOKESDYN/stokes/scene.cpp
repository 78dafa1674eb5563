#include "scene.h"

#include "callback.h"
#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Scene::Scene(LAMMPS *lmp, Pair *pair, const std::string &command) :
    Pointers(lmp), pair(pair), command(command), candidates(), pairs(), rows(), omega()
{
}

Scene::~Scene()
{
  sd_neighbors_free(&candidates);
  sd_neighbors_free(&pairs);
  sd_neighbors_free(&rows);
  sd_mobility_free(&omega);
}

const sd_mobility_engine &Scene::Settings::engine() const
{
  return std::isinf(cutoff) && !clumps_only ? sd_mobility_all_pairs
                                                              : sd_mobility_list;
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

void Scene::update(const std::vector<char> &active, const std::vector<double> &eta)
{
  const int nlocal = atom->nlocal;
  const bool cloud = view() == SD_VIEW_ALL;
  const int n = cloud ? nlocal : nlocal + atom->nghost;
  a.assign(n, 0.0);
  w.assign(n, 0.0);
  for (int i = 0; i < nlocal; i++)
    if (active[i]) {
      a[i] = atom->radius[i];
      w[i] = 1.0 / sqrt(eta[i]);
    }
  if (cloud) {
    gather();
    place(n_all);
    return;
  }

  packing = SPHERES;
  Compat::forward_comm(comm, pair);
  if (stale) find_pairs();

  const sd_spheres spheres = {positions(), a.data(), w.data()};
  filtered = std::isfinite(settings.cutoff) || std::find(a.begin(), a.end(), 0.0) != a.end();
  if (filtered) {
    if (sd_neighbors_reserve(&pairs, nlocal, candidates.first[nlocal]) != SD_OK) out_of_memory();
    sd_pairs_within(&candidates.pairs, &spheres, settings.cutoff, pairs.first, pairs.neighbor);
    pairs.pairs.n = nlocal;
  }
  place(n);
}

/* The spheres where they stand, and what their engine may ask. */
void Scene::place(int n_all_or_ghosts)
{
  const bool cloud = view() == SD_VIEW_ALL;
  sd_mobility_scene scene = {};
  scene.how = {law(), width()};
  scene.n = atom->nlocal;
  scene.n_all = n_all_or_ghosts;
  scene.spheres = cloud ? this->cloud() : local();
  scene.pairs = cloud ? nullptr : &list();
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
  if (sd_mobility_place(&omega, &settings.engine(), &scene) != SD_OK) out_of_memory();
}

/* Once per re-neighbouring. Between two of them an atom moves by half the skin at most, so the skin is added to the cut-off. */
void Scene::find_pairs()
{
  const int nlocal = atom->nlocal, n = nlocal + atom->nghost;
  const double reach = settings.cutoff + neighbor->skin;
  sd_status status;
  if (settings.clumps_only) {
    find_molecules();
    status = sd_neighbors_clump(&candidates, positions(), tag.data(), molecule.data(), nlocal, n,
                                reach, 0, order.data());
  } else
    status = sd_neighbors_cutoff(&candidates, positions(), nlocal, n, reach);
  if (status != SD_OK) out_of_memory();
  if (settings.clumps_only && std::isinf(settings.cutoff)) check_clumps(candidates, false);
  stale = false;
}

bool Scene::anybody_sees() const
{
  if (view() == SD_VIEW_ALL) return n_all > 1;
  int mine = list().first[atom->nlocal] > 0, any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

void Scene::refresh(std::vector<double> &v, int width)
{
  v.resize((size_t) width * (atom->nlocal + atom->nghost) + 1);
  values = v.data();
  values_width = width;
  packing = VALUES;
  Compat::forward_comm(comm, pair);
}

void Scene::refresh_ghosts(std::vector<double> &ghosts, int width,
                           const std::function<void(int, double *)> &row)
{
  ghosts.resize((size_t) width * atom->nghost + 1);
  send_rows(ghosts.data(), width, row);
}

void Scene::refresh_ghosts(const double *rows, double *ghosts, int width)
{
  send_rows(ghosts, width, [=](int i, double *out) {
    std::copy_n(rows + width * (size_t) i, width, out);
  });
}

void Scene::send_rows(double *ghosts, int width, const std::function<void(int, double *)> &row)
{
  values = ghosts;
  values_width = width;
  row_of = &row;
  packing = ROWS;
  Compat::forward_comm(comm, pair);
}

void Scene::gather()
{
  enum { COLUMNS = 7 };    // x y z, a, w, tag, molecule
  const int nlocal = atom->nlocal, nprocs = comm->nprocs;
  own.clear();
  std::vector<double> rows_of_mine;
  for (int i = 0; i < nlocal; i++)
    if (a[i] > 0.0) {
      own.push_back(i);
      rows_of_mine.insert(rows_of_mine.end(),
                          {atom->x[i][0], atom->x[i][1], atom->x[i][2], a[i], w[i],
                           ubuf(atom->tag[i]).d, ubuf(atom->molecule ? atom->molecule[i] : 0).d});
    }
  int n = own.size();
  std::vector<int> counts_rows(nprocs), displs_rows(nprocs);
  spheres_of_rank.resize(nprocs);
  MPI_Allgather(&n, 1, MPI_INT, spheres_of_rank.data(), 1, MPI_INT, world);
  n_all = 0;
  for (int p = 0; p < nprocs; p++) {
    counts_rows[p] = COLUMNS * spheres_of_rank[p];
    displs_rows[p] = COLUMNS * n_all;
    n_all += spheres_of_rank[p];
  }
  std::vector<double> all(COLUMNS * (size_t) n_all + 1);
  MPI_Allgatherv(rows_of_mine.data(), COLUMNS * n, MPI_DOUBLE, all.data(), counts_rows.data(),
                 displs_rows.data(), MPI_DOUBLE, world);

  std::vector<int> by_tag(n_all);
  for (int j = 0; j < n_all; j++) by_tag[j] = j;
  auto tag_of = [&all](int j) {
    return (int64_t) ubuf(all[COLUMNS * (size_t) j + 5]).i;
  };
  std::sort(by_tag.begin(), by_tag.end(), [&](int p, int q) {
    return tag_of(p) < tag_of(q);
  });

  cloud_is_new = (int) all_tag.size() != n_all;
  all_x.resize(3 * (size_t) n_all);
  all_a.resize(n_all);
  all_w.resize(n_all);
  all_tag.resize(n_all);
  all_molecule.resize(n_all);
  place_of.resize(n_all);
  for (int k = 0; k < n_all; k++) {
    const double *row = &all[COLUMNS * (size_t) by_tag[k]];
    place_of[by_tag[k]] = k;
    std::copy(row, row + 3, &all_x[3 * (size_t) k]);
    const int64_t its_tag = ubuf(row[5]).i, its_molecule = ubuf(row[6]).i;
    cloud_is_new = cloud_is_new || all_tag[k] != its_tag || all_a[k] != row[3] ||
        all_molecule[k] != its_molecule;
    all_a[k] = row[3];
    all_w[k] = row[4];
    all_tag[k] = its_tag;
    all_molecule[k] = its_molecule;
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
  const size_t m = width, n = own.size();
  mine.resize(m * n + 1);
  for (size_t k = 0; k < n; k++) std::copy_n(own_rows + m * own[k], m, &mine[m * k]);
  const double *from = mine.data();
  if (comm->nprocs > 1) {
    std::vector<int> counts, displs;
    shares(width, counts, displs);
    in_order_of_rank.resize(m * n_all + 1);
    MPI_Allgatherv(mine.data(), m * n, MPI_DOUBLE, in_order_of_rank.data(), counts.data(),
                   displs.data(), MPI_DOUBLE, world);
    from = in_order_of_rank.data();
  }
  for (int j = 0; j < n_all; j++) std::copy_n(from + m * j, m, cloud_rows + m * place_of[j]);
}

void Scene::from_cloud(const double *cloud_rows, double *own_rows, int width)
{
  const size_t m = width, n = own.size();
  mine.resize(m * n + 1);
  in_order_of_rank.resize(m * n_all + 1);
  for (int j = 0; j < n_all; j++)
    std::copy_n(cloud_rows + m * place_of[j], m, &in_order_of_rank[m * j]);
  const double *from = in_order_of_rank.data();
  if (comm->nprocs > 1) {
    std::vector<int> counts, displs;
    shares(width, counts, displs);
    MPI_Reduce_scatter(in_order_of_rank.data(), mine.data(), counts.data(), MPI_DOUBLE, MPI_SUM,
                       world);
    from = mine.data();
  }
  std::fill_n(own_rows, m * atom->nlocal, 0.0);
  for (size_t k = 0; k < n; k++) std::copy_n(from + m * k, m, own_rows + m * own[k]);
}

/* MPI requires that all ranks receive identical results of an allreduce (MPI 3.1, 5.9.6), as the core does of its sums. */
sd_status Scene::sum(void *ctx, double *values, int count)
{
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, static_cast<Scene *>(ctx)->world);
  return SD_OK;
}

int Scene::pack_forward_comm(int n, int *list, double *buf)
{
  int m = 0;
  for (int k = 0; k < n; k++) {
    const int i = list[k];
    switch (packing) {
      case SPHERES:
        buf[m++] = a[i];
        buf[m++] = w[i];
        break;
      case MOLECULES:
        buf[m++] = ubuf(molecule[i]).d;
        break;
      case VALUES:
        for (int d = 0; d < values_width; d++) buf[m++] = values[values_width * (size_t) i + d];
        break;
      case ROWS:    // ghosts pass on what they have from a neighbour
        if (i < atom->nlocal)
          (*row_of)(i, buf + m);
        else
          std::copy_n(values + values_width * (size_t) (i - atom->nlocal), values_width, buf + m);
        m += values_width;
        break;
    }
  }
  return m;
}

void Scene::unpack_forward_comm(int n, int first, double *buf)
{
  int m = 0;
  for (int i = first; i < first + n; i++) {
    switch (packing) {
      case SPHERES:
        a[i] = buf[m++];
        w[i] = buf[m++];
        break;
      case MOLECULES:
        molecule[i] = ubuf(buf[m++]).i;
        break;
      case VALUES:
        for (int d = 0; d < values_width; d++) values[values_width * (size_t) i + d] = buf[m++];
        break;
      case ROWS:
        std::copy_n(buf + m, values_width, values + values_width * (size_t) (i - atom->nlocal));
        m += values_width;
        break;
    }
  }
}

double Scene::memory_usage() const
{
  return sizeof(int) * ((double) candidates.capacity + pairs.capacity) +
      sizeof(double) *
      ((double) a.capacity() + w.capacity() + 5.0 * n_all);
}

}    // namespace StokesDyn
