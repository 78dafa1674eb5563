#include "scene.h"

#include "keywords.h"
#include "lammps_compat.h"
#include "ranks.h"

#include "sd_lattice.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "neighbor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

using namespace LAMMPS_NS;

namespace StokesDyn {

bool Scene::update_clumps()
{
  if (!clumps_stale) return false;
  const int nlocal = atom->nlocal, n = nlocal + atom->nghost;
  std::vector<double> sent;    // not every atom style sends molecule IDs to ghosts
  refresh_ghosts(sent, 1, [this](int i, double *out) { *out = ubuf(atom->molecule[i]).d; });
  tag.resize(n);
  molecule.resize(n);
  order.resize(n + 1);
  for (int i = 0; i < n; i++) {
    tag[i] = atom->tag[i];
    molecule[i] = i < nlocal ? (int64_t) atom->molecule[i] : ubuf(sent[i - nlocal]).i;
  }
  const sd_named known = {positions(), tag.data(), molecule.data()};
  if (sd_neighbors_clump(&rows, &known, nlocal, n, INFINITY, 1, order.data()) != SD_OK)
    out_of_memory();
  check_clumps({nlocal, positions(), molecule.data()}, rows, true);

  clumps.clear();
  member.clear();
  owned.clear();
  member_tag.clear();
  std::vector<int> spheres;
  for (int b = 0, e; b < n; b = e) {
    for (e = b + 1; e < n && molecule[order[e]] == molecule[order[b]]; e++) {}
    int first = b;    // by tag and index: the owned one of lowest tag comes before its ghosts
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

  std::array<double, 6> edges_of(const Domain *domain)
  {
    if (!domain->triclinic) return {domain->xprd, domain->yprd, domain->zprd, 0.0, 0.0, 0.0};
    const double *h = domain->h;
    return {h[0], h[1], h[2], h[3], h[4], h[5]};
  }
}    // namespace

/* Without a cut-off every sphere must see all of its clump: how many spheres has it, on all ranks
 * together? */
void Scene::check_clumps(const Checked &of, const sd_neighbors &list, bool one_row)
{
  struct Part {
    int64_t molecule, spheres;
  };
  const int64_t *const molecule = of.molecule;
  const int nprocs = comm->nprocs;
  std::unordered_map<int64_t, int64_t> total;
  for (int i = 0; i < of.n; i++)
    if (molecule[i] != 0) total[molecule[i]]++;
  if (nprocs > 1) {
    std::vector<Part> parts;
    for (const auto &entry : total) parts.push_back({entry.first, entry.second});
    ask_homes(
        world, parts, [nprocs](const Part &p) { return (int) ((uint64_t) p.molecule % nprocs); },
        [](std::vector<Part> &all) {
          std::unordered_map<int64_t, int64_t> sums;
          for (const Part &p : all) sums[p.molecule] += p.spheres;
          for (Part &p : all) p.spheres = sums[p.molecule];
        });
    for (const Part &p : parts) total[p.molecule] = p.spheres;
  }

  // A partner that is missing, or known only as an image more than half of a periodic box away.
  std::vector<int64_t> suspect;
  std::set<int64_t> with_row;    // the row of one sphere covers the others of its clump
  for (int i = 0; i < of.n; i++)
    if (list.first[i] < list.first[i + 1]) with_row.insert(molecule[i]);
  for (int i = 0; i < of.n; i++) {
    const long first = list.first[i], last = list.first[i + 1];
    if (molecule[i] == 0 || (one_row && first == last && with_row.count(molecule[i])))
      continue;
    const bool complete = last - first + 1 == total[molecule[i]];
    Span span;
    for (long k = first; k < last; k++) {
      const double *xj = of.x + 3 * (long) list.neighbor[k], *xi = of.x + 3 * (long) i;
      const double delta[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]};
      span.add(delta);
    }
    if (!complete || span.wide(domain)) suspect.push_back(molecule[i]);
  }
  suspect = from_all(world, suspect);
  if (!suspect.empty()) complain_about_clumps(of, std::set<int64_t>(suspect.begin(), suspect.end()));
}

/* Either the ghosts do not reach across a clump, or the clump is so wide that the closest image of
 * a sphere is ambiguous. */
void Scene::complain_about_clumps(const Checked &of, const std::set<int64_t> &suspect)
{
  // All spheres of those clumps to all ranks: the run ends here, so the price does not matter.
  struct Sphere {
    int64_t molecule;
    double x[3];
  };
  std::vector<Sphere> spheres;
  for (int i = 0; i < of.n; i++) {
    const double *xi = of.x + 3 * (long) i;
    if (suspect.count(of.molecule[i])) spheres.push_back({of.molecule[i], {xi[0], xi[1], xi[2]}});
  }
  std::map<int64_t, std::vector<Sphere>> members;
  for (const Sphere &s : from_all(world, spheres)) members[s.molecule].push_back(s);

  double widest = 0.0;
  int64_t which = *suspect.begin();
  for (const auto &clump : members)
    for (const Sphere &p : clump.second) {
      Span span;
      for (const Sphere &q : clump.second) {
        double d[3] = {q.x[0] - p.x[0], q.x[1] - p.x[1], q.x[2] - p.x[2]};
        sd_closest_image(edges_of(domain).data(), domain->periodicity, d);
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
