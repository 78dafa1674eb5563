#include "neighbours_stokes.h"

#include "deform_settings.h"
#include "fixes.h"
#include "lammps_compat.h"
#include "ranks.h"

#include "atom.h"
#include "compute.h"
#include "force.h"
#include "group.h"
#include "output.h"
#include "modify.h"
#include "pair.h"

#include "sd_linear.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

using namespace LAMMPS_NS;

namespace StokesDyn {

// --- what the name of a style does not tell ------------------------------------------------------

/* Those whose settings a restart file tells in the order of Contact */
static const char CONTACTS[] = "gran/hooke gran/hooke/history gran/hertz/history";

/* Fixes with a drag by the velocity, most of them with noise */
static const char DRAGGING[] = "viscous langevin* gld gle gjf ffl ttm* nve/dotc/langevin electron/stopping*";

/* false: it does not tell */
static bool read_contact(Pair *pair, Contact &contact)
{
  double settings[5];
  std::unique_ptr<FILE, int (*)(FILE *)> file(tmpfile(), fclose);
  if (!file) return false;
  pair->write_restart_settings(file.get());
  rewind(file.get());
  if (fread(settings, sizeof(double), 5, file.get()) != 5) return false;
  contact.k = settings[0];
  contact.across = settings[1];
  contact.damping = std::max(settings[2], settings[3]);
  contact.friction = settings[4];
  return true;
}

Contact contact_of(LAMMPS *lmp)
{
  Contact contact;
  for (const auto &each : Compat::pair_styles(lmp->force))
    if (fits(CONTACTS, plain_style(each.first)) && read_contact(each.second, contact)) contact.style = each.first;
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

/* Friction of bonds and of pairs by the relative velocity: which of the numbers that the style
 * writes into data files, behind those of the types */
struct Friction {
  const char *styles;
  size_t first, count;
};
static const Friction PAIR_FRICTION[] = {{"bpm/spring", 2, 1},    {"dpd", 1, 1},
                                         {"dpd/tstat", 0, 1},     {"dpd/ext", 1, 2},
                                         {"dpd/ext/tstat", 0, 2}, {"mdpd", 2, 1}};
static const Friction BOND_FRICTION[] = {{"bpm/spring", 2, 1}, {"bpm/rotational", 8, 4}};

/* The largest; -1: the style does not tell */
static double friction_of(const Guest &guest)
{
  const size_t types = guest.pair ? 2 : 1;
  const auto largest = [&](const Friction &which) {
    double gamma = -1.0;
    for (const auto &line : coefficients(guest))
      for (size_t k = types + which.first; k < types + which.first + which.count; k++)
        if (k < line.size()) gamma = std::max(gamma, line[k]);
    return gamma;
  };
  if (guest.pair)
    for (const Friction &which : PAIR_FRICTION)
      if (guest.style == which.styles) return largest(which);
  if (guest.bond)
    for (const Friction &which : BOND_FRICTION)
      if (guest.style == which.styles) return largest(which);
  return -1.0;
}

static bool damps(const Guest &guest, std::string &says)
{
  const double gamma = friction_of(guest);
  says = text(gamma);
  return gamma > 0.0;
}

static bool may_damp(const Guest &guest, std::string &)
{
  return friction_of(guest) < 0.0;
}

/* fix move has a row of its own */
static bool integrates(const Guest &guest, std::string &)
{
  return guest.fix->time_integrate && guest.style != "move";
}

static bool remaps_v(const Guest &guest, std::string &)
{
  return DeformSettings::remap(guest.fix) == Domain::V_REMAP;
}

/* of the fix that adds the drag */
static bool stands_before_drag(const Guest &guest, std::string &)
{
  return !stands_behind(guest, "stokes_dynamics");
}

static bool stands_behind_drag(const Guest &guest, std::string &)
{
  return stands_behind(guest, "stokes_dynamics");
}

/* fix propel/self: without dipoles and quaternions only its mode velocity is left */
static bool follows_velocities(const Guest &guest, std::string &)
{
  const Atom *atom = guest.lmp->atom;
  return !atom->mu_flag && !atom->ellipsoid_flag;
}

/* That mode leaves its virial out of the pressure, as fix_modify virial no does. */
static bool may_follow_velocities(const Guest &guest, std::string &says)
{
  return !follows_velocities(guest, says) && !guest.fix->thermo_virial;
}

static bool stands_before_motion(const Guest &guest, std::string &)
{
  return !stands_behind(guest, "stokes_dynamics/overdamped");
}

static bool has_one_atom(const Guest &guest, std::string &)
{
  return guest.lmp->group->count(guest.fix->igroup) == 1;
}

/* LAMMPS always has a compute thermo_press, and its own thermo styles print it unasked, but not its
 * components. Whether lines of the user's do is known when they have been printed. */
static bool is_asked_for(const Guest &guest, std::string &)
{
  if (strcmp(guest.compute->id, "thermo_press") != 0) return true;
  return guest.compute->invoked_vector >= 0 ||
      (guest.compute->invoked_scalar >= 0 && Compat::prints_custom_lines(guest.lmp));
}

/* Of atom styles that have shapes: compute property/atom tells them. */
static bool is_no_sphere(const Guest &guest, std::string &says)
{
  LAMMPS *lmp = guest.lmp;
  const char *ID = "STOKES_DYNAMICS_SHAPES";
  lmp->modify->add_compute(std::string(ID) + " all property/atom shapex shapey shapez");
  Compute *shapes = lmp->modify->compute[lmp->modify->find_compute(ID)];
  shapes->compute_peratom();
  const Atom *atom = lmp->atom;
  const tagint first = first_atom(lmp, [&](int i) {
    double off = 0.0;    // diameters; 0: a point
    for (int d = 0; d < 3; d++)
      off = std::max(off, fabs(shapes->array_atom[i][d] - 2.0 * atom->radius[i]));
    return guest.ours(i) && shapes->array_atom[i][0] > 0.0 && off > 1e-6 * atom->radius[i];
  });
  lmp->modify->delete_compute(ID);
  says = std::to_string(first);
  return first != 0;
}

/* Of atom styles line, tri and body, -1: none */
static bool has_shape(const Guest &guest, std::string &says)
{
  const Atom *atom = guest.lmp->atom;
  const int *shape = guest.style == "line" ? atom->line : guest.style == "tri" ? atom->tri : atom->body;
  const tagint first = first_atom(guest.lmp, [&](int i) { return guest.ours(i) && shape[i] >= 0; });
  says = std::to_string(first);
  return first != 0;
}

static bool has_moments(const Guest &guest, std::string &says)
{
  const Atom *atom = guest.lmp->atom;
  const tagint first =
      first_atom(guest.lmp, [&](int i) { return guest.ours(i) && atom->mu[i][3] > 0.0; });
  says = std::to_string(first);
  return first != 0;
}

// --- clumps whose spheres overlap ----------------------------------------------------------------

struct Member {
  double molecule, x[3], a, overlaps;
};

/* Of one clump, from `from` to `to`, by images side by side */
static bool overlap(const Domain *domain, const Member *from, const Member *to)
{
  constexpr double DEEP = 0.9;    // at 0.9 (a + b) two equal spheres share 0.7 % of their volume
  for (const Member *p = from; p < to; p++)
    for (const Member *q = p + 1; q < to; q++) {
      double r[3];
      sd_minus(p->x, q->x, r);
      Compat::minimum_image(const_cast<Domain *>(domain), r);
      if (sd_dot(r, r) < DEEP * DEEP * (p->a + q->a) * (p->a + q->a)) return true;
    }
  return false;
}

/* Members of a molecule meet on the rank that its number names. */
static bool pulls_on_overlaps(const Guest &guest, std::string &says)
{
  const Atom *atom = guest.lmp->atom;
  if (!atom->molecule || Compat::GravitySettings::disabled(guest.fix))
    return false;
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] > 0 && guest.ours(i) && (atom->mask[i] & guest.fix->groupbit))
      mine.push_back({(double) atom->molecule[i], {atom->x[i][0], atom->x[i][1], atom->x[i][2]},
                      atom->radius[i], 0.0});
  const int ranks = guest.lmp->comm->nprocs;
  ask_homes(
      guest.lmp->world, mine, [=](const Member &m) { return (int) ((bigint) m.molecule % ranks); },
      [&](std::vector<Member> &all) {
        std::vector<Member> sorted = all;
        std::stable_sort(sorted.begin(), sorted.end(), [](const Member &p, const Member &q) {
          return p.molecule < q.molecule;
        });
        double first = 0.0;
        for (size_t from = 0, to; from < sorted.size() && first == 0.0; from = to) {
          for (to = from; to < sorted.size() && sorted[to].molecule == sorted[from].molecule;) to++;
          if (overlap(guest.lmp->domain, &sorted[from], &sorted[from] + (to - from)))
            first = sorted[from].molecule;
        }
        for (Member &m : all) m.overlaps = first;
      });
  double first = INFINITY;
  for (const Member &m : mine)
    if (m.overlaps > 0.0) first = std::min(first, m.overlaps);
  first = smallest_of_all(guest.lmp->world, first);
  says = text(first);
  return std::isfinite(first);
}

// --- the table -----------------------------------------------------------------------------------

using N = Neighbour;

const std::vector<Neighbour> stokes_neighbours = {
    // another drag, other noise
    {N::FIX, DRAGGING, FORCE, N::ERROR,
     "adds a drag to spheres that the fluid drags as well, so that drag counts twice: take out "
     "this fix or the pair style; for noise that goes with the fluid use fix "
     "stokes_dynamics/overdamped with temperature"},
    {N::FIX, DRAGGING, OVERDAMPED, N::ERROR,
     "adds a drag to spheres that the fluid drags as well: take it out; noise is the keyword "
     "temperature of fix stokes_dynamics/overdamped"},
    {N::FIX, "viscous/sphere", TURNING, N::ERROR,
     "damps spins that the fluid damps as well: take it out, or use rotation no"},
    {N::FIX, "rigid*", FORCE, N::ERROR,
     "has a drag of its own (keyword langevin) on spheres that the fluid drags as well, so that "
     "drag counts twice: leave langevin out, or the pair style; for noise that goes with the fluid "
     "use fix stokes_dynamics/overdamped with temperature, which moves rigid clumps too", has_bath},
    {N::FIX, "brownian*", FORCE, N::ERROR,
     "moves spheres by a drag of its own, and the fluid drags them as well: take it out and use "
     "fix stokes_dynamics/overdamped, with temperature for the noise, or take out the pair style"},
    {N::PAIR, "lubricate* brownian*", FORCE, N::ERROR,
     "has a drag or noise of its own, and the fluid drags the spheres as well: take out one of the two; "
     "films are the keyword lubrication, noise is the keyword temperature of fix "
     "stokes_dynamics/overdamped"},
    {N::PAIR, "lubricate* brownian*", OVERDAMPED, N::ERROR,
     "has a drag or noise of its own, which would count twice: take it out; films are the keyword "
     "lubrication of the pair style, noise is the keyword temperature of fix "
     "stokes_dynamics/overdamped"},
    {N::PAIR, "*dpd*", FORCE, N::WARNING,
     "has friction between spheres (gamma {}) and may have noise, beside the fluid that is between them already: use "
     "gamma 0; for noise that goes with the fluid fix stokes_dynamics/overdamped with temperature", damps},
    {N::PAIR, "*dpd*", FORCE, N::WARNING,
     "has friction or noise of its own between spheres, beside the fluid that is between them already: take it out; "
     "for noise that goes with the fluid use fix stokes_dynamics/overdamped with temperature", may_damp},
    {N::FIX, "hydro/vans sph/grains lb/*", 0, N::ERROR,
     "drags spheres by a fluid of its own, and the fluid of pair_style stokes_dynamics drags them as "
     "well: take out one of the two, or give them different spheres"},
    {N::FIX, "srd", 0, N::WARNING,
     "has a fluid of its own: its big particles must be none of the spheres that the fluid of pair_style "
     "stokes_dynamics drags; this cannot be checked", nullptr, N::ANYWHERE},
    {N::FIX, "dt/reset", OVERDAMPED | NOISE, N::ERROR,
     "makes steps of unequal length, whose averages are not those of time: take it out", nullptr,
     N::ANYWHERE},

    // another motion
    {N::FIX, "move", OVERDAMPED, N::ERROR,
     "integrates spheres that fix stokes_dynamics/overdamped moves: name its group by keyword held "
     "of that fix, or take it out", nullptr, FREE},
    {N::FIX, "*", OVERDAMPED, N::ERROR,
     "integrates spheres that fix stokes_dynamics/overdamped moves: take it out", integrates},
    {N::FIX, "shake rattle", OVERDAMPED, N::ERROR,
     "finds the forces of its bonds from masses and velocities, which motion without inertia has not "
     "got: use stiff bonds (bond_style harmonic), or rigid_clumps yes for spheres that stay together"},
    {N::FIX, "nve nve/limit nvt npt nph nvk nvt/sllod nvt/uef npt/uef npt/cauchy nphug msst bocs", FORCE | TURNING,
     N::WARNING,
     "moves spheres but does not turn them, so that the torques of the fluid do nothing: use fix "
     "nve/sphere or its like"},
    {N::FIX, "*/asphere*", FORCE | TURNING, N::WARNING,
     "turns spheres by angular momenta, of which the fluid knows nothing, so that it does not damp "
     "their spin: use fix nve/sphere or its like"},
    {N::FIX, "setforce freeze", OVERDAMPED, N::WARNING,
     "sets forces, and without inertia a force of 0 does not hold a sphere: use keyword held GROUP, or pin "
     "GROUP for spheres that turn in their place", nullptr, FREE},
    {N::FIX, "setforce freeze planeforce lineforce aveforce flow/gauss", APPLIED, N::WARNING,
     "stands before fix stokes_dynamics in the input, whose drag then moves what it holds: define it "
     "behind", stands_before_drag},
    {N::FIX, "planeforce lineforce", OVERDAMPED, N::WARNING,
     "takes away forces across its plane or line, and without inertia spheres leave it all the same, since "
     "they move with the fluid: hold them there by springs (fix spring/self K z for planes of constant z)",
     nullptr, FREE},
    {N::FIX, "flow/gauss", OVERDAMPED, N::WARNING,
     "takes the mean force away, and without inertia no flow is left then: give the flow by keyword fluid_velocity "
     "of the pair style", nullptr, FREE},
    {N::FIX, "wall/reflect* wall/piston", OVERDAMPED | MIDWAY, N::ERROR,
     "stands before fix stokes_dynamics/overdamped in the input, whose step it then does not see, so that "
     "spheres stay behind its wall until the next one: define it behind", stands_before_motion},
    {N::FIX, "addtorque", TURNING, N::WARNING,
     "pushes the atoms of its group, which turns the group and not the spheres, and does nothing "
     "to a single sphere: a torque on spheres is the keyword torque of fix "
     "stokes_dynamics/overdamped", has_one_atom},

    {N::FIX, "temp/* momentum* oneway heat ehex viscosity thermal/conductivity wall/flow", OVERDAMPED, N::WARNING,
     "changes velocities, which without inertia follow from forces and flow: what is printed changes, but not the "
     "path of the spheres: take it out", nullptr, FREE},
    {N::FIX, "nvt* npt* nvk temp/* rigid/nvt* rigid/npt* bocs hmc", FORCE, N::WARNING,
     "changes velocities to hold a temperature, as a drag or a push beside that of the fluid, so that spheres neither "
     "settle nor flow as the fluid has it: use fix nve/sphere, or rigid/small for rigid clumps; for noise fix "
     "stokes_dynamics/overdamped with temperature"},
    {N::FIX, "momentum* viscosity thermal/conductivity heat ehex", FORCE, N::WARNING,
     "changes velocities of spheres beside the forces on them, of which the fluid feels nothing, so that spheres "
     "neither settle nor flow as the fluid has it: take it out"},
    {N::FIX, "damping/cundall", ADDED, N::WARNING,
     "makes forces larger that oppose a velocity, and so also the drag of the fluid: use add_force no, and fix "
     "stokes_dynamics behind it in the input"},
    {N::FIX, "damping/cundall", APPLIED, N::WARNING,
     "stands behind fix stokes_dynamics in the input and makes forces larger that oppose a velocity, and so also the "
     "drag of the fluid: define it before", stands_behind_drag},
    {N::FIX, "ti/spring", ADDED, N::WARNING,
     "scales all forces on its spheres, and so also the drag of the fluid: use add_force no, and fix stokes_dynamics "
     "behind it in the input"},
    {N::FIX, "ti/spring", APPLIED, N::WARNING,
     "stands behind fix stokes_dynamics in the input and scales all forces on its spheres, and so also the drag of the "
     "fluid: define it before", stands_behind_drag},
    {N::FIX, "numdiff*", ADDED | TURNING, N::WARNING,
     "computes forces once more in the same step, and LAMMPS does not take away the torques of pair styles in between, "
     "so that spheres turn too fast: use add_force no, and fix stokes_dynamics"},
    {N::COMPUTE, "fep* born/matrix", ADDED | TURNING, N::WARNING,
     "computes forces once more in the same step (born/matrix with numdiff), and LAMMPS does not take away the torques of pair styles in between, "
     "so that spheres turn too fast: use add_force no, and fix stokes_dynamics"},
    {N::COMMAND, "timestep", FORCE, N::ERROR,
     "is {}, and drag would drive velocities apart on the way back: use a positive one", runs_back, N::ANYWHERE},

    // boxes that change
    {N::FIX, "deform*", OVERDAMPED | ADAPTING, N::ERROR,
     "counts its rate per step, so that all steps must have one length: leave out adapt", nullptr,
     N::ANYWHERE},
    {N::FIX, "deform*", RESTING, N::WARNING,
     "deforms the box with remap v, but the fluid rests, so that it holds the spheres back: use "
     "fluid_velocity box if the fluid is to be sheared", remaps_v, N::ANYWHERE},

    // forces by the velocities of the step before
    {N::PAIR, CONTACTS, OVERDAMPED, N::ERROR,
     "damps its contacts (gamma {}), which would depend on the velocities of the step before: use "
     "gamma_n 0, gamma_t 0 (or NULL with gamma_n 0) and dampflag 0", contact_damps},
    {N::PAIR, CONTACTS, OVERDAMPED | NOISE, N::ERROR,
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
    {N::FIX, "propel/self", OVERDAMPED, N::ERROR,
     "pushes spheres along their velocities (mode velocity), which would be those of the step before: use mode "
     "dipole, with atom_style dipole and spheres that turn", follows_velocities},
    {N::FIX, "propel/self", OVERDAMPED | TURNING, N::WARNING,
     "pushes spheres along their velocities if its mode is velocity, which would be those of the step before: use "
     "mode dipole", may_follow_velocities},
    {N::FIX, "damping/cundall", OVERDAMPED, N::ERROR,
     "makes forces smaller by the velocities of the step before: take it out"},
    {N::PAIR, "*dpd* bpm/spring", OVERDAMPED, N::ERROR,
     "has friction between spheres (gamma {}), which would depend on the velocities of the step "
     "before, and has no place beside the friction of the fluid: use gamma 0", damps},
    {N::PAIR, "*dpd*", OVERDAMPED, N::ERROR,
     "has friction or noise of its own between spheres: take it out; noise is the keyword "
     "temperature of fix stokes_dynamics/overdamped", may_damp},
    {N::BOND, "bpm/*", OVERDAMPED, N::ERROR,
     "damps its bonds (gamma {}), which would depend on the velocities of the step before: use "
     "gamma 0", damps},
    {N::BOND, "bpm/*", OVERDAMPED, N::WARNING,
     "must have no damping (gamma 0), which would depend on the velocities of the step before; "
     "this cannot be checked", may_damp},

    // directions and shapes
    {N::ATOM, "dipole", OVERDAMPED | UPRIGHT, N::ERROR,
     "has directions (the dipole of atom {}), which turn with their spheres, and with rotation no "
     "spheres do not turn: use rotation yes or multiblob, or set dipoles that mean nothing to 0 0 0",
     has_moments, FREE},
    {N::BOND, "bpm/rotational", OVERDAMPED | UPRIGHT, N::ERROR,
     "needs spheres that turn, and with rotation no they do not: use rotation yes or multiblob, or "
     "bpm/spring"},
    {N::ATOM, "ellipsoid", 0, N::WARNING,
     "gives atom {} a shape that is not that of its sphere, and the fluid sees the sphere "
     "(diameter) only: fill an ellipsoid with the spheres of a rigid clump", is_no_sphere},
    {N::ATOM, "line tri body", 0, N::WARNING,
     "gives atom {} a shape of its own, and the fluid sees a sphere with its radius, which does not turn it: fill the "
     "shape with the spheres of a rigid clump", has_shape},

    // who is there
    {N::COMMAND, "neigh_modify", 0, N::ERROR,
     "has {}: its forces of all steps add up, as LAMMPS clears those of the group alone: name a group with all "
     "spheres that take part, or take it out", leaves_out},

    // weights and stresses
    {N::FIX, "gravity", 0, N::WARNING,
     "pulls on the mass of each sphere, and in the clump of molecule {} spheres overlap, so that "
     "what they share weighs twice: lower their density until the masses add up to that of the "
     "clump, or give it its weight by fix addforce", pulls_on_overlaps},
    {N::COMPUTE, "pressure* stress/* centroid/stress/*", 0, N::WARNING,
     "knows nothing of the forces between spheres and fluid, which have no virial: the stress of "
     "the suspension is compute stokes_dynamics/stress", is_asked_for},
    {N::PAIR, "hybrid/scaled*", 0, N::ERROR,
     "scales forces of stokes_dynamics by {}, which not all that follows from them would feel: use "
     "the factor 1.0", scales_us, N::ANYWHERE},

    // what goes together
    {N::FIX, "move setforce freeze", OVERDAMPED, N::FINE, "go with spheres of keyword held"},
};

}    // namespace StokesDyn
