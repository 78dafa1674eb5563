/* Every difference between LAMMPS versions, 29Sep2021 to today, in one place. SD_HAVE_* come from
 * cmake/LammpsFeatures.cmake, which reads them off the headers. */
#ifndef SD_LAMMPS_COMPAT_H
#define SD_LAMMPS_COMPAT_H

#include "bond_hybrid.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "fix_deform.h"
#include "force.h"
#include "modify.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "output.h"
#include "pair_hybrid.h"
#include "region.h"

#include <string>
#include <utility>
#include <vector>

namespace StokesDyn {
namespace Compat {

  inline void forward_comm(LAMMPS_NS::Comm *comm, LAMMPS_NS::Pair *pair)
  {
#if SD_HAVE_COMM_THIS
    comm->forward_comm(pair);
#else
    comm->forward_comm_pair(pair);
#endif
  }

  inline void reverse_comm(LAMMPS_NS::Comm *comm, LAMMPS_NS::Pair *pair)
  {
#if SD_HAVE_COMM_THIS
    comm->reverse_comm(pair);
#else
    comm->reverse_comm_pair(pair);
#endif
  }

  /* the usual half list, each pair once, as newton says, or as if newton were off; instance: the
   * instance_me of the pair style */
  inline void request_half_list(LAMMPS_NS::Neighbor *neighbor, LAMMPS_NS::Pair *pair, int instance,
                                bool newton_off)
  {
#if SD_HAVE_ADD_REQUEST
    neighbor->add_request(pair,
                          newton_off ? LAMMPS_NS::NeighConst::REQ_NEWTON_OFF
                                     : LAMMPS_NS::NeighConst::REQ_DEFAULT);
#else
    const int request = neighbor->request(pair, instance);
    if (newton_off) neighbor->requests[request]->newton = 2;
#endif
  }

  /* output by time wants to know of another time step, where LAMMPS has such */
  inline void reset_dt(LAMMPS_NS::Output *output)
  {
#if SD_HAVE_OUTPUT_RESET_DT
    output->reset_dt();
#else
    (void) output;
#endif
  }

  /* nullptr if there is none */
  inline LAMMPS_NS::Region *region(LAMMPS_NS::Domain *domain, const std::string &id)
  {
#if SD_HAVE_REGION_PTR
    return domain->get_region_by_id(id);
#else
    const int i = domain->find_region(id.c_str());
    return i < 0 ? nullptr : domain->regions[i];
#endif
  }

  /* nullptr if there is none */
  inline LAMMPS_NS::Fix *fix(LAMMPS_NS::Modify *modify, const std::string &id)
  {
    const int i = modify->find_fix(id);
    return i < 0 ? nullptr : modify->fix[i];
  }

  /* Its settings of x y z yz xz xy, by index 0 ... 5: fields as in fix_deform.h, styles as below. It
   * tells its derived classes only. */
  enum DeformStyle { NONE, FINAL, DELTA, SCALE, VEL, ERATE, TRATE, VOLUME, WIGGLE, VARIABLE };
  class DeformSettings : private LAMMPS_NS::FixDeform {
   public:
    static auto of(LAMMPS_NS::FixDeform *deform) { return deform->*&DeformSettings::set; }
  };

  /* Names and styles: a hybrid (hybrid/overlay, hybrid/scaled), and behind it those below it */
  using PairStyles = std::vector<std::pair<std::string, LAMMPS_NS::Pair *>>;
  using BondStyles = std::vector<std::pair<std::string, LAMMPS_NS::Bond *>>;

  /* It tells its derived classes only. */
  class PairHybridParts : private LAMMPS_NS::PairHybrid {
   public:
    static PairStyles of(LAMMPS_NS::PairHybrid *hybrid)
    {
      PairStyles parts;
      for (int m = 0; m < hybrid->*&PairHybridParts::nstyles; m++)
        parts.emplace_back((hybrid->*&PairHybridParts::keywords)[m],
                           (hybrid->*&PairHybridParts::styles)[m]);
      return parts;
    }
  };

  inline PairStyles pair_styles(LAMMPS_NS::Force *force)
  {
    PairStyles all;
    if (!force->pair) return all;
    all.emplace_back(force->pair_style, force->pair);
    if (auto *hybrid = dynamic_cast<LAMMPS_NS::PairHybrid *>(force->pair))
      for (auto &part : PairHybridParts::of(hybrid)) all.push_back(part);
    return all;
  }

  inline BondStyles bond_styles(LAMMPS_NS::Force *force)
  {
    BondStyles all;
    if (!force->bond) return all;
    all.emplace_back(force->bond_style, force->bond);
    if (auto *hybrid = dynamic_cast<LAMMPS_NS::BondHybrid *>(force->bond))
      for (int m = 0; m < hybrid->nstyles; m++)
        all.emplace_back(hybrid->keywords[m], hybrid->styles[m]);
    return all;
  }

  inline void minimum_image(LAMMPS_NS::Domain *domain, double *d)
  {
#if SD_MINIMG_FLERR
    domain->minimum_image(FLERR, d);
#else
    domain->minimum_image(d);
#endif
  }

}    // namespace Compat
}    // namespace StokesDyn
#endif
