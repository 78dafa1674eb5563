#include "clump_overlaps.h"

#include "ranks.h"
#include "sd_hash.h"
#include "sd_lattice.h"
#include "sd_vans_grains.h"

#include "atom.h"
#include "domain.h"

#include <algorithm>
#include <cstring>
#include <vector>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Tells one set of members of clumps from another, in any order and on any ranks: IDs, molecules, radii. */
uint64_t ClumpOverlaps::fingerprint(int bits) const
{
  uint64_t mine = 1, all = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & bits) || atom->molecule[i] == 0) continue;
    uint64_t radius;
    memcpy(&radius, &atom->radius[i], sizeof(radius));
    const uint64_t tag = sd_hash_mix((uint64_t) atom->tag[i] + SD_HASH_STEP);
    mine += sd_hash_mix(sd_hash_mix(tag ^ (uint64_t) atom->molecule[i]) ^ radius);
  }
  for (uint64_t part : from_all(world, std::vector<uint64_t>(1, mine))) all += part;
  return all;
}

bool ClumpOverlaps::are_new(int bits)
{
  const uint64_t now = fingerprint(bits), before = seen;
  seen = now;
  return now != before;
}

std::vector<std::vector<ClumpOverlaps::Member>> ClumpOverlaps::clumps(int bits, bool unwrapped) const
{
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    if (atom->molecule[i] == 0 || !(atom->mask[i] & bits) || !(atom->radius[i] > 0.0)) continue;
    double x[3] = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};
    if (unwrapped) domain->unmap(atom->x[i], atom->image[i], x);
    mine.push_back({atom->molecule[i], atom->tag[i], {x[0], x[1], x[2]}, atom->radius[i]});
  }
  auto all = from_all(world, mine);
  std::sort(all.begin(), all.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  std::vector<std::vector<Member>> clumps;
  for (const Member &m : all) {
    if (clumps.empty() || clumps.back().front().molecule != m.molecule) clumps.emplace_back();
    clumps.back().push_back(m);
  }
  return clumps;
}

tagint ClumpOverlaps::first(int bits) const
{
  constexpr double DEEP = 0.9;    // at 0.9 (a + b) two equal spheres share 0.7 % of their volume
  for (auto &clump : clumps(bits, true)) {
    std::vector<double> x, a;
    std::sort(clump.begin(), clump.end(), [](const Member &p, const Member &q) { return p.x[0] < q.x[0]; });
    for (const Member &m : clump) {
      x.insert(x.end(), m.x, m.x + 3);
      a.push_back(m.a);
    }
    if (sd_vans_any_nearer((int) clump.size(), x.data(), a.data(), DEEP)) return clump[0].molecule;
  }
  return 0;
}

/* Seen from each member the others stand at their nearest image: what overlaps it is near. */
std::map<tagint, double> ClumpOverlaps::lost(int bits) const
{
  std::map<tagint, double> lost;
  for (const auto &clump : clumps(bits, false)) {
    const size_t n = clump.size();
    std::vector<double> x(3 * n), a(n);
    for (size_t k = 0; k < n; k++) {
      for (size_t j = 0; j < n; j++) {
        for (int d = 0; d < 3; d++) x[3 * j + d] = clump[j].x[d] - clump[k].x[d];
        sd_closest_image(domain->h, domain->periodicity, &x[3 * j]);
        a[j] = clump[j].a;
      }
      const double share = sd_vans_union_share((int) n, x.data(), a.data(), (int) k);
      if (share < 0.0)
        voice.fail_one("keyword overlap: out of memory for a clump of " + std::to_string(n) + " members");
      lost[clump[k].tag] = 1.0 - share;
    }
  }
  return lost;
}

}    // namespace StokesDyn
