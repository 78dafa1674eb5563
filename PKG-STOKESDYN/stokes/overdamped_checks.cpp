#include "overdamped_checks.h"

#include "fixes.h"
#include "hydrodynamics.h"
#include "keywords.h"
#include "ranks.h"

#include "fix.h"
#include "force.h"
#include "modify.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Do the groups of two fixes share an atom that is in none of the groups of `but`? */
static bool overlap(LAMMPS *lmp, const Fix *one, const Fix *other, int but)
{
  const int *mask = lmp->atom->mask;
  return first_atom(lmp, [=](int i) {
    return (mask[i] & one->groupbit) && (mask[i] & other->groupbit) && !(mask[i] & but);
  });
}

/* Stiffness and damping of a contact style of package GRANULAR, which tells nobody but a restart
 * file: k_n k_t gamma_n gamma_t friction */
struct Contact {
  std::string style;
  double k = 0.0, damping = 0.0, friction = 0.0;
};

static Contact contact_of(LAMMPS *lmp)
{
  Contact contact;
  for (const char *style : {"gran/hooke", "gran/hooke/history", "gran/hertz/history"}) {
    Pair *pair = lmp->force->pair ? lmp->force->pair_match(style, 1, 1) : nullptr;
    if (!pair) continue;
    double settings[5] = {0.0};
    FILE *file = tmpfile();
    if (!file) continue;
    pair->write_restart_settings(file);
    rewind(file);
    const bool complete = fread(settings, sizeof(double), 5, file) == 5;
    fclose(file);
    if (!complete) continue;
    contact.style = style;
    contact.k = settings[0];
    contact.damping = std::max(settings[2], settings[3]);
    contact.friction = settings[4];
  }
  return contact;
}

static void refuse_settings(const Voice &voice, const StokesSettings &s)
{
  const std::string pair = " of pair_style stokes_dynamics ";
  if (s.add_force)
    voice.fail("keyword add_force" + pair + "must be no: velocities follow from the drag, which is "
               "not added as a force");
  if (s.update_every != 1)
    voice.fail("keyword update_every" + pair + "must be 1, not " + std::to_string(s.update_every) +
               ": velocities follow from the forces of every step");
  if (s.rigid.auto_resolve)
    voice.fail("keyword rigid_clumps" + pair + "must be yes or no, not auto: this fix keeps clumps "
               "rigid");
  if (s.rigid.on && !s.scene.rotation)
    voice.fail("keyword rigid_clumps" + pair + "requires rotation yes or a shell: without torques "
               "nothing resists the spin of a straight clump");
}

static void refuse_fix(const Voice &voice, const Fix *self, const Fix *other,
                       const OverdampedWays &ways)
{
  const std::string name = name_of(other);
  if (ways.adapts && utils::strmatch(other->style, "^deform"))
    voice.fail("keyword adapt: " + name + " counts its rate per step, so that all steps must have "
               "one length: leave out adapt");
  if (strcmp(other->style, "stokes_dynamics") == 0)
    voice.fail(name + " cannot apply or report a force in this run (apply yes or no): use the "
               "output of this fix");
  bool drags = false;
  for (const char *style : {"^viscous", "^langevin", "^brownian", "^rigid"})
    drags = drags || utils::strmatch(other->style, style);
  const bool moves_held = strcmp(other->style, "move") == 0;
  const bool zeroes = strcmp(other->style, "setforce") == 0 || strcmp(other->style, "freeze") == 0;
  if (zeroes && overlap(voice.lmp, self, other, ways.held_bit))
    voice.warn(name + " sets forces to 0, and without inertia that does not hold a sphere: use "
               "keyword held GROUP");
  const int but = moves_held ? ways.held_bit : 0;
  if (!(drags || other->time_integrate) || !overlap(voice.lmp, self, other, but)) return;
  voice.fail(name + (other->time_integrate ? " integrates" : " adds a drag to") + " atoms of the "
             "same group: this fix does all of that itself" + (moves_held ? " (but for those of "
             "keyword held)" :""));
}

void refuse_inertia(const Voice &voice, const Fix *self,
                    const Hydrodynamics &hydro, const OverdampedWays &ways)
{
  LAMMPS *lmp = voice.lmp;
  if (lmp->update->whichflag == 2)
    voice.fail("minimize cannot be used with it: motion without inertia has no minimiser");
  if (utils::strmatch(lmp->update->integrate_style, "^respa"))
    fail(lmp, voice.command + " does not support run_style respa");
  refuse_settings(voice, hydro.settings);
  for (int i = 0; i < lmp->modify->nfix; i++)
    if (lmp->modify->fix[i] != self) refuse_fix(voice, self, lmp->modify->fix[i], ways);
  if (lmp->force->pair_match("^lubricate", 0, 1))
    voice.fail("pair_style lubricate* has a drag of its own, which would count twice: remove it");
  const Contact contact = contact_of(lmp);
  if (contact.damping > 0.0)
    voice.fail("pair_style " + contact.style + " damps its contacts (gamma " +
               text(contact.damping) + "), which would depend on the velocities of the step "
               "before: use gamma_n 0, gamma_t 0 (or NULL with gamma_n 0) and dampflag 0");
}

void refuse_friction(const Voice &keyword)
{
  LAMMPS *lmp = keyword.lmp;
  const Contact contact = contact_of(lmp);
  if (contact.friction > 0.0)
    keyword.fail("pair_style " + contact.style + " has friction (" + text(contact.friction) +
                 "), which would depend on velocities without noise: use 0");
  const bool walls = fix_like(lmp, "^wall/gran");
  if (!walls && !lmp->force->pair_match("^granular", 0, 1)) return;
  keyword.warn(std::string("contacts of ") + (walls ? "fix wall/gran" : "pair_style granular") +
               " must have no friction, which would depend on velocities without noise; this fix "
               "cannot check it");
}

void announce_step_limit(const Voice &voice, bool euler, double smallest_drag)
{
  LAMMPS *lmp = voice.lmp;
  Force *force = lmp->force;
  const double part = euler ? 0.78 : 0.39;
  const Contact contact = contact_of(lmp);
  const bool walls = fix_like(lmp, "^wall/gran");
  const bool granular = force->pair_match("^granular", 0, 1) != nullptr;
  const bool others = strcmp(force->pair_style, "stokes_dynamics") != 0 || force->bond || walls;
  if (!others) return;
  const double limit = part * smallest_drag;
  voice.tell("contacts and bonds of stiffness k allow time steps up to " + text(part) +
             " 6 pi eta a / k = " + text(limit) + " / k");
  const bool linear = !contact.style.empty() && !utils::strmatch(contact.style, "hertz");
  if (linear && contact.k > 0.0 && lmp->update->dt > limit / contact.k)
    voice.warn("time step " + text(lmp->update->dt) + " is above " + text(limit / contact.k) +
               ", the longest that pair_style " + contact.style + " with k " + text(contact.k) +
               " allows in dense packings");
  if (granular || walls)
    voice.warn(std::string("contacts of ") + (granular ? "pair_style granular" : "fix wall/gran") +
               " must have no damping (gamma 0), which would depend on the velocities of the step "
               "before; this fix cannot check it");
}

}    // namespace StokesDyn
