#include "fix_stokes_dynamics_state.h"

#include "copy.h"
#include "lammps_compat.h"
#include "own_fix.h"
#include "ranks.h"
#include "settings.h"

#include "sd_linear.h"

#include "atom.h"
#include "domain.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static OwnFix memory_of(LAMMPS *lmp)
{
  return {Voice(lmp, "Pair style stokes_dynamics"), FixStokesDynamicsState::ID, FixStokesDynamicsState::STYLE};
}

FixStokesDynamicsState *FixStokesDynamicsState::find(LAMMPS *lmp)
{
  return static_cast<FixStokesDynamicsState *>(memory_of(lmp).find());
}

void FixStokesDynamicsState::take_away(LAMMPS *lmp)
{
  memory_of(lmp).take_away();
}

FixStokesDynamicsState *FixStokesDynamicsState::provide(LAMMPS *lmp, const StokesSettings &settings)
{
  const Shells::Settings &shells = settings.shells;
  const int points = shells.on() && settings.warm_start ? shells.points : 0;
  const int numbers[] = {settings.scene.rotation, settings.history(), settings.lines(), points,
                         points > 0 && !shells.alike() ? shells.most : 0};
  FixStokesDynamicsState *fix = find(lmp);
  if (fix && fix->rotation == numbers[0] && fix->history == numbers[1] && fix->lines == numbers[2] &&
      fix->shell_points == numbers[3] && fix->most_points == numbers[4])
    return fix;
  std::string words;
  for (int of : numbers) words += std::to_string(of) + " ";
  return static_cast<FixStokesDynamicsState *>(memory_of(lmp).make(words));
}

static int number(int narg, char **arg, int k)
{
  return narg > k ? atoi(arg[k]) : 0;
}

FixStokesDynamicsState::FixStokesDynamicsState(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), rotation(number(narg, arg, 3)), history(number(narg, arg, 4)),
    lines(number(narg, arg, 5)), shell_points(number(narg, arg, 6)), most_points(number(narg, arg, 7)),
    rows(shell_points > 0 ? velocities_before() + 6 : of_points()),
    made_at(3), larger{AtomRows(6 * 42), AtomRows(6 * 162), AtomRows(6 * 642)},
    resume(lmp, rotation), left(resume.columns())
{
  restart_global = 1;
  std::vector<RowsOfAtoms *> all = {&rows, &made_at, &left}, moving;
  if (has_larger()) moving = {&larger[0], &larger[1], &larger[2]};
  keep(all, nullptr, true, NO_BORDERS, moving);
}

void FixStokesDynamicsState::made_here(const std::vector<int> &who, const std::vector<double> &of)
{
  global.made_of = of;
  for (int i : who) copy<3>(atom->x[i], made_at.writable(i));
}

void FixStokesDynamicsState::from_made(int i, double d[3]) const
{
  sd_minus(atom->x[i], made_at[i], d);
  Compat::minimum_image(domain, d);
}

bool FixStokesDynamicsState::moved_since_made(const std::vector<int> &who, double sums[SD_MOVED]) const
{
  double all[SD_MOVED + 1] = {0.0}, d[3];
  for (int i : who) {
    all[SD_MOVED] += !made_at.has(i);
    from_made(i, d);
    sd_moved_add(all, d, atom->radius[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, all, SD_MOVED + 1, MPI_DOUBLE, MPI_SUM, world);
  copy<SD_MOVED>(all, sums);
  return all[SD_MOVED] == 0.0;
}

int FixStokesDynamicsState::setmask()
{
  return FixConst::PRE_REVERSE;
}

/* The forces of the step stand in the atoms, but for those of fixes. */
void FixStokesDynamicsState::pre_reverse(int, int vflag)
{
  if (!vflag || !atom->torque_flag) return;
  std::fill_n(of_pairs, 3, 0.0);
  const int n = atom->nlocal + (force->newton ? atom->nghost : 0);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) of_pairs[d] += atom->torque[i][d];
}

void FixStokesDynamicsState::erase(int i)
{
  rows.erase(i);
  made_at.erase(i);
  for (AtomRows &of : larger)
    if (has_larger()) of.erase(i);
}

/* Whose rows those of a shell of so many points are among `larger` */
static int place_of(int n)
{
  return n == 42 ? 0 : n == 162 ? 1 : 2;
}

FixStokesDynamicsState::OfPoints<double> FixStokesDynamicsState::writable_points(int i, int kind, int n)
{
  double *smallest = rows.writable(i);    // of all that take part
  if (kind == 0) return {smallest + of_points(), smallest + of_points_before()};
  if (!has_larger()) return {nullptr, nullptr};
  double *row = larger[place_of(n)].writable(i);
  return {row, row + 3 * n};
}

FixStokesDynamicsState::OfPoints<const double> FixStokesDynamicsState::points_of(int i, int kind,
                                                                                 int n) const
{
  if (kind == 0) return {rows[i] + of_points(), rows[i] + of_points_before()};
  if (!has_larger() || !larger[place_of(n)].has(i)) return {nullptr, nullptr};
  return {larger[place_of(n)][i], larger[place_of(n)][i] + 3 * n};
}

void FixStokesDynamicsState::forget()
{
  const Global old = global;
  global = Global();
  global.solves = old.solves;
  global.unconverged = old.unconverged;
  global.time_before = old.time_before;
  rows.clear();
  for (AtomRows &of : larger) of.clear();
  made_at.clear();
  left.clear();
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

void FixStokesDynamicsState::settings_are(const std::vector<std::string> &words)
{
  const uint64_t now = hash(words);
  if (now != global.settings) forget();
  global.settings = now;
}

static double lammps_time(const Update *update)
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

double FixStokesDynamicsState::time() const
{
  return global.time_before + lammps_time(update);
}

void FixStokesDynamicsState::present_box(double *box) const
{
  const double tilt[3] = {domain->yz, domain->xz, domain->xy};
  for (int d = 0; d < 3; d++) {
    box[d] = domain->periodicity[d] ? domain->prd[d] : 0.0;
    box[3 + d] = domain->triclinic ? tilt[d] : 0.0;
  }
}

bool FixStokesDynamicsState::box_left_as_is() const
{
  double box[6];
  present_box(box);
  return memcmp(box, global.box, sizeof(box)) == 0;
}

void FixStokesDynamicsState::record(int i)
{
  if (rows.has(i))
    resume.record(i, left.writable(i));
  else
    left.erase(i);
}

void FixStokesDynamicsState::post_run()
{
  for (int i = 0; i < atom->nlocal; i++) record(i);
  present_box(global.box);
}

// --- restart ---------------------------------------------------------------------------------

std::vector<SavedNumbers> FixStokesDynamicsState::saved()
{
  Global &g = global;
  return {{"last_step", &g.last_step},
          {"last_solve", &g.last_solve},
          {"reported", &g.reported},
          {"spheres", &g.spheres},
          {"solves", &g.solves},
          {"unconverged", &g.unconverged},
          {"diverged", &g.diverged},
          {"iterations", &g.iterations},
          {"residual", &g.residual},
          {"solutions", &g.solutions},
          {"line", &g.line},
          {"lambda_min", &g.guard.lambda_min},
          {"guard_due", &g.guard.due},
          {"dt_limit", &g.guard.limit},
          {"smallest_radius", &g.shells.smallest},
          {"unlike_shells", &g.shells.unlike},
          {"numbers", g.numbers, Ambient::NUMBERS},
          {"box", g.box, 6}};
}

/* ID, kind, and the rows of larger spheres, one after the other, those of all ranks: these are few, and in
 * the rows of a file every atom would take as much as the largest. */
std::vector<double> FixStokesDynamicsState::of_larger_spheres() const
{
  std::vector<double> mine;
  for (int kind = 0; kind < 3 && has_larger(); kind++)
    for (int i = 0; i < atom->nlocal; i++) {
      if (!larger[kind].has(i)) continue;
      mine.insert(mine.end(), {(double) atom->tag[i], (double) kind});
      mine.insert(mine.end(), larger[kind][i], larger[kind][i] + larger[kind].columns());
    }
  return from_all(world, mine);
}

void FixStokesDynamicsState::set_larger_spheres(const std::vector<double> &all)
{
  std::unordered_map<tagint, int> here;
  if (!has_larger() || all.empty()) return;
  for (int i = 0; i < atom->nlocal; i++) here[atom->tag[i]] = i;
  for (size_t at = 0; at + 2 < all.size();) {
    AtomRows &of = larger[(int) all[at + 1]];
    const auto found = here.find((tagint) all[at]);
    if (found != here.end()) std::copy_n(&all[at + 2], of.columns(), of.writable(found->second));
    at += 2 + of.columns();
  }
}

/* All atoms; molecule IDs, as two halves that doubles hold, and their atoms on all ranks */
std::vector<double> FixStokesDynamicsState::members_now() const
{
  if (!rigid) return {};
  struct Part {
    int64_t molecule, atoms;
  };
  std::map<int64_t, int64_t> here, all;
  std::vector<Part> mine;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] != 0) here[atom->molecule[i]]++;
  for (const auto &of : here) mine.push_back({of.first, of.second});
  for (const Part &part : from_all(world, mine)) all[part.molecule] += part.atoms;
  std::vector<double> numbers = {(double) atom->natoms};
  for (const auto &of : all)
    numbers.insert(numbers.end(), {(double) (of.first >> 32), (double) (of.first & 0xffffffff), (double) of.second});
  return numbers;
}

void FixStokesDynamicsState::write_state(NamedState &out)
{
  if (within_run()) present_box(global.box);
  out.put("time", time());
  out.put("places_box", global.made_of);
  out.put("loose", global.loose);
  out.put("members", members_now());
  out.put("open_box", global.open_box);
  out.put("in_axes_of_shells", 1.0);
  out.put("forces_before", lines);
  out.put("larger_spheres", of_larger_spheres());
  out.put_bits("settings", global.settings);
  out.put_bits("guess", global.guess);
}

void FixStokesDynamicsState::read_state(const NamedState &in)
{
  global.time_before = in.get("time", time()) - lammps_time(update);
  global.made_of = in.get("places_box");
  global.loose = in.get("loose");
  global.members = in.get("members");
  global.open_box = in.get("open_box");
  global.settings = in.get_bits("settings", 0);
  global.guess = in.get_bits("guess", 0);
  set_larger_spheres(in.get("larger_spheres"));
  const bool in_space = shell_points > 0 && in.get("in_axes_of_shells", 0.0) == 0.0;
  const bool shorter = lines && in.get("forces_before", 0.0) == 0.0;
  if (!in_space && !shorter) return;    // else it is of a version that kept other numbers
  global.last_step = -1;
  global.guess = 0;
}
