/* What the keywords of pair_style sph/artVisc/tensCorr and its fixes make of rate and force, and what does
 * not go together. */
#ifndef SD_SPH_SCHEME_H
#define SD_SPH_SCHEME_H

#include "sph_roles.h"

namespace StokesDyn {

struct SphScheme {
  sd_sph_scheme scheme;
  /* The fluid fills its vessel: with correction, or with shift and P0 > 0, under which no surface is at
   * rest. */
  bool full;
  /* above which least eigenvalue of M a support is whole; 0: nobody asks */
  double whole;
};

/* of these roles; fails where keywords and fixes do not go together */
SphScheme choose_scheme(const SphCoefficients &settings, const SphRoles &roles);
/* of two fluids with correction */
void check_stiffness(const SphCoefficients &settings, const SphRoles &roles);

}    // namespace StokesDyn
#endif
