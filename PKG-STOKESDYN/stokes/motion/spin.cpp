#include "spin.h"

#include "hydrodynamics.h"
#include "keywords.h"

#include "sd_linear.h"

#include "atom.h"
#include "domain.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Spin::read(Keywords &in)
{
  double unused;
  whom.name = in.value("GROUP").word();
  for (double &component : field.omega) component = in.number();
  if (in.more() && is_number(in.peek(), unused)) field.most = in.positive();
  std::copy_n(field.omega, 3, field.axis);
  if (field.most > 0.0 && sd_dot(field.omega, field.omega) == 0.0)
    in.refuse("a largest torque needs an axis, and the angular velocity is 0: use held, or no largest "
              "torque");
  if (sd_dot(field.omega, field.omega) > 0.0) sd_normalize(field.axis);
}

void Spin::init(const Hydrodynamics &hydro, int held_bit)
{
  if (!on()) return;
  const std::string pair = " of pair_style stokes_dynamics";
  const Voice keyword = voice.of("keyword spin");
  whom.find(keyword);
  if (!hydro.rotation())
    keyword.fail("keyword rotation" + pair + " must be yes, or keyword multiblob given: points "
                 "without torques do not spin");
  if (hydro.settings.rigid.each_alone())
    keyword.fail("it is for spheres that feel each other: use clumps_only no" + pair);
  if (domain->dimension == 2 && (field.omega[0] != 0.0 || field.omega[1] != 0.0))
    keyword.fail("in two dimensions spheres spin about z alone: wx and wy must be 0");
  const bool clumps = hydro.settings.rigid.on;
  if (const tagint bound = first_atom(lmp, [&](int i) {
        return clumps && (atom->mask[i] & whom.bit) && atom->molecule[i] != 0;
      }))
    keyword.fail("atom " + std::to_string(bound) + " is part of a rigid clump: only free spheres spin");
  if (const tagint both = first_atom(lmp, [&](int i) {
        return (atom->mask[i] & whom.bit) && (atom->mask[i] & held_bit);
      }))
    keyword.fail("atom " + std::to_string(both) + " is in the group of keyword held or pin as well: it must "
                 "be in one of them only");
  for (int i = 0; i < atom->nlocal; i++)
    if (!(atom->mask[i] & whom.bit)) overloaded.erase(i);    // it may have been in the group before
}

bool Spin::turns(int i, double W[3]) const
{
  if (!(atom->mask[i] & whom.bit) || sign(i) != 0.0) return false;
  std::copy_n(field.omega, 3, W);
  return true;
}

void Spin::push(int i, double *torque) const
{
  if (!(atom->mask[i] & whom.bit)) return;
  for (int d = 0; d < 3; d++) torque[d] += sign(i) * field.most * field.axis[d];
}

void Spin::note_found(int i, const double *W, const double *by_fluid, const double *torque)
{
  if (!(atom->mask[i] & whom.bit) || field.most == 0.0) return;
  const double now = sign(i), next = sd_spin_overload(&field, now, W, by_fluid, torque);
  if (next == 0.0 && now == 0.0)
    overloaded.erase(i);
  else
    overloaded.writable(i)[1] = next;
}

void Spin::advance()
{
  for (int i = 0; i < atom->nlocal && field.most > 0.0; i++)
    if (overloaded.has(i)) overloaded.row(i)[0] = overloaded[i][1];
}

double Spin::count_overloaded() const
{
  double mine = 0.0;
  for (int i = 0; i < atom->nlocal; i++) mine += sign(i) != 0.0;
  return sum_of_all(world, mine);
}

}    // namespace StokesDyn
