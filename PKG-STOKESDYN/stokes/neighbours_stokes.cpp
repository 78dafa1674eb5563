#include "neighbours_stokes.h"

#include "fixes.h"

#include "force.h"
#include "pair.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>

using namespace LAMMPS_NS;

namespace StokesDyn {

// --- what the name of a style does not tell ------------------------------------------------------

/* false: it is none of package GRANULAR, or does not tell */
static bool read_contact(Pair *pair, Contact &contact)
{
  double settings[5];
  std::unique_ptr<FILE, int (*)(FILE *)> file(tmpfile(), fclose);
  if (!file) return false;
  pair->write_restart_settings(file.get());
  rewind(file.get());
  if (fread(settings, sizeof(double), 5, file.get()) != 5) return false;
  contact.k = settings[0];
  contact.damping = std::max(settings[2], settings[3]);
  contact.friction = settings[4];
  return true;
}

Contact contact_of(LAMMPS *lmp)
{
  Contact contact;
  for (const char *style : {"gran/hooke", "gran/hooke/history", "gran/hertz/history"}) {
    Pair *pair = lmp->force->pair ? lmp->force->pair_match(style, 1, 1) : nullptr;
    if (pair && read_contact(pair, contact)) contact.style = style;
  }
  return contact;
}

static bool contact_damps(const Guest &guest, std::string &says)
{
  Contact contact;
  if (!read_contact(guest.pair, contact)) return false;
  says = text(contact.damping);
  return contact.damping > 0.0;
}

static bool contact_rubs(const Guest &guest, std::string &says)
{
  Contact contact;
  if (!read_contact(guest.pair, contact)) return false;
  says = text(contact.friction);
  return contact.friction > 0.0;
}

/* fix move has a row of its own */
static bool integrates(const Guest &guest, std::string &)
{
  return guest.fix->time_integrate && guest.style != "move";
}

// --- the table -----------------------------------------------------------------------------------

const std::vector<Neighbour> &stokes_neighbours()
{
  using N = Neighbour;
  static const std::vector<Neighbour> table = {
      // another drag, other noise
      {N::FIX, "viscous* langevin*", OVERDAMPED, N::ERROR,
       "adds a drag to spheres that the fluid drags already: take it out; noise is the keyword "
       "temperature of fix stokes_dynamics/overdamped"},
      {N::PAIR, "lubricate*", OVERDAMPED, N::ERROR,
       "has a drag of its own, which would count twice: take it out"},
      {N::PAIR, "brownian*", OVERDAMPED | NOISE, N::ERROR, "has noise of its own: take it out"},
      {N::FIX, "dt/reset", OVERDAMPED | NOISE, N::ERROR,
       "makes steps of unequal length, whose averages are not those of time: take it out", nullptr,
       N::ANYWHERE},
      // another motion
      {N::FIX, "move", OVERDAMPED, N::ERROR,
       "integrates spheres that fix stokes_dynamics/overdamped moves: name its group by keyword "
       "held of that fix, or take it out", nullptr, FREE},
      {N::FIX, "*", OVERDAMPED, N::ERROR,
       "integrates spheres that fix stokes_dynamics/overdamped moves: take it out", integrates},
      {N::FIX, "setforce freeze", OVERDAMPED, N::WARNING,
       "sets forces to 0, and without inertia that does not hold a sphere: use keyword held GROUP",
       nullptr, FREE},
      {N::FIX, "deform*", OVERDAMPED | ADAPTING, N::ERROR,
       "counts its rate per step, so that all steps must have one length: leave out adapt", nullptr,
       N::ANYWHERE},
      // forces by the velocities of the step before
      {N::PAIR, "gran/hooke gran/hooke/history gran/hertz/history", OVERDAMPED, N::ERROR,
       "damps its contacts (gamma {}), which would depend on the velocities of the step before: use "
       "gamma_n 0, gamma_t 0 (or NULL with gamma_n 0) and dampflag 0", contact_damps},
      {N::PAIR, "gran/hooke gran/hooke/history gran/hertz/history", OVERDAMPED | NOISE, N::ERROR,
       "has friction ({}), which would depend on velocities without noise: use 0", contact_rubs},
      {N::PAIR, "granular", OVERDAMPED, N::WARNING,
       "must have no damping (gamma 0), which would depend on the velocities of the step before; "
       "this cannot be checked"},
      {N::FIX, "wall/gran*", OVERDAMPED, N::WARNING,
       "must have no damping (gamma 0), which would depend on the velocities of the step before; "
       "this cannot be checked"},
      {N::PAIR, "granular", OVERDAMPED | NOISE, N::WARNING,
       "must have no friction, which would depend on velocities without noise; this cannot be "
       "checked"},
      {N::FIX, "wall/gran*", OVERDAMPED | NOISE, N::WARNING,
       "must have no friction, which would depend on velocities without noise; this cannot be "
       "checked"},
  };
  return table;
}

}    // namespace StokesDyn
