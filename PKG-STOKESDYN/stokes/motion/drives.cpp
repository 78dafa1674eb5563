#include "drives.h"

#include "copy.h"
#include "fixes.h"
#include "hydrodynamics.h"
#include "ranks.h"

#include "atom.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <string>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Drives::read(Keywords &in)
{
  if (in.is("held")) held.name = in.value("GROUP").word();
  if (in.is("pin")) pinned.name = in.value("GROUP").word();
  if (in.is("spin")) spin.read(in);
  if (in.is("torque")) torques.read(in);
  if (in.is("squirm")) squirmers.read(in);
}

void Drives::init(const Hydrodynamics &hydro, int groupbit)
{
  held.find(voice.of("keyword held"));
  pinned.find(voice.of("keyword pin"));
  moved_bits = 0;
  for (const Fix *fix : fixes_of(lmp, "move"))
    if (held.bit) moved_bits |= fix->groupbit;
  directions.init(moves_any());
  if (pinned.bit) refuse_pinned(hydro);
  spin.init(hydro, held.bit | pinned.bit);
  torques.init(hydro, groupbit, held.bit);
  squirmers.init(hydro, groupbit);
}

void Drives::refuse_pinned(const Hydrodynamics &hydro) const
{
  const Voice keyword = voice.of("keyword pin");
  if (const tagint both = first_atom(lmp, [this](int i) {
        return is_held(i) && (atom->mask[i] & pinned.bit);
      }))
    keyword.fail("atom " + std::to_string(both) + " is in the group of keyword held as well: it must be in "
                 "one of them only");
  if (hydro.settings.rigid.each_alone())
    keyword.fail("it is for spheres and clumps that feel each other: use clumps_only no of pair_style "
                 "stokes_dynamics");
}

std::string Drives::holds() const
{
  return held.on() ? "keyword held" : pinned.on() ? "keyword pin" : spin.on() ? "keyword spin" : "";
}

void Drives::find(const Torques::Turned &turned)
{
  held.find(voice.of("keyword held"));
  pinned.find(voice.of("keyword pin"));
  spin.find();
  squirmers.find();
  torques.find(directions, turned);
}

void Drives::check_loads(const Hydrodynamics &hydro) const
{
  for (int i : hydro.ambient.who()) {
    double FT[6] = {0.0}, sum = 0.0;
    copy<3>(atom_row(atom->f, i), FT);
    if (atom->torque_flag) copy<3>(atom_row(atom->torque, i), FT + 3);
    for (double part : FT) sum += part;
    if (!std::isfinite(sum) && !is_held(i))
      voice.at_step().fail_one("the force or torque on atom " + std::to_string(atom->tag[i]) +
                               " is not a finite number: are two atoms at one point, or has the run blown up?");
  }
}

void Drives::note_start()
{
  at_start.clear();
  if (moves_any() && atom->nlocal > 0) at_start.assign(atom->v[0], atom->v[0] + 3 * (size_t) atom->nlocal);
}

/* fix move cannot be asked for its NULL, but in such a direction v changes by half a step of f/m. What no force pushes
 * as the run begins is not seen. */
void Drives::check_moved()
{
  if (!moves_any()) return;
  const bool known = at_start.size() == 3 * (size_t) atom->nlocal;
  for (int d = 0; d < 3; d++) {
    const tagint first = first_atom(lmp, [this, d, known](int i) {
      if (!known || !is_moved(i)) return false;
      const double m = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]], v = at_start[3 * (size_t) i + d];
      const double kick = 0.5 * update->dt * force->ftm2v * atom->f[i][d] / m;
      return std::isfinite(kick) && fabs(kick) > 1e-10 * fabs(v) && fabs(atom->v[i][d] - v - kick) <= 1e-5 * fabs(kick);
    });
    if (first)
      voice.of("keyword held").fail(std::string("fix move leaves atom ") + std::to_string(first) + " free along " +
                                    "xyz"[d] + " (NULL), where force and mass then move it as if there were no fluid: "
                                    "give a velocity there, which may be 0");
  }
  at_start.clear();
}

/* Those that fix move moves have the velocity that it gave them, others that are held have none. */
sd_body_known Drives::known(int i, double *V) const
{
  std::fill_n(V, 6, 0.0);
  if (atom->mask[i] & pinned.bit) return SD_BODY_PINNED;
  if (!is_held(i)) return spin.turns(i, V + 3) ? SD_BODY_SPUN : SD_BODY_FREE;
  if (!is_moved(i)) return SD_BODY_HELD;
  std::copy_n(moved_with.empty() ? atom->v[i] : &moved_with[3 * (size_t) i], 3, V);
  if (atom->omega_flag) std::copy_n(atom->omega[i], 3, V + 3);
  return SD_BODY_HELD;
}

void Drives::load(int i, double *FT) const
{
  std::fill_n(FT, 6, 0.0);
  copy<3>(atom_row(atom->f, i), FT);
  if (atom->torque_flag) copy<3>(atom_row(atom->torque, i), FT + 3);
  torques.add(i, FT + 3);
}

/* The same as it goes on, with the torque on those overloaded */
void Drives::push(int i, double change, double *FT) const
{
  load(i, FT);
  for (int d = 0; d < 6 && change > 0.0 && before.has(i); d++) FT[d] += change * (FT[d] - before[i][d]);
  if (spin.on()) spin.push(i, FT + 3);
}

Given Drives::given(double change) const
{
  Given all;
  if (change > 0.0 || spin.on() || torques.on() || !atom->torque_flag)
    all.loads = [this, change](int i, double *FT) { push(i, change, FT); };
  else    // at once: of scenes that solve nothing this is a part of the cost
    all.loads = [f = atom->f, torque = atom->torque](int i, double *FT) {
      copy<3>(atom_row(f, i), FT);
      copy<3>(atom_row(torque, i), FT + 3);
    };
  if (holds_any())
    all.known = [this](int i, double *V) { return known(i, V); };
  if (squirmers.on())
    all.swims = [this](int i, sd_squirmer_stroke &stroke) { return squirmers.stroke(i, stroke); };
  return all;
}

void Drives::note_spin(int i, const double *W, const double *by_fluid, double change)
{
  double pushed[6];
  push(i, change, pushed);
  spin.note_found(i, W, by_fluid, pushed + 3);
}

}    // namespace StokesDyn
