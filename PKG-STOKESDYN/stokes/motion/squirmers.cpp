#include "squirmers.h"

#include "hydrodynamics.h"

#include "atom.h"
#include "modify.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Squirmers::read(Keywords &in)
{
  double unused;
  whom.name = in.value("GROUP").word();
  B1 = Field::parse(in.value("B1"));
  B2 = Field::parse(in.value("B2"));
  if (in.more() && (is_number(in.peek(), unused) || in.peek().compare(0, 2, "v_") == 0))
    beta = Field::parse(in);
}

void Squirmers::init(const Hydrodynamics &hydro, int groupbit)
{
  if (!on()) return;
  const std::string style = "pair_style stokes_dynamics";
  whom.find(voice);
  for (Field *amplitude : {&B1, &B2, &beta}) amplitude->init(lmp);
  if (!hydro.settings.shells.on())
    voice.fail("single points have no surface that slips: use multiblob of " + style +
               ", or push spheres without a flow of their own by fix propel/self");
  if (hydro.settings.rigid.each_alone())
    voice.fail("it is for spheres that feel each other: use clumps_only no of " + style);
  whom.require_moved(voice, groupbit);
  if (const tagint blind = first_atom(lmp, [this](int i) {
        double e[3];
        return (atom->mask[i] & whom.bit) && !directions.direction(i, e);
      }))
    voice.fail("atom " + std::to_string(blind) + " has no direction along which it swims: give it a "
               "dipole (atom_style dipole, set dipole) that is not 0, or a quaternion (atom_style "
               "ellipsoid)");
}

void Squirmers::find()
{
  if (!on()) return;
  whom.find(voice);
  now.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  modify->clearstep_compute();
  B1.evaluate(lmp, whom.number, now.data(), 3);
  B2.evaluate(lmp, whom.number, now.data() + 1, 3);
  beta.evaluate(lmp, whom.number, now.data() + 2, 3);
  modify->addstep_compute(update->ntimestep + 1);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *row = &now[3 * (size_t) i];
    if ((atom->mask[i] & whom.bit) && !std::isfinite(row[0] + row[1] + row[2]))
      voice.at_step().fail_one("B1, B2 or beta of atom " + std::to_string(atom->tag[i]) +
                               " is not a finite number");
  }
}

bool Squirmers::stroke(int i, sd_squirmer_stroke &stroke) const
{
  if (!on() || !(atom->mask[i] & whom.bit) || !directions.direction(i, stroke.e)) return false;
  const double *amplitudes = &now[3 * (size_t) i];
  stroke.B1 = amplitudes[0];
  stroke.B2 = amplitudes[1];
  stroke.beta = amplitudes[2];
  return true;
}

}    // namespace StokesDyn
