/* What members of clumps lose to each other: the share of a grain's volume that other members of its molecule
 * have too (core: sd_vans_union_share). Clumps are rigid, so once for every set of members will do. */
#ifndef SD_CLUMP_OVERLAPS_H
#define SD_CLUMP_OVERLAPS_H

#include "keywords.h"

#include "pointers.h"

#include <cstdint>
#include <map>
#include <vector>

namespace StokesDyn {

class ClumpOverlaps : protected LAMMPS_NS::Pointers {
 public:
  explicit ClumpOverlaps(const Voice &voice) : Pointers(voice.lmp), voice(voice) {}

  /* Members are atoms of these groups that have a molecule. Are there others than at the last call? On all
   * ranks together, as the next one */
  bool are_new(int bits);
  /* By tag of all members of all ranks, from 0 to 1 */
  std::map<LAMMPS_NS::tagint, double> lost(int bits) const;
  /* The lowest molecule with members that share more than what touches in a contact, 0: none has. On all
   * ranks together; a clump whose atoms lie on two sides of a periodic box without image flags is missed. */
  LAMMPS_NS::tagint first(int bits) const;

 private:
  const Voice &voice;
  /* of the members of the last call; 0: there was none */
  uint64_t seen = 0;
  uint64_t fingerprint(int bits) const;
  struct Member {
    LAMMPS_NS::tagint molecule, tag;
    double x[3], a;
  };
  /* Of all ranks, by molecules; the places of their members are in the box, or unwrapped */
  std::vector<std::vector<Member>> clumps(int bits, bool unwrapped) const;
};

}    // namespace StokesDyn
#endif
