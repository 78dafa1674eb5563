/* Every difference between LAMMPS versions, 29Sep2021 to today, in one place. SD_HAVE_* come from
 * cmake/LammpsFeatures.cmake, which reads them off the headers. */
#ifndef SD_LAMMPS_COMPAT_H
#define SD_LAMMPS_COMPAT_H

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "region.h"
#include "update.h"

#if !SD_HAVE_THERMO_H
#include "library.h"
#endif

#if !SD_HAVE_ADD_REQUEST
#include "neigh_request.h"
#endif
#if SD_HAVE_FIX_GRAVITY_H
#include "fix_gravity.h"
#endif
#if SD_HAVE_THERMO_H
#include "thermo.h"
#endif

#include <cstring>
#include <string>
#include <utility>
#include <vector>

/* What installed headers leave out. Of AtomVec two functions, which no atom style replaces and which
 * the library exports. */
#if SD_HAVE_ATOM_VEC_H
#include "atom_vec.h"
#else
namespace LAMMPS_NS {
class AtomVec {
 public:
  void create_atom(int type, double *x);
  void copy(int from, int to, int forget);
};
}    // namespace LAMMPS_NS
#endif

/* Nor is the header of atom_style ellipsoid installed. Two functions that the library exports, by which
 * LAMMPS tells ranks of quaternions, read and write those of one atom. */
namespace LAMMPS_NS {
class AtomVecEllipsoid {
 public:
  int pack_comm_bonus(int n, int *list, double *quaternions);
  void unpack_comm_bonus(int n, int first, double *quaternions);
};
}    // namespace LAMMPS_NS

namespace StokesDyn {
namespace Compat {

  /* of atom_style ellipsoid, alone or in a hybrid; nullptr: there is none */
  inline LAMMPS_NS::AtomVecEllipsoid *ellipsoids(LAMMPS_NS::Atom *atom)
  {
    return reinterpret_cast<LAMMPS_NS::AtomVecEllipsoid *>(atom->style_match("ellipsoid"));
  }

  /* a quaternion for each atom (atom_style bpm/sphere) */
  inline bool has_quat(const LAMMPS_NS::Atom *atom)
  {
#if SD_HAVE_QUAT
    return atom->quat_flag && atom->quat;
#else
    (void) atom;
    return false;
#endif
  }

  inline double **quat(LAMMPS_NS::Atom *atom)
  {
#if SD_HAVE_QUAT
    return atom->quat;
#else
    (void) atom;
    return nullptr;
#endif
  }

  /* of a pair style or a fix */
#if SD_HAVE_COMM_THIS
  template <class Owner> void forward_comm(LAMMPS_NS::Comm *comm, Owner *of) { comm->forward_comm(of); }
  template <class Owner> void reverse_comm(LAMMPS_NS::Comm *comm, Owner *of) { comm->reverse_comm(of); }
#else
  inline void forward_comm(LAMMPS_NS::Comm *comm, LAMMPS_NS::Pair *pair) { comm->forward_comm_pair(pair); }
  inline void reverse_comm(LAMMPS_NS::Comm *comm, LAMMPS_NS::Pair *pair) { comm->reverse_comm_pair(pair); }
  inline void forward_comm(LAMMPS_NS::Comm *comm, LAMMPS_NS::Fix *fix) { comm->forward_comm_fix(fix); }
  inline void reverse_comm(LAMMPS_NS::Comm *comm, LAMMPS_NS::Fix *fix) { comm->reverse_comm_fix(fix); }
#endif

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

  /* The same in a step. Before a run with 'pre no' it may have been deleted or made anew, and so may what
   * it is made of, variables and the regions of a union, which it looks up again in the first step. */
  inline LAMMPS_NS::Region *region_of_step(LAMMPS_NS::Domain *domain, const LAMMPS_NS::Update *update,
                                           const std::string &id)
  {
    LAMMPS_NS::Region *found = region(domain, id);
    if (found && update->ntimestep == update->firststep + 1) found->init();
    return found;
  }

  /* nullptr if there is none */
  inline LAMMPS_NS::Fix *fix(LAMMPS_NS::Modify *modify, const std::string &id)
  {
    const int i = modify->find_fix(id);
    return i < 0 ? nullptr : modify->fix[i];
  }

  /* Names and styles: a hybrid (hybrid/overlay, hybrid/scaled), and behind it those below it. The headers
   * of hybrids are not installed; Force finds what is below them by name. */
  using PairStyles = std::vector<std::pair<std::string, LAMMPS_NS::Pair *>>;
  using BondStyles = std::vector<std::pair<std::string, LAMMPS_NS::Bond *>>;

  inline PairStyles pair_styles(LAMMPS_NS::Force *force)
  {
    PairStyles all;
    if (!force->pair) return all;
    all.emplace_back(force->pair_style, force->pair);
    if (all[0].first.compare(0, 6, "hybrid") != 0) return all;
    for (const auto &style : *force->pair_map) {
      LAMMPS_NS::Pair *last = nullptr;
      for (int n = 1;; n++) {    // a hybrid may have a style several times; its only one answers to each n
        LAMMPS_NS::Pair *part = force->pair_match(style.first, 1, n);
        if (!part || part == last) break;
        all.emplace_back(style.first, part);
        last = part;
      }
    }
    return all;
  }

  inline BondStyles bond_styles(LAMMPS_NS::Force *force)
  {
    BondStyles all;
    if (!force->bond) return all;
    all.emplace_back(force->bond_style, force->bond);
    if (all[0].first.compare(0, 6, "hybrid") != 0) return all;
    for (const auto &style : *force->bond_map)
      if (LAMMPS_NS::Bond *part = force->bond_match(style.first)) all.emplace_back(style.first, part);
    return all;
  }

  /* Is a fix gravity there for fix rigid only (its option disable)? */
#if SD_HAVE_FIX_GRAVITY_H
  class GravitySettings : private LAMMPS_NS::FixGravity {
   public:
    static bool disabled(LAMMPS_NS::Fix *fix)
    {
      return static_cast<LAMMPS_NS::FixGravity *>(fix)->*&GravitySettings::disable;
    }
  };
#else
  struct GravitySettings {
    static bool disabled(LAMMPS_NS::Fix *) { return false; }    // installed headers do not tell
  };
#endif

  /* Are the lines of thermo output, which have been printed, the user's own? Where installed headers do
   * not tell the style, the first columns do: they are those of LAMMPS's styles one and multi or not. */
  inline bool prints_custom_lines(LAMMPS_NS::LAMMPS *lmp)
  {
#if SD_HAVE_THERMO_H
    return lmp->output->thermo && strcmp(lmp->output->thermo->style, "custom") == 0;
#else
    const int *n = static_cast<const int *>(lammps_last_thermo(lmp, "num", 0));
    std::string first;
    for (int k = 0; n && k < *n && k < 4; k++) {
      const void *column = lammps_last_thermo(lmp, "keyword", k);
      first += std::string(static_cast<const char *>(column)) + " ";
    }
    return n && *n > 0 && first != "Step Temp E_pair E_mol " && first != "Step TotEng KinEng Temp ";
#endif
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
