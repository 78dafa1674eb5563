#include "scene.h"

#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace LAMMPS_NS;

namespace StokesDyn {

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

  /* The shortest of a separation's images. In a skew box that need not be LAMMPS's minimum image: an image no longer than d is at
   * most |d| |row k of the inverse of the box| cells away from it along edge k. */
  void closest_image(Domain *domain, double *d)
  {
    Compat::minimum_image(domain, d);
    if (!domain->triclinic) return;
    const double *h = domain->h, *inv = domain->h_inv;    // xx yy zz yz xz xy of an upper triangle
    const double at[3] = {inv[0] * d[0] + inv[5] * d[1] + inv[4] * d[2],
                          inv[1] * d[1] + inv[3] * d[2], inv[2] * d[2]};
    const double row[3] = {sqrt(inv[0] * inv[0] + inv[5] * inv[5] + inv[4] * inv[4]),
                           sqrt(inv[1] * inv[1] + inv[3] * inv[3]), fabs(inv[2])};
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    int lo[3], hi[3];
    for (int k = 0; k < 3; k++) {
      lo[k] = domain->periodicity[k] ? (int) floor(at[k] - length * row[k]) : 0;
      hi[k] = domain->periodicity[k] ? (int) ceil(at[k] + length * row[k]) : 0;
    }
    double best = length * length * (1.0 - 1e-12), shift[3] = {0.0, 0.0, 0.0};
    for (int i = lo[0]; i <= hi[0]; i++)
      for (int j = lo[1]; j <= hi[1]; j++)
        for (int k = lo[2]; k <= hi[2]; k++) {
          const double s[3] = {h[0] * i + h[5] * j + h[4] * k, h[1] * j + h[3] * k, h[2] * k};
          const double x = d[0] - s[0], y = d[1] - s[1], z = d[2] - s[2];
          if (x * x + y * y + z * z >= best) continue;
          best = x * x + y * y + z * z;
          std::copy(s, s + 3, shift);
        }
    for (int k = 0; k < 3; k++) d[k] -= shift[k];
  }
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
        closest_image(domain, d);
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

}    // namespace StokesDyn
