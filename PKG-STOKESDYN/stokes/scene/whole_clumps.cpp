#include "whole_clumps.h"

#include "copy.h"
#include "halo.h"
#include "keywords.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

using namespace LAMMPS_NS;

namespace StokesDyn {

WholeClumps::WholeClumps(const Voice &voice, Epochs &epochs) :
    Pointers(voice.lmp), voice(voice), epochs(epochs), post(world)
{
}

/* Of the atoms `bound`, which are in molecules: the rank that has the lowest tag of each. */
std::vector<int> WholeClumps::owners(const std::vector<int> &bound) const
{
  struct Part {
    int64_t molecule, lowest;
    int owner, unused;
  };
  std::unordered_map<int64_t, size_t> number;
  std::vector<Part> parts;
  for (int i : bound) {
    const auto known = number.insert({atom->molecule[i], parts.size()});
    if (known.second) parts.push_back({atom->molecule[i], atom->tag[i], comm->me, 0});
    Part &part = parts[known.first->second];
    part.lowest = std::min(part.lowest, (int64_t) atom->tag[i]);
  }
  const int ranks = comm->nprocs;
  const auto home = [ranks](const Part &p) {
    return (int) ((uint64_t) p.molecule % ranks);
  };
  if (ranks > 1) ask_homes(world, parts, home, [](std::vector<Part> &all) {
    std::unordered_map<int64_t, Part> first;
    for (const Part &p : all) {
      Part &best = first.insert({p.molecule, p}).first->second;
      if (p.lowest < best.lowest) best = p;
    }
    for (Part &p : all) p.owner = first[p.molecule].owner;
  });
  std::vector<int> of;
  for (int i : bound) of.push_back(parts[number[atom->molecule[i]]].owner);
  return of;
}

/* Which atoms go where, and how many come. */
void WholeClumps::route(const std::vector<int> &bound)
{
  const std::vector<int> owner = owners(bound);
  std::vector<int> to(comm->nprocs, 0), by_owner;
  atom_of.clear();
  for (size_t k = 0; k < bound.size(); k++) {
    if (owner[k] == comm->me)
      atom_of.push_back(bound[k]);
    else {
      to[owner[k]]++;
      by_owner.push_back((int) k);
    }
  }
  std::stable_sort(by_owner.begin(), by_owner.end(),
                   [&owner](int p, int q) { return owner[p] < owner[q]; });
  away.clear();
  for (int k : by_owner) away.push_back(bound[k]);
  post.address(to);
  for (int k = 0; k < post.rows_in(); k++) atom_of.push_back(~k);
}

/* The members, in order of molecule and tag */
void WholeClumps::arrange()
{
  struct Member {
    int64_t molecule, tag;
    int atom;
  };
  std::vector<Member> members;
  const std::vector<double> who = gather(2, [this](int i, double *out) {
    out[0] = ubuf((int64_t) atom->molecule[i]).d;
    out[1] = ubuf((int64_t) atom->tag[i]).d;
  });
  for (size_t m = 0; m < atom_of.size(); m++)
    members.push_back({(int64_t) ubuf(who[2 * m]).i, (int64_t) ubuf(who[2 * m + 1]).i, atom_of[m]});
  std::sort(members.begin(), members.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  clumps.clear();
  tag.clear();
  edges.assign(3 * members.size() + 3, 0);
  for (size_t k = 0; k < members.size(); k++) {
    const int at = (int) k;
    if (clumps.empty() || clumps.back().molecule != members[k].molecule)
      clumps.push_back({members[k].molecule, at, at});
    clumps.back().end = at + 1;
    tag.push_back(members[k].tag);
    atom_of[k] = members[k].atom;
  }
}

void WholeClumps::find()
{
  const bool again = !found.is(epochs.lists);
  if (again) {
    std::vector<int> bound;
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->molecule[i] != 0) bound.push_back(i);
    route(bound);
    arrange();
    epochs.members.advance();
    found.set(epochs.lists);
  }
  stand();
  if (again || domain->box_change) check_widths();
}

void WholeClumps::stand()
{
  const Lattice lattice = Lattice::of(domain);
  std::copy_n(lattice.h, 6, h);
  x.resize(3 * tag.size() + 3);
  gather_to(3, [this](int i, double *out) { copy<3>(atom->x[i], out); },
            [this](size_t m) { return &x[3 * m]; });
  for (const Clump &clump : clumps)
    for (int k = clump.begin + 1; k < clump.end; k++)
      sd_bring_close(lattice.h, lattice.periodic, &x[3 * (size_t) clump.begin], &x[3 * (size_t) k],
                     &edges[3 * (size_t) k]);
}

/* How far a clump reaches in x, y, z: beyond half of a periodic box the image next to the first
 * sphere need not be that next to the second. */
void WholeClumps::check_widths() const
{
  int64_t widest = std::numeric_limits<int64_t>::max();
  for (const Clump &clump : clumps)
    for (int d = 0; d < 3; d++) {
      double lo = INFINITY, hi = -INFINITY;
      for (int k = clump.begin; k < clump.end; k++) {
        lo = std::min(lo, x[3 * (size_t) k + d]);
        hi = std::max(hi, x[3 * (size_t) k + d]);
      }
      if (domain->periodicity[d] && hi - lo > 0.5 * domain->prd[d] * (1.0 + 1e-9))
        widest = std::min(widest, clump.molecule);
    }
  widest = smallest_of_all(world, widest);
  if (widest == std::numeric_limits<int64_t>::max()) return;
  voice.fail("the clump of molecule " + std::to_string(widest) + " is wider than half of the "
             "periodic box, so which image of a sphere it sees is ambiguous; use a larger box or a "
             "cut_off_distance below half of it");
}

double WholeClumps::memory_usage() const
{
  return sizeof(double) *
      ((double) x.capacity() + outbox.capacity() + inbox.capacity()) +
      sizeof(int) * ((double) away.capacity() + atom_of.capacity() + edges.capacity()) +
      sizeof(int64_t) * (double) tag.capacity();
}

}    // namespace StokesDyn
