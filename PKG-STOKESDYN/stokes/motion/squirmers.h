/* Swimmers by a slip of their surface (sd_squirmer.h), for fix stokes_dynamics/overdamped: who they are and
 * what they do now. Their direction is mu, or without one the z axis of their quaternion. */
#ifndef SD_STOKES_SQUIRMERS_H
#define SD_STOKES_SQUIRMERS_H

#include "directions.h"
#include "field.h"
#include "keyword_group.h"
#include "keywords.h"
#include "pointers.h"

#include "sd_squirmer.h"

#include <vector>

namespace StokesDyn {

class Hydrodynamics;

class Squirmers : protected LAMMPS_NS::Pointers {
 public:
  Squirmers(const Voice &voice, const Directions &directions) :
      Pointers(voice.lmp), voice(voice.of("keyword squirm")), directions(directions)
  {
  }

  /* GROUP B1 B2 [beta] */
  void read(Keywords &in);
  bool on() const { return whom.on(); }
  /* Before a run. Errors: a group or variable that does not exist; spheres without a shell; spheres of it
   * that have no direction, or are not of the fix. */
  void init(const Hydrodynamics &hydro, int groupbit);

  /* The amplitudes of this step */
  void find();
  /* What atom i does, along its direction as it is now. false: it is no swimmer */
  bool stroke(int i, sd_squirmer_stroke &stroke) const;

 private:
  const Voice voice;
  const Directions &directions;
  KeywordGroup whom;
  Field B1, B2, beta;
  /* [3 nlocal] */
  std::vector<double> now;
};

}    // namespace StokesDyn
#endif
