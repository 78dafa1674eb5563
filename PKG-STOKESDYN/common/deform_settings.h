/* What a fix deform has been told, as LAMMPS keeps it: a source tree has fix_deform.h; for installed
 * headers, which lack it, this file says where 22Jul2025 keeps what, and looks whether it is so. */
#ifndef SD_DEFORM_SETTINGS_H
#define SD_DEFORM_SETTINGS_H

#include "domain.h"
#include "fix.h"

#if SD_HAVE_FIX_DEFORM_H
#include "fix_deform.h"
#else
#include <vector>
namespace LAMMPS_NS {
class FixDeform : public Fix {
 public:
  int remapflag, dimflag[6];

 protected:
  int flags[7];
  double *h_rate, *h_ratelo;
  int more_flags[2];
  std::vector<Fix *> rigid;
  void *irregular;
  /* one for each of x y z yz xz xy */
  struct Set {
    int style, substyle;
    double limits[6], scale, vel, rate, amplitude, tperiod;
    double lo_initial, hi_initial, lo_start, hi_start, lo_stop, hi_stop, lo_target, hi_target;
    double tilt_initial, tilt_start, tilt_stop, tilt_target, tilt_flip, tilt_least, tilt_most;
    double volumes[2];
    int fixed, dynamic1, dynamic2;
    char *names[2];
    int hvar, hratevar;
  };
  Set *set;
};
}    // namespace LAMMPS_NS
#endif

namespace StokesDyn {

/* Tells what LAMMPS tells derived classes only. */
class DeformSettings : private LAMMPS_NS::FixDeform {
 public:
  /* of style and of substyle */
  enum Style { NONE, FINAL, DELTA, SCALE, VEL, ERATE, TRATE, VOLUME, WIGGLE, VARIABLE };
  enum Volume { ONE_FROM_ONE, ONE_FROM_TWO, TWO_FROM_ONE };

  /* Of a fix of style deform: by index 0 ... 5 of x y z yz xz xy */
  static auto of(LAMMPS_NS::Fix *fix)
  {
    return static_cast<LAMMPS_NS::FixDeform *>(fix)->*&DeformSettings::set;
  }

  /* Domain::X_REMAP, V_REMAP or NO_REMAP */
  static int remap(const LAMMPS_NS::Fix *fix)
  {
    return static_cast<const LAMMPS_NS::FixDeform *>(fix)->remapflag;
  }

  /* Are its fields where this plugin was compiled to look for them? Error: they are not. To be called
   * on all ranks before `of`, and after LAMMPS's init. */
  static void check(LAMMPS_NS::LAMMPS *lmp, LAMMPS_NS::Fix *fix);
};

}    // namespace StokesDyn
#endif
