#include "rigid_clumps.h"

#include "fixes.h"
#include "keywords.h"
#include "ranks.h"

#include "atom.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;

namespace StokesDyn {

RigidClumps::RigidClumps(const Voice &voice, WholeClumps &whole, const Epochs &epochs,
                         const Settings &settings) :
    Pointers(voice.lmp), settings(settings), shapes(voice), whole(whole), voice(voice), epochs(epochs)
{
}

void RigidClumps::forget()
{
  new_run();
  members_in_file.clear();
  bodies.clear();
  shapes.clear();
}

void RigidClumps::new_run()
{
  known.clear();
  loose_molecules.clear();
  recognised.never();
}

std::vector<double> RigidClumps::loose() const
{
  std::vector<double> ids;    // in halves, which a double holds exactly
  for (int64_t id : loose_molecules) {
    ids.push_back((double) (id >> 32));
    ids.push_back((double) (id & 0xffffffff));
  }
  return ids;
}

void RigidClumps::set_loose(const std::vector<double> &ids)
{
  loose_molecules.clear();
  for (size_t k = 0; k + 1 < ids.size(); k += 2)
    loose_molecules.insert((int64_t) ids[k] * 4294967296 + (int64_t) ids[k + 1]);
  recognised.never();
}

void RigidClumps::set_members(const std::vector<double> &numbers)
{
  if (numbers.empty()) return;
  atoms_in_file = (bigint) numbers[0];
  for (size_t k = 1; k + 2 < numbers.size(); k += 3)
    members_in_file[(int64_t) numbers[k] * 4294967296 + (int64_t) numbers[k + 1]] = (int) numbers[k + 2];
  recognised.never();
}

double RigidClumps::memory_usage() const
{
  return sizeof(double) * (double) radius.capacity() + sizeof(int) * (double) member.capacity() + shapes.memory_usage();
}

// --- which clump has which shape ---------------------------------------------------------------------

/* Of a clump's spheres in order of ID. */
ClumpGeometry RigidClumps::geometry(const WholeClumps::Clump &clump) const
{
  ClumpGeometry g;
  for (int k = clump.begin; k < clump.end; k++) {
    g.x.insert(g.x.end(), &whole.x[3 * (size_t) k], &whole.x[3 * (size_t) k] + 3);
    g.a.push_back(radius[k]);
  }
  return g;
}

/* A clump is known as long as its atoms are the same. */
static uint64_t hash_of(const int64_t *tags, int n)
{
  uint64_t h = 14695981039346656037u;    // FNV-1a, by words
  for (int k = 0; k < n; k++) h = (h ^ (uint64_t) tags[k]) * 1099511628211u;
  return h;
}

void RigidClumps::not_rigid(int64_t molecule) const
{
  voice.fail("keyword rigid_clumps: the clump of molecule " + std::to_string(molecule) +
             " is not rigid: its shape has changed by more than " + text(SD_SHAPE_TOLERANCE) +
             " of its size (" +
             (must_stay_rigid() ? "fix stokes_dynamics/overdamped keeps clumps rigid, so another command "
                                  "moves their atoms or changes radii: take it away"
                                : "does no fix rigid/small hold it together, or is the time step too long? "
                                  "rigid_clumps auto is for clumps that bend") + ")");
}

/* LAMMPS deletes atoms that it finds outside of a box with fixed faces, and looks for lost ones only
 * when it writes thermo output. */
void RigidClumps::other_atoms(int64_t molecule) const
{
  const bigint lost = atom->natoms - sum_of_all(world, (bigint) atom->nlocal);
  const bool fixed = std::count(&domain->boundary[0][0], &domain->boundary[0][0] + 6, 1) > 0;
  if (lost > 0 && fixed)
    voice.fail("keyword rigid_clumps: the clump of molecule " + std::to_string(molecule) +
               " has lost atoms that left the box: use boundary m or s, whose faces follow the atoms, "
               "in place of f, or a larger box");
  if (lost > 0)
    voice.fail("keyword rigid_clumps: the clump of molecule " + std::to_string(molecule) +
               " has lost atoms: they have moved too far in a step; is the time step too long?");
  voice.fail("keyword rigid_clumps: the clump of molecule " + std::to_string(molecule) +
             " has gained or lost atoms, so it is not rigid (" +
             (must_stay_rigid() ? "delete and add atoms by whole molecules"
                                : "rigid_clumps auto solves such clumps anew") + ")");
}

/* Then the solver cannot have clumps that are not. */
bool RigidClumps::must_stay_rigid() const
{
  return fix_like(lmp, "^stokes_dynamics/overdamped$");
}

/* From now on the solver has them. The same on all ranks. */
void RigidClumps::loosen(const std::vector<int64_t> &molecules)
{
  for (int64_t molecule : molecules) {
    loose_molecules.insert(molecule);
    known.erase(molecule);
  }
}

/* Clumps, of any rank, that are not what they were: an error that tells of the first, or auto has them. */
void RigidClumps::let_go(const std::vector<int64_t> &mine, void (RigidClumps::*tell)(int64_t) const)
{
  const std::vector<int64_t> molecules = from_all(world, mine);
  if (molecules.empty()) return;
  if (!settings.auto_resolve) (this->*tell)(*std::min_element(molecules.begin(), molecules.end()));
  loosen(molecules);
}

/* After a re-neighbouring: which shape has each clump of this rank? */
void RigidClumps::recognise()
{
  shapes.drop_unsolved();
  std::vector<size_t> unknown;
  std::vector<int64_t> changed = smaller_than_in_file();
  for (size_t c = 0; c < whole.clumps.size(); c++) {
    const auto &clump = whole.clumps[c];
    if (loose_molecules.count(clump.molecule)) continue;
    const auto found = known.find(clump.molecule);
    if (found == known.end())
      unknown.push_back(c);
    else if (found->second.atoms != atoms_of(clump))
      changed.push_back(clump.molecule);
  }
  int64_t count[3] = {(int64_t) unknown.size(), (int64_t) changed.size(), (int64_t) known.size()};
  MPI_Allreduce(MPI_IN_PLACE, count, 3, MPI_LMP_BIGINT, MPI_MAX, world);
  if (count[1]) let_go(changed, &RigidClumps::other_atoms);
  if (count[0]) {
    const size_t before = shapes.count();
    radius = whole.gather(1, [this](int i, double *out) { *out = atom->radius[i]; });
    if (count[2]) take_over(unknown);
    find_shapes(unknown);
    if (shapes.count() > before || !count[2]) drop_unused();
  }
  arrange();
}

/* If atoms have been deleted since the restart file was written, and the motion without inertia goes on from it:
 * molecules of this rank that have fewer than they had */
std::vector<int64_t> RigidClumps::smaller_than_in_file()
{
  std::vector<int64_t> smaller;
  const bool deleted = atom->natoms < atoms_in_file && must_stay_rigid();
  for (const auto &clump : whole.clumps) {
    const auto before = members_in_file.find(clump.molecule);
    if (deleted && before != members_in_file.end() && clump.end - clump.begin < before->second)
      smaller.push_back(clump.molecule);
  }
  members_in_file.clear();
  return smaller;
}

uint64_t RigidClumps::atoms_of(const WholeClumps::Clump &clump) const
{
  return hash_of(&whole.tag[clump.begin], clump.end - clump.begin);
}

/* Clumps that come from other ranks bring their shape along; taken off the unknown ones. */
void RigidClumps::take_over(std::vector<size_t> &unknown)
{
  struct Has {
    int64_t molecule;
    uint64_t atoms;
    int shape;
  };
  std::vector<int64_t> wanted, changed, bent;
  for (size_t c : unknown) wanted.push_back(whole.clumps[c].molecule);
  std::vector<Has> have;
  for (int64_t molecule : from_all(world, wanted)) {
    const auto found = known.find(molecule);
    if (found != known.end())
      have.push_back({molecule, found->second.atoms, found->second.shape->number});
  }
  std::map<int64_t, Has> elsewhere;
  for (const Has &has : from_all(world, have)) elsewhere[has.molecule] = has;

  std::vector<size_t> still_unknown;
  for (size_t c : unknown) {
    const auto &clump = whole.clumps[c];
    const auto has = elsewhere.find(clump.molecule);
    if (has == elsewhere.end()) {
      still_unknown.push_back(c);
      continue;
    }
    Known &k = known[clump.molecule];
    k.shape = shapes.at(has->second.shape);
    k.atoms = atoms_of(clump);
    if (k.atoms != has->second.atoms)
      changed.push_back(clump.molecule);
    else if (!ClumpShapes::fits(k.shape->shape, geometry(clump), k.perm))
      bent.push_back(clump.molecule);
  }
  unknown.swap(still_unknown);
  let_go(changed, &RigidClumps::other_atoms);
  let_go(bent, &RigidClumps::not_rigid);
}

/* Shapes for clumps that have been nowhere yet; new ones where none of the present shapes fits.
 * Going through all clumps of the scene in order of molecule ID, one that has none of the shapes
 * before it shows a new one: so the shapes do not depend on where the clumps are. Each rank goes
 * through its own, on the assumption that there are no others. Of all that they find, the ones up
 * to the first that proves to be another rank's shape are right; then the rest is looked at
 * again. */
void RigidClumps::find_shapes(std::vector<size_t> unknown)
{
  std::sort(unknown.begin(), unknown.end(), [this](size_t p, size_t q) {
    return whole.clumps[p].molecule < whole.clumps[q].molecule;
  });
  while (true) {
    std::vector<size_t> without;
    std::vector<double> candidates;
    ClumpShapes mine(voice);
    for (size_t c : unknown) {
      const auto &clump = whole.clumps[c];
      const ClumpGeometry g = geometry(clump);
      std::vector<int> perm;
      if (const ClumpShape *shape = shapes.find(g, perm)) {
        known[clump.molecule] = {shape, atoms_of(clump), perm};
        continue;
      }
      without.push_back(c);
      if (mine.find(g, perm)) continue;
      mine.add(clump.molecule, g);    // one that cannot be made ends the run in accept()
      candidates.push_back(ubuf(clump.molecule).d);
      candidates.push_back(g.n());
      candidates.insert(candidates.end(), g.x.begin(), g.x.end());
      candidates.insert(candidates.end(), g.a.begin(), g.a.end());
    }
    candidates = from_all(world, candidates);
    if (candidates.empty()) break;
    accept(candidates);
    unknown.swap(without);
  }
  shapes.solve(settings);
}

/* The same on all ranks. */
void RigidClumps::accept(const std::vector<double> &candidates)
{
  std::map<int64_t, const double *> in_order;
  for (size_t k = 0; k < candidates.size(); k += 2 + 4 * (size_t) candidates[k + 1])
    in_order.insert({(int64_t) ubuf(candidates[k]).i, &candidates[k]});
  for (const auto &candidate : in_order) {
    const double *centres = candidate.second + 2, *end = centres + 3 * (size_t) centres[-1];
    const ClumpGeometry g = {{centres, end}, {end, end + (size_t) centres[-1]}};
    std::vector<int> perm;
    if (shapes.find(g, perm)) return;
    const sd_status status = shapes.add(candidate.first, g);
    if (status == SD_ENOMEMORY)    // of this rank alone
      voice.fail_one("keyword rigid_clumps: out of memory");
    if (status != SD_OK) shapes.cannot_be_solved(candidate.first, g.n(), settings, status);
  }
}

/* Shapes that no clump has any more, on any rank. */
void RigidClumps::drop_unused()
{
  std::set<int> used;
  for (const auto &k : known) used.insert(k.second.shape->number);
  const std::vector<int> all = from_all(world, std::vector<int>(used.begin(), used.end()));
  used.insert(all.begin(), all.end());
  shapes.keep(used);
}

/* The clumps as the steps want them; forgets those that have left this rank. */
void RigidClumps::arrange()
{
  std::map<int64_t, Known> here;
  bodies.clear();
  member.clear();
  for (const auto &clump : whole.clumps) {
    const auto found = known.find(clump.molecule);
    if (found == known.end()) continue;
    const Known &k = here[clump.molecule] = std::move(found->second);
    bodies.push_back({k.shape, clump.molecule, (int) member.size(), (int) k.perm.size(),
                      whole.first_atom(clump)});
    for (int p : k.perm) member.push_back(clump.begin + p);
  }
  known.swap(here);
  place.assign(whole.size(), -1);
  for (size_t k = 0; k < member.size(); k++) place[member[k]] = (int) k;
}

// --- as they stand now ------------------------------------------------------------------------------

const std::vector<RigidClumps::OwnClump> &RigidClumps::find()
{
  if (!recognised.is(epochs.members)) recognise();
  recognised.set(epochs.members);
  return bodies;
}

bool RigidClumps::fits(const OwnClump &body, const double *radii, const double *x, double *pose) const
{
  const sd_shape &shape = body.shape->shape;
  const double most = SD_SHAPE_TOLERANCE * shape.size;
  for (int k = 0; k < body.n; k++)
    if (!(std::fabs(radii[k] - shape.a[k]) <= most)) return false;
  return sd_shape_pose(&shape, x, pose, pose + 9) <= most;
}

bool RigidClumps::loosen(int64_t split, const std::vector<int64_t> &bent)
{
  int64_t first[2] = {split, NOBODY};
  for (int64_t molecule : bent) first[1] = std::min(first[1], molecule);
  MPI_Allreduce(MPI_IN_PLACE, first, 2, MPI_LMP_BIGINT, MPI_MIN, world);
  if (first[0] != NOBODY)
    voice.fail("keyword rigid_clumps: the clump of molecule " + std::to_string(first[0]) +
               " is split by the keyword group or region: all of its spheres must be selected, or "
               "none");
  if (first[1] == NOBODY) return false;
  if (!settings.auto_resolve) not_rigid(first[1]);
  loosen(from_all(world, bent));
  arrange();
  return true;
}

}    // namespace StokesDyn
