#include "torques.h"

#include "hydrodynamics.h"

#include "sd_linear.h"
#include "sd_pose.h"

#include "atom.h"
#include "domain.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Torques::read(Keywords &in)
{
  whom.name = in.value("GROUP").word();
  for (Field &component : T) component = Field::parse(in);
  if (in.take("body")) of_body = in.yes_no();
}

void Torques::init(const Hydrodynamics &hydro, int groupbit, int held_bit)
{
  if (!on()) return;
  whom.find(voice);
  for (Field &component : T) component.init(lmp);
  const auto first = [this](const std::function<bool(int)> &wrong) {
    return first_atom(lmp, [&](int i) { return (atom->mask[i] & whom.bit) && wrong(i); });
  };
  whom.require_moved(voice, groupbit);
  if (const tagint held = first([&](int i) { return atom->mask[i] & held_bit; }))
    voice.fail("atom " + std::to_string(held) + " is in the group of keyword held as well, whose "
               "velocity is given, so that torques do nothing: take it out of one of them, or use "
               "keyword pin for spheres that turn in their place");
  const bool clumps = hydro.settings.rigid.on;
  if (const tagint upright = first([&](int i) {
        return !hydro.rotation() && !(clumps && atom->molecule[i] != 0);
      }))
    voice.fail("atom " + std::to_string(upright) + " is a free sphere, and with rotation no of "
               "pair_style stokes_dynamics those do not turn: use rotation yes or multiblob");
  if (domain->dimension == 3) return;
  if (of_body) voice.fail("in two dimensions bodies turn about z alone: use body no");
  for (int d = 0; d < 2; d++)
    if (T[d].is_variable() || T[d].number() != 0.0)
      voice.fail("in two dimensions bodies turn about z alone: Tx and Ty must be 0");
}

void Torques::find(const Directions &directions, const Turned &turned)
{
  if (!on()) return;
  whom.find(voice);
  now.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  modify->clearstep_compute();
  for (size_t d = 0; d < 3; d++) T[d].evaluate(lmp, whom.number, now.data() + d, 3);
  modify->addstep_compute(update->ntimestep + 1);
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = &now[3 * (size_t) i];
    if (!(atom->mask[i] & whom.bit))
      std::fill_n(row, 3, 0.0);
    else if (of_body)
      turn(i, directions, turned(i));
    if (!std::isfinite(row[0] + row[1] + row[2]))
      voice.at_step().fail_one("the torque on atom " + std::to_string(atom->tag[i]) +
                               " is not a finite number");
  }
}

/* The torque on atom i, along its own axes, in space */
void Torques::turn(int i, const Directions &directions, const double *turned)
{
  double *row = &now[3 * (size_t) i], q[4], e[3], R[9];
  const double own[3] = {row[0], row[1], row[2]};
  const bool has_quaternion = directions.quaternion(i, q);
  const bool has_dipole = !has_quaternion && directions.direction(i, e);
  if (has_quaternion || (!has_dipole && turned)) {
    sd_quaternion_rotation(has_quaternion ? q : turned, R);
    sd_multiply3(R, own, row);
    return;
  }
  if (!has_dipole)
    voice.fail_one("body yes: atom " + std::to_string(atom->tag[i]) +
                   " has no axes of its own: give it a dipole (set dipole) or a quaternion "
                   "(atom_style ellipsoid, set quat), or make it part of a rigid clump");
  if (own[0] != 0.0 || own[1] != 0.0)
    voice.fail_one("body yes: atom " + std::to_string(atom->tag[i]) +
                   " has a dipole, which is a z axis alone: Tx and Ty must be 0");
  for (int d = 0; d < 3; d++) row[d] = own[2] * e[d];
}

void Torques::add(int i, double *torque) const
{
  for (size_t d = 0; d < 3 && on(); d++) torque[d] += now[3 * (size_t) i + d];
}

}    // namespace StokesDyn
