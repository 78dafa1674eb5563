#include "scene.h"

#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace LAMMPS_NS;

namespace StokesDyn {

Scene::Scene(LAMMPS *lmp, Pair *pair, const std::string &command) :
    Pointers(lmp), pair(pair), command(command), candidates(), pairs(), rows(), packed()
{
}

Scene::~Scene()
{
  sd_neighbors_free(&candidates);
  sd_neighbors_free(&pairs);
  sd_neighbors_free(&rows);
  sd_packed_free(&packed);
}

bool Scene::all_pairs() const
{
  return std::isinf(settings.cutoff) && !settings.clumps_only;
}

const double *Scene::positions() const
{
  static const double none[3] = {0.0, 0.0, 0.0};
  return atom->nlocal + atom->nghost > 0 ? atom->x[0] : none;
}

void Scene::out_of_memory()
{
  error->one(FLERR, std::string(command + ": out of memory for the list of pairs"));
  abort();    // error->one does not return
}

void Scene::update(const std::vector<char> &active, const std::vector<double> &eta)
{
  const int nlocal = atom->nlocal;
  const int n = all_pairs() ? nlocal : nlocal + atom->nghost;
  a.assign(n, 0.0);
  w.assign(n, 0.0);
  for (int i = 0; i < nlocal; i++)
    if (active[i]) {
      a[i] = atom->radius[i];
      w[i] = 1.0 / sqrt(eta[i]);
    }
  if (all_pairs()) {
    gather();
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
  const sd_law how = law();
  packed.rotation = settings.rotation;
  if (sd_packed_list(&packed, SD_ISA_BEST, &how, &spheres, n) != SD_OK) out_of_memory();
}

/* Tags and molecule IDs of owned and ghost atoms. */
void Scene::find_molecules()
{
  const int nlocal = atom->nlocal, n = nlocal + atom->nghost;
  tag.resize(n);
  molecule.resize(n);
  order.resize(n + 1);
  for (int i = 0; i < nlocal; i++) molecule[i] = atom->molecule[i];
  for (int i = 0; i < n; i++) tag[i] = atom->tag[i];
  packing = MOLECULES;    // not every atom style sends molecule IDs to ghosts
  Compat::forward_comm(comm, pair);
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

bool Scene::update_clumps()
{
  if (!clumps_stale) return false;
  const int nlocal = atom->nlocal, n = nlocal + atom->nghost;
  find_molecules();
  if (sd_neighbors_clump(&rows, positions(), tag.data(), molecule.data(), nlocal, n, INFINITY, 1,
                         order.data()) != SD_OK)
    out_of_memory();
  check_clumps(rows, true);

  clumps.clear();
  member.clear();
  owned.clear();
  member_tag.clear();
  std::vector<int> spheres;
  for (int b = 0, e; b < n; b = e) {
    for (e = b + 1; e < n && molecule[order[e]] == molecule[order[b]]; e++) {}
    int first =
        b;    // in order of tag and index: the owned one of lowest tag comes before its ghosts
    while (first < e && order[first] >= nlocal) first++;
    if (molecule[order[b]] == 0 || first == e) continue;

    const int i = order[first];
    spheres.assign(1, i);
    spheres.insert(spheres.end(), rows.neighbor + rows.first[i], rows.neighbor + rows.first[i + 1]);
    std::sort(spheres.begin(), spheres.end(), [this](int p, int q) {
      return tag[p] < tag[q];
    });
    const int begin = member.size();
    int k = b;    // walks through the block beside the spheres, which have the same order of tags
    for (int j : spheres) {
      while (tag[order[k]] != tag[j]) k++;
      member.push_back(j);
      member_tag.push_back(tag[j]);
      owned.push_back(order[k] < nlocal ? order[k] : -1);
    }
    clumps.push_back({molecule[i], begin, (int) member.size()});
  }
  clumps_stale = false;
  return true;
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
  values = ghosts.data();
  values_width = width;
  row_of = &row;
  packing = ROWS;
  Compat::forward_comm(comm, pair);
}

namespace {
  /* How far a clump reaches in x, y, z, seen from one of its spheres. */
  struct Span {
    double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {0.0, 0.0, 0.0};
    void add(const double *delta)
    {
      for (int d = 0; d < 3; d++) {
        lo[d] = fmin(lo[d], delta[d]);
        hi[d] = fmax(hi[d], delta[d]);
      }
    }
    bool wide(const Domain *domain) const
    {
      for (int d = 0; d < 3; d++)
        if (domain->periodicity[d] && hi[d] - lo[d] > 0.5 * domain->prd[d] * (1.0 + 1e-9))
          return true;
      return false;
    }
  };
}    // namespace

/* Without a cut-off every sphere must see all of its clump. Each rank counts its own members of a molecule, the rank
 * (molecule modulo ranks) adds them up, and every rank asks back. */
void Scene::check_clumps(const sd_neighbors &list, bool one_row)
{
  const int nlocal = atom->nlocal, nprocs = comm->nprocs;
  std::map<int64_t, int64_t> total;
  for (int i = 0; i < nlocal; i++)
    if (molecule[i] != 0) total[molecule[i]]++;

  if (nprocs > 1) {
    std::vector<std::vector<int64_t>> outbox(nprocs);
    for (const auto &entry : total) {
      auto &box = outbox[std::abs(entry.first) % nprocs];
      box.push_back(entry.first);
      box.push_back(entry.second);
    }
    std::vector<int> sent(nprocs), received(nprocs), sent_at(nprocs), received_at(nprocs);
    std::vector<int64_t> out, in;
    for (int p = 0; p < nprocs; p++) {
      sent[p] = outbox[p].size();
      sent_at[p] = out.size();
      out.insert(out.end(), outbox[p].begin(), outbox[p].end());
    }
    MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, world);
    int n_in = 0;
    for (int p = 0; p < nprocs; p++) {
      received_at[p] = n_in;
      n_in += received[p];
    }
    in.resize(n_in);
    MPI_Alltoallv(out.data(), sent.data(), sent_at.data(), MPI_LMP_BIGINT, in.data(),
                  received.data(), received_at.data(), MPI_LMP_BIGINT, world);
    std::map<int64_t, int64_t> sums;
    for (int k = 0; k < n_in; k += 2) sums[in[k]] += in[k + 1];
    for (int k = 0; k < n_in; k += 2) in[k + 1] = sums[in[k]];
    MPI_Alltoallv(in.data(), received.data(), received_at.data(), MPI_LMP_BIGINT, out.data(),
                  sent.data(), sent_at.data(), MPI_LMP_BIGINT, world);
    for (size_t k = 0; k < out.size(); k += 2) total[out[k]] = out[k + 1];
  }

  // A partner that is missing, or known only as an image more than half of a periodic box away.
  std::vector<int64_t> suspect;
  std::set<int64_t> with_row;    // the row of one sphere covers the others of its clump
  for (int i = 0; i < nlocal; i++)
    if (list.first[i] < list.first[i + 1]) with_row.insert(molecule[i]);
  for (int i = 0; i < nlocal; i++) {
    const long first = list.first[i], last = list.first[i + 1];
    if (molecule[i] == 0 || (one_row ? first == last && with_row.count(molecule[i]) : a[i] == 0.0))
      continue;
    const bool complete = last - first + 1 == total[molecule[i]];
    Span span;
    for (long k = first; k < last; k++) {
      const double *xj = atom->x[list.neighbor[k]], *xi = atom->x[i];
      const double delta[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]};
      span.add(delta);
    }
    if (!complete || span.wide(domain)) suspect.push_back(molecule[i]);
  }
  int mine = suspect.size(), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (any) complain_about_clumps(suspect);
}

/* Either the ghosts do not reach across a clump, or the clump is so wide that the closest image of a sphere is ambiguous. */
void Scene::complain_about_clumps(const std::vector<int64_t> &suspect)
{
  // All spheres of those clumps to all ranks: the run ends here, so the price does not matter.
  auto everywhere = [this](std::vector<double> &v) {
    int mine = v.size(), n = 0;
    std::vector<int> counts(comm->nprocs), at(comm->nprocs);
    MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
    for (int p = 0; p < comm->nprocs; p++) {
      at[p] = n;
      n += counts[p];
    }
    std::vector<double> all(n);
    MPI_Allgatherv(v.data(), mine, MPI_DOUBLE, all.data(), counts.data(), at.data(), MPI_DOUBLE,
                   world);
    v.swap(all);
  };
  std::vector<double> ids(suspect.begin(), suspect.end()), spheres;
  everywhere(ids);
  std::sort(ids.begin(), ids.end());
  for (int i = 0; i < atom->nlocal; i++)
    if (std::binary_search(ids.begin(), ids.end(), (double) molecule[i]))
      spheres.insert(spheres.end(),
                     {(double) molecule[i], atom->x[i][0], atom->x[i][1], atom->x[i][2]});
  everywhere(spheres);

  std::map<int64_t, std::vector<const double *>> clumps;
  for (size_t k = 0; k < spheres.size(); k += 4)
    clumps[(int64_t) spheres[k]].push_back(&spheres[k + 1]);
  double widest = 0.0;
  int64_t which = 0;
  for (const auto &clump : clumps)
    for (const double *p : clump.second) {
      Span span;
      for (const double *q : clump.second) {
        double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        Compat::minimum_image(domain, d);
        span.add(d);
        const double r = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        if (r > widest) {
          widest = r;
          which = clump.first;
        }
      }
      if (span.wide(domain))
        fail(lmp,
             command + ": the clump of molecule " + std::to_string(clump.first) +
                 " is wider than half of the periodic box, so which image of a sphere it sees is "
                 "ambiguous;"
                 " use a larger box or a cut_off_distance below half of it");
    }
  // Rounded up to three digits, so that the number can be typed.
  const double wanted = widest + neighbor->skin;
  const double unit = pow(10.0, floor(log10(wanted)) - 2.0);
  fail(lmp,
       command + ": the ghost cut-off " + text(comm->get_comm_cutoff()) +
           " does not reach across the clump of molecule " + std::to_string(which) + ", " +
           text(widest) + " from centre to centre; use: comm_modify cutoff " +
           text(ceil(wanted / unit) * unit));
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
  counts.resize(nprocs);
  displs.resize(nprocs);
  n_all = 0;
  for (int p = 0; p < nprocs; p++) {
    if (p == comm->me) begin = n_all;
    counts[p] = width() * spheres_of_rank[p];
    displs[p] = width() * n_all;
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
  place.resize(n_all);
  for (int k = 0; k < n_all; k++) {
    const double *row = &all[COLUMNS * (size_t) by_tag[k]];
    place[by_tag[k]] = k;
    std::copy(row, row + 3, &all_x[3 * (size_t) k]);
    const int64_t its_tag = ubuf(row[5]).i, its_molecule = ubuf(row[6]).i;
    cloud_is_new = cloud_is_new || all_tag[k] != its_tag || all_a[k] != row[3] ||
        all_molecule[k] != its_molecule;
    all_a[k] = row[3];
    all_w[k] = row[4];
    all_tag[k] = its_tag;
    all_molecule[k] = its_molecule;
  }
  const sd_spheres spheres = cloud();
  const sd_law how = law();
  packed.rotation = settings.rotation;
  if (sd_packed_all(&packed, SD_ISA_BEST, &how, &spheres, n_all) != SD_OK) out_of_memory();
}

void Scene::to_cloud(const double *own_rows, std::vector<double> &cloud_rows)
{
  const size_t m = width();
  const int n = own.size();
  mine.resize(m * n + 1);
  in_order_of_rank.resize(m * n_all + 1);
  cloud_rows.resize(m * n_all + 1);
  for (int k = 0; k < n; k++)
    std::copy(own_rows + m * own[k], own_rows + m * own[k] + m, &mine[m * k]);
  const double *from = mine.data();
  if (comm->nprocs > 1) {
    MPI_Allgatherv(mine.data(), m * n, MPI_DOUBLE, in_order_of_rank.data(), counts.data(),
                   displs.data(), MPI_DOUBLE, world);
    from = in_order_of_rank.data();
  }
  for (int j = 0; j < n_all; j++)
    std::copy(from + m * j, from + m * j + m, &cloud_rows[m * place[j]]);
}

void Scene::from_cloud(const std::vector<double> &cloud_rows, double *own_rows)
{
  const size_t m = width();
  const int n = own.size();
  mine.resize(m * n + 1);
  in_order_of_rank.resize(m * n_all + 1);
  for (int j = 0; j < n_all; j++)
    std::copy(&cloud_rows[m * place[j]], &cloud_rows[m * place[j]] + m, &in_order_of_rank[m * j]);
  if (comm->nprocs > 1)
    MPI_Reduce_scatter(in_order_of_rank.data(), mine.data(), counts.data(), MPI_DOUBLE, MPI_SUM,
                       world);
  else
    mine = in_order_of_rank;
  std::fill(own_rows, own_rows + m * atom->nlocal, 0.0);
  for (int k = 0; k < n; k++) std::copy(&mine[m * k], &mine[m * k] + m, own_rows + m * own[k]);
}

void Scene::apply(void *ctx, const double *F, double *u)
{
  Scene *scene = static_cast<Scene *>(ctx);
  if (scene->all_pairs())
    scene->apply_all(F, u);
  else
    scene->apply_list(F, u);
}

void Scene::apply_list(const double *F, double *u)
{
  const size_t m = width();
  force.resize(m * a.size() + m);
  std::copy(F, F + m * atom->nlocal, force.begin());
  packing = FORCES;
  Compat::forward_comm(comm, pair);
  const sd_pairs *list = filtered ? &pairs.pairs : &candidates.pairs;
  sd_packed_pairs(&packed, list, force.data(), u);
}

/* Every rank computes an equal share of the pairs, wherever the spheres are. */
void Scene::apply_all(const double *F, double *u)
{
  to_cloud(F, all_force);
  all_u.assign(width() * (size_t) n_all + 1, 0.0);
  sd_packed_share(&packed, comm->me, comm->nprocs, all_force.data(), all_u.data());
  from_cloud(all_u, u);
}

void Scene::sum(void *ctx, double *values, int count)
{
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, static_cast<Scene *>(ctx)->world);
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
      case FORCES:
        for (int d = 0; d < width(); d++) buf[m++] = force[width() * (size_t) i + d];
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
      case FORCES:
        for (int d = 0; d < width(); d++) force[width() * (size_t) i + d] = buf[m++];
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
      ((double) a.capacity() + w.capacity() + force.capacity() + all_x.capacity() +
       all_force.capacity());
}

}    // namespace StokesDyn
