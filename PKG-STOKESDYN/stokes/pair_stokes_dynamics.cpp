#include "pair_stokes_dynamics.h"

#include "fix_stokes_dynamics.h"
#include "keywords.h"
#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = PairStokesDynamics::COMMAND_NAME;
static const char *STATE_ID = "STOKES_DYNAMICS_STATE";

PairStokesDynamics::PairStokesDynamics(LAMMPS *lmp) :
    Pair(lmp), scene(lmp, this, COMMAND), rigid(lmp, scene, COMMAND), preconditioner(lmp, scene),
    sorting_bins(lmp)
{
  single_enable = 0;
  respa_enable = 0;
  manybody_flag = 1;
  one_coeff = 1;
  restartinfo = 1;
  no_virial_fdotr_compute =
      1;                // drag acts between sphere and fluid: its x.F depends on the origin
  comm_forward = 19;    // most: what rigid clumps know of an atom (RigidClumps::gather)
  nextra = 4;           // compute pair: iterations, residual, unconverged solves, dissipation
  pvector = new double[nextra];
  for (int k = 0; k < nextra; k++) pvector[k] = 0.0;
}

PairStokesDynamics::~PairStokesDynamics()
{
  if (find_state()) modify->delete_fix(STATE_ID);
  delete[] pvector;
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

// --- settings ----------------------------------------------------------------------------------------------

void PairStokesDynamics::settings(int narg, char **arg)
{
  args = words(narg, arg);
  parse();
}

FixStokesDynamicsState *PairStokesDynamics::find_state() const
{
  return static_cast<FixStokesDynamicsState *>(Compat::fix(modify, STATE_ID));
}

void PairStokesDynamics::parse()
{
  update_every = 1;
  add_force = false;
  tolerance = 1e-3;
  max_iter = 100;
  algorithm = 1;
  visc = Field();
  for (auto &u : fluid_velocity) u = Field(0.0);
  for (auto &w : fluid_vorticity) w = Field(0.0);
  has_vorticity = false;
  region_id.clear();
  group_id = "all";
  scene.settings = Scene::Settings();
  scene.lists_are_stale();
  rigid.settings = RigidClumps::Settings();
  preconditioner.forget();
  preconditioner.kind = Preconditioner::AUTO;
  warm_start = true;
  rigid.forget();
  bool has_shell = false;

  bool has_visc = false, has_cutoff = false;
  Keywords in(lmp, COMMAND, args);
  while (in.next()) {
    if (in.is("cut_off_distance")) {
      if (in.more() && in.peek() == "inf") {
        in.word();
        scene.settings.cutoff = INFINITY;
      } else
        scene.settings.cutoff = in.positive();
      has_cutoff = true;
    } else if (in.is("update_every"))
      update_every = in.integer(1);
    else if (in.is("clumps_only"))
      scene.settings.clumps_only = in.yes_no();
    else if (in.is("visc")) {
      visc = Field::parse(in);
      if (!visc.is_variable() && !(visc.number() > 0.0))
        in.refuse("'" + text(visc.number()) + "' must be > 0");
      has_visc = true;
    } else if (in.is("region"))
      region_id = in.word();
    else if (in.is("group"))
      group_id = in.word();
    else if (in.is("add_force"))
      add_force = in.yes_no();
    else if (in.is("relative_tolerance"))
      tolerance = in.positive();
    else if (in.is("max_iter"))
      max_iter = in.integer(1);
    else if (in.is("algorithm"))
      algorithm = 1 + in.choice({"1", "2"});
    else if (in.is("fluid_velocity"))
      for (auto &u : fluid_velocity) u = Field::parse(in);
    else if (in.is("fluid_vorticity")) {
      for (auto &w : fluid_vorticity) w = Field::parse(in);
      has_vorticity = true;
    } else if (in.is("rotation"))
      scene.settings.rotation = in.yes_no();
    else if (in.is("tensor"))
      scene.settings.tensor = in.choice({"rpy", "oseen"}) == 0 ? SD_TENSOR_RPY : SD_TENSOR_OSEEN;
    else if (in.is("rigid_clumps")) {
      const size_t choice = in.choice({"no", "yes", "auto"});
      rigid.settings.on = choice > 0;
      rigid.settings.auto_resolve = choice == 2;
    } else if (in.is("shell")) {
      rigid.settings.shell = in.integer(1);
      if (rigid.settings.shell > 1 && rigid.settings.shell < 12)
        in.refuse("'" + std::to_string(rigid.settings.shell) + "' must be 1 or >= 12");
      has_shell = true;
    } else if (in.is("taper"))
      scene.settings.taper = (sd_taper) in.choice({"none", "wendland", "spherical"});
    else if (in.is("precondition"))
      preconditioner.kind = (Preconditioner::Kind) in.choice({"auto", "none", "clump", "sparse"});
    else if (in.is("warm_start"))
      warm_start = in.yes_no();
    else
      in.unknown();
  }
  if (!has_visc) fail(lmp, COMMAND + ": keyword visc is required: the dynamic viscosity");
  if (!has_cutoff) {
    if (!scene.settings.clumps_only)
      fail(lmp,
           COMMAND +
               ": keyword cut_off_distance is required (a distance or inf) unless clumps_only yes");
    scene.settings.cutoff = INFINITY;
  }
  if (scene.settings.taper != SD_TAPER_NONE && std::isinf(scene.settings.cutoff))
    fail(lmp, COMMAND + ": keyword taper requires a cut_off_distance, its range");
  if (preconditioner.kind == Preconditioner::SPARSE && !scene.all_pairs())
    fail(lmp,
         COMMAND +
             ": keyword precondition: 'sparse' requires cut_off_distance inf and clumps_only no");
  if (preconditioner.kind > Preconditioner::NONE && algorithm == 1)
    fail(lmp,
         COMMAND + ": keyword precondition: '" +
             (preconditioner.kind == Preconditioner::CLUMP ? "clump" : "sparse") +
             "' requires algorithm 2");
  if (rigid.settings.on && !scene.settings.clumps_only)
    fail(lmp, COMMAND + ": keyword rigid_clumps requires clumps_only yes");
  if (rigid.settings.on && std::isfinite(scene.settings.cutoff))
    fail(lmp,
         COMMAND +
             ": keyword rigid_clumps: no cut_off_distance may be given, the whole of a clump is "
             "solved");
  if (has_shell && !rigid.settings.on)
    fail(lmp, COMMAND + ": keyword shell requires rigid_clumps yes");
  if (rigid.settings.on && scene.settings.tensor == SD_TENSOR_OSEEN)
    fail(lmp, COMMAND + ": keyword rigid_clumps is not available with tensor oseen");
  // Points on a surface take torques, whether rotation is asked for or not.
  if (rigid.settings.shell > 1) scene.settings.rotation = true;
  rigid.settings.rotation = scene.settings.rotation;
  if (scene.settings.rotation && scene.settings.tensor == SD_TENSOR_OSEEN)
    fail(lmp,
         COMMAND +
             ": keyword rotation: yes is not available with tensor oseen, whose point forces do "
             "not rotate");
  if (has_vorticity && !scene.settings.rotation)
    fail(lmp, COMMAND + ": keyword fluid_vorticity has no effect without rotation yes or a shell");
}

void PairStokesDynamics::coeff(int narg, char **arg)
{
  if (narg != 2 || strcmp(arg[0], "*") != 0 || strcmp(arg[1], "*") != 0)
    fail(lmp,
         COMMAND +
             ": the only form of pair_coeff is: pair_coeff * * (use the keywords group and region "
             "to select spheres)");
  if (!allocated) allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) setflag[i][j] = 1;
}

void PairStokesDynamics::allocate()
{
  allocated = 1;
  const int n = atom->ntypes;
  memory->create(setflag, n + 1, n + 1, "pair:setflag");
  memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
  for (int i = 1; i <= n; i++)
    for (int j = i; j <= n; j++) setflag[i][j] = 0;
}

/* FNV-1a over all words */
static uint64_t hash(const std::vector<std::string> &words)
{
  uint64_t h = 14695981039346656037u;
  for (const auto &word : words)
    for (size_t k = 0; k <= word.size(); k++)
      h = (h ^ (unsigned char) word.c_str()[k]) * 1099511628211u;
  return h;
}

void PairStokesDynamics::init_style()
{
  if (update->whichflag == 2)
    fail(lmp,
         COMMAND +
             " cannot be minimised: a drag depends on velocities and has no energy; use "
             "'pair_style none' meanwhile");
  if (utils::strmatch(update->integrate_style, "^respa"))
    fail(lmp, COMMAND + " does not support run_style respa");
  if (force->pair_match(STYLE, 1) != this)
    fail(lmp, COMMAND + " may appear only once in a hybrid pair style");
  if (!atom->radius_flag)
    fail(lmp, COMMAND + " requires an atom style with radius, such as sphere");
  if (atom->tag_enable == 0) fail(lmp, COMMAND + " requires atom IDs");
  if (scene.settings.rotation && (!atom->omega_flag || !atom->torque_flag))
    fail(lmp,
         COMMAND +
             ": keyword rotation: yes requires an atom style with angular velocity and torque, "
             "such as sphere");
  if (preconditioner.kind == Preconditioner::CLUMP && !atom->molecule_flag)
    fail(lmp, COMMAND + ": keyword precondition: 'clump' requires molecule IDs");
  if (scene.settings.clumps_only && !atom->molecule_flag)
    fail(lmp,
         COMMAND +
             ": keyword clumps_only: yes requires molecule IDs (atom_style hybrid sphere bond, or "
             "fix property/atom mol)");
  if (scene.all_pairs())
    for (int d = 0; d < domain->dimension; d++)
      if (domain->periodicity[d])
        fail(lmp,
             COMMAND +
                 ": keyword cut_off_distance: 'inf' requires a box that is not periodic, or "
                 "clumps_only yes");
  if (std::isfinite(scene.settings.cutoff)) refuse_vast_cutoff(lmp, COMMAND, scene.settings);

  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++)    // compute() complains of those that are not finite
    if (std::isfinite(atom->radius[i])) largest = std::max(largest, 2.0 * atom->radius[i]);
  MPI_Allreduce(&largest, &largest_diameter, 1, MPI_DOUBLE, MPI_MAX, world);

  region = nullptr;
  if (!region_id.empty() && !(region = Compat::region(domain, region_id)))
    fail(lmp, COMMAND + ": keyword region: region '" + region_id + "' does not exist");
  igroup = group->find(group_id);
  if (igroup < 0) fail(lmp, COMMAND + ": keyword group: group '" + group_id + "' does not exist");
  groupbit = group->bitmask[igroup];
  visc.init(lmp, COMMAND + ": keyword visc");
  for (auto &u : fluid_velocity) u.init(lmp, COMMAND + ": keyword fluid_velocity");
  for (auto &w : fluid_vorticity) w.init(lmp, COMMAND + ": keyword fluid_vorticity");

  // Here and not in the constructor: in read_restart, what the restart file holds for this fix is not known yet when the pair style is made.
  const bool rotation = scene.settings.rotation, history = algorithm == 2 && warm_start;
  if (find_state() &&
      (find_state()->rotation != rotation ||
       (find_state()->history < find_state()->columns) != history))
    modify->delete_fix(STATE_ID);
  if (!find_state())
    modify->add_fix(std::string(STATE_ID) + " all " + FixStokesDynamicsState::STYLE +
                    (rotation ? " rotation" : "") + (history ? " history" : ""));
  fix_state = find_state();
  fix_state->settings_are(hash(args));
  preconditioner.numbers = fix_state->global.preconditioner;

  bool applied = add_force;
  for (int i = 0; i < modify->nfix; i++)
    if (strcmp(modify->fix[i]->style, FixStokesDynamics::STYLE) == 0)
      applied = applied || static_cast<FixStokesDynamics *>(modify->fix[i])->applies(add_force);
  if (!applied && !warned_nobody_applies) {
    warned_nobody_applies = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     std::string(COMMAND +
                                 ": nothing applies the force: add_force is no and no fix "
                                 "stokes_dynamics applies it"));
  }
  sorting_bins.limit(range());
  scene.lists_are_stale();
  rigid.new_run();
  warned_unconverged = looked_at_clumps = false;
}

/* Without a cut-off this style needs no ghosts but those of clumps (Scene::check_clumps). A length is given to LAMMPS all the
 * same, since it warns of lost atoms and stops sorting them when there is none. */
double PairStokesDynamics::range() const
{
  return std::isfinite(scene.settings.cutoff) ? scene.settings.cutoff : largest_diameter;
}

double PairStokesDynamics::init_one(int i, int j)
{
  if (setflag[i][j] == 0) fail(lmp, COMMAND + ": pair_coeff * * is missing");
  return range();
}

void *PairStokesDynamics::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "visc") == 0 && !visc.is_variable()) return visc.address();
  return nullptr;
}

double PairStokesDynamics::memory_usage()
{
  return scene.memory_usage() +
      sizeof(double) *
      (double) (eta.capacity() + u_inf.capacity() + w_inf.capacity() + gradient.capacity() +
                slip.capacity() + drag.capacity() + spin.capacity() + solution.capacity() +
                work.capacity()) +
      rigid.memory_usage();
}

// --- restart -------------------------------------------------------------------------------------------------
// The words of the pair_style command, and the viscosity where fix adapt may have changed it.

static const int RESTART_FORMAT = 1;

void PairStokesDynamics::write_restart(FILE *fp)
{
  write_restart_settings(fp);
}

void PairStokesDynamics::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) setflag[i][j] = 1;
}

void PairStokesDynamics::write_restart_settings(FILE *fp)
{
  std::string all;
  for (const auto &word : args) all += word + '\n';
  const int size = all.size();
  const double eta_now = visc.number();
  fwrite(&RESTART_FORMAT, sizeof(int), 1, fp);
  fwrite(&eta_now, sizeof(double), 1, fp);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(all.data(), 1, size, fp);
}

void PairStokesDynamics::read_restart_settings(FILE *fp)
{
  int format = 0, size = 0;
  double eta_then = 0.0;
  const bool root = comm->me == 0;
  if (root) utils::sfread(FLERR, &format, sizeof(int), 1, fp, nullptr, error);
  MPI_Bcast(&format, 1, MPI_INT, 0, world);
  if (format != RESTART_FORMAT)
    fail(lmp,
         COMMAND + ": the restart file is of format " + std::to_string(format) +
             ", this version reads " + std::to_string(RESTART_FORMAT));
  if (root) {
    utils::sfread(FLERR, &eta_then, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &size, sizeof(int), 1, fp, nullptr, error);
  }
  MPI_Bcast(&eta_then, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&size, 1, MPI_INT, 0, world);
  std::string all(size, '\0');
  if (root && size) utils::sfread(FLERR, &all[0], 1, size, fp, nullptr, error);
  MPI_Bcast(&all[0], size, MPI_CHAR, 0, world);

  args.clear();
  for (size_t from = 0, to; (to = all.find('\n', from)) != std::string::npos; from = to + 1)
    args.push_back(all.substr(from, to - from));
  parse();
  if (!visc.is_variable()) *visc.address() = eta_then;
}
