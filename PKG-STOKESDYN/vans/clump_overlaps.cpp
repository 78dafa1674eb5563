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

namespace {
struct Member {
  tagint molecule, tag;
  double x[3], a;
};
}    // namespace

/* Of the members [n] of a clump, by tag. Seen from each the others stand at their nearest image: what overlaps it
 * is near. */
static void add_lost(const Voice &voice, const Domain *domain, const Member *clump, size_t n,
                     std::map<tagint, double> &lost)
{
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

std::map<tagint, double> ClumpOverlaps::lost(int bits) const
{
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    if (atom->molecule[i] != 0 && (atom->mask[i] & bits) && atom->radius[i] > 0.0)
      mine.push_back({atom->molecule[i], atom->tag[i], {x[0], x[1], x[2]}, atom->radius[i]});
  }
  auto all = from_all(world, mine);
  std::sort(all.begin(), all.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  std::map<tagint, double> lost;
  for (size_t begin = 0, end; begin < all.size(); begin = end) {
    for (end = begin; end < all.size() && all[end].molecule == all[begin].molecule; end++) {}
    add_lost(voice, domain, &all[begin], end - begin, lost);
  }
  return lost;
}

}    // namespace StokesDyn
