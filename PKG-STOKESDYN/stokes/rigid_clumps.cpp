/* The shapes of rigid clumps: who has which, which are new, their resistances. The steps:
 * rigid_clumps_step.cpp. */
#include "rigid_clumps.h"

#include "keywords.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double SOLVE_MEMORY = 4e9;    // bytes that the solve of a shape may take

RigidClumps::RigidClumps(LAMMPS *lmp, Scene &scene, const std::string &command) :
    Pointers(lmp), scene(scene), command(command), shells()
{
}

RigidClumps::~RigidClumps()
{
  sd_shells_free(&shells);
}

RigidClumps::Shape::~Shape()
{
  sd_shape_free(&shape);
  sd_clump_free(&clump);
  sd_body_shape_free(&body);
}

void RigidClumps::forget()
{
  new_run();
  bodies.clear();
  by_size.clear();
  shapes.clear();
  solved = 0;
  sd_shells_free(&shells);
}

void RigidClumps::new_run()
{
  known.clear();
  loose_molecules.clear();
  recognised = false;
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
  recognised = false;
}

double RigidClumps::memory_usage() const
{
  double bytes = sizeof(double) * ((double) ghosts.capacity() + radius.capacity()) +
      sizeof(int) * ((double) member.capacity() + owned.capacity());
  for (const auto &s : shapes) bytes += 72.0 * sizeof(double) * s.second->shape.n;
  return bytes;
}

// --- which clump has which shape ---------------------------------------------------------------------

/* Positions [3n] and radii [n] of a clump's spheres in order of ID. */
void RigidClumps::geometry(const Scene::Clump &clump, std::vector<double> &x,
                           std::vector<double> &a) const
{
  x.clear();
  a.clear();
  for (int k = clump.begin; k < clump.end; k++) {
    const double *xk = atom->x[scene.member[k]];
    x.insert(x.end(), xk, xk + 3);
    a.push_back(radius[scene.member[k]]);
  }
}

static bool matches(const sd_shape &shape, const std::vector<double> &x, const std::vector<double> &a,
                    std::vector<int> &perm)
{
  const int n = a.size();
  std::vector<double> scratch(6 * a.size());
  perm.resize(n);
  return sd_shape_match(&shape, n, x.data(), a.data(), perm.data(), scratch.data());
}

/* The first of the shapes that spheres have, nullptr if there is none. */
const RigidClumps::Shape *RigidClumps::find(const BySize &among, const std::vector<double> &x,
                                            const std::vector<double> &a, std::vector<int> &perm)
{
  const double size = sd_shape_size(a.size(), x.data(), a.data());
  const double near = 2.01 * SD_SHAPE_TOLERANCE * size;
  const Shape *first = nullptr;
  for (auto s = among.lower_bound(size - near); s != among.end() && s->first <= size + near; ++s) {
    std::vector<int> order;
    if ((first && first->number < s->second->number) || !matches(s->second->shape, x, a, order))
      continue;
    first = s->second;
    perm.swap(order);
  }
  return first;
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
  fail(lmp,
       command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(molecule) +
           " is not rigid: its shape has changed by more than " + text(SD_SHAPE_TOLERANCE) +
           " of its size (rigid_clumps auto solves such clumps anew)");
}

/* From now on the solver has them. The same on all ranks. */
void RigidClumps::loosen(const std::vector<int64_t> &molecules)
{
  for (int64_t molecule : molecules) {
    loose_molecules.insert(molecule);
    known.erase(molecule);
  }
}

/* After a re-neighbouring: which shape has each clump of this rank? */
void RigidClumps::recognise()
{
  // Left of a solve that ended in an error, perhaps not on all ranks.
  for (auto s = by_size.begin(); s != by_size.end();)
    s = s->second->number > solved ? by_size.erase(s) : std::next(s);
  shapes.erase(shapes.upper_bound(solved), shapes.end());

  std::vector<size_t> unknown;
  std::vector<int64_t> changed;
  for (size_t c = 0; c < scene.clumps.size(); c++) {
    const auto &clump = scene.clumps[c];
    if (loose_molecules.count(clump.molecule)) continue;
    const auto found = known.find(clump.molecule);
    if (found == known.end())
      unknown.push_back(c);
    else if (found->second.atoms != atoms_of(clump))
      changed.push_back(clump.molecule);
  }
  int64_t count[3] = {(int64_t) unknown.size(), (int64_t) changed.size(), (int64_t) known.size()};
  MPI_Allreduce(MPI_IN_PLACE, count, 3, MPI_LMP_BIGINT, MPI_MAX, world);
  if (count[1]) {
    changed = from_all(world, changed);
    if (!settings.auto_resolve)
      fail(lmp,
           command + ": keyword rigid_clumps: the clump of molecule " +
               std::to_string(*std::min_element(changed.begin(), changed.end())) +
               " has gained or lost atoms, so it is not rigid (rigid_clumps auto solves such "
               "clumps anew)");
    loosen(changed);
  }
  if (count[0]) {
    const size_t before = shapes.size();
    std::vector<double> of_ghosts;
    scene.refresh_ghosts(of_ghosts, 1, [this](int i, double *out) { *out = atom->radius[i]; });
    radius.assign(atom->radius, atom->radius + atom->nlocal);
    radius.insert(radius.end(), of_ghosts.begin(), of_ghosts.end());
    if (count[2]) take_over(unknown);
    find_shapes(unknown);
    if (shapes.size() > before || !count[2]) drop_unused();
  }
  arrange();
}

uint64_t RigidClumps::atoms_of(const Scene::Clump &clump) const
{
  return hash_of(&scene.member_tag[clump.begin], clump.end - clump.begin);
}

/* Clumps that come from other ranks bring their shape along; taken off the unknown ones. */
void RigidClumps::take_over(std::vector<size_t> &unknown)
{
  struct Has {
    int64_t molecule;
    uint64_t atoms;
    int shape;
  };
  std::vector<int64_t> wanted, bent;
  for (size_t c : unknown) wanted.push_back(scene.clumps[c].molecule);
  std::vector<Has> have;
  for (int64_t molecule : from_all(world, wanted)) {
    const auto found = known.find(molecule);
    if (found != known.end()) have.push_back({molecule, found->second.atoms, found->second.shape->number});
  }
  std::map<int64_t, Has> elsewhere;
  for (const Has &has : from_all(world, have)) elsewhere[has.molecule] = has;

  std::vector<size_t> still_unknown;
  std::vector<double> x, a;
  for (size_t c : unknown) {
    const auto &clump = scene.clumps[c];
    const auto has = elsewhere.find(clump.molecule);
    if (has == elsewhere.end()) {
      still_unknown.push_back(c);
      continue;
    }
    Known &k = known[clump.molecule];
    k.shape = shapes.at(has->second.shape).get();
    k.atoms = atoms_of(clump);
    geometry(clump, x, a);
    if (k.atoms != has->second.atoms || !matches(k.shape->shape, x, a, k.perm))
      bent.push_back(clump.molecule);
  }
  unknown.swap(still_unknown);
  bent = from_all(world, bent);
  if (bent.empty()) return;
  if (!settings.auto_resolve) not_rigid(*std::min_element(bent.begin(), bent.end()));
  loosen(bent);
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
    return scene.clumps[p].molecule < scene.clumps[q].molecule;
  });
  std::vector<double> x, a;
  while (true) {
    std::vector<size_t> without;
    std::vector<double> candidates;
    std::vector<std::unique_ptr<Shape>> mine;
    BySize mine_by_size;
    for (size_t c : unknown) {
      const auto &clump = scene.clumps[c];
      std::vector<int> perm;
      geometry(clump, x, a);
      if (const Shape *shape = find(by_size, x, a, perm)) {
        known[clump.molecule] = {shape, atoms_of(clump), perm};
        continue;
      }
      without.push_back(c);
      if (find(mine_by_size, x, a, perm)) continue;
      mine.emplace_back(new Shape(0, clump.molecule));
      if (sd_shape_create(a.size(), x.data(), a.data(), &mine.back()->shape) == SD_OK)
        mine_by_size.insert({mine.back()->shape.size, mine.back().get()});
      candidates.push_back(ubuf(clump.molecule).d);
      candidates.push_back(a.size());
      candidates.insert(candidates.end(), x.begin(), x.end());
      candidates.insert(candidates.end(), a.begin(), a.end());
    }
    candidates = from_all(world, candidates);
    if (candidates.empty()) break;
    accept(candidates);
    unknown.swap(without);
  }
  solve();
}

/* The same on all ranks. */
void RigidClumps::accept(const std::vector<double> &candidates)
{
  std::map<int64_t, const double *> in_order;
  for (size_t k = 0; k < candidates.size(); k += 2 + 4 * (size_t) candidates[k + 1])
    in_order.insert({(int64_t) ubuf(candidates[k]).i, &candidates[k]});
  for (const auto &candidate : in_order) {
    const double *centres = candidate.second + 2, *end = centres + 3 * (size_t) centres[-1];
    const std::vector<double> x(centres, end), a(end, end + (size_t) centres[-1]);
    std::vector<int> perm;
    if (find(by_size, x, a, perm)) return;
    const int number = std::max(solved, shapes.empty() ? 0 : shapes.rbegin()->first) + 1;
    std::unique_ptr<Shape> shape(new Shape(number, candidate.first));
    const sd_status status = sd_shape_create(a.size(), x.data(), a.data(), &shape->shape);
    if (status != SD_OK) cannot_be_solved(*shape, status, 0.0);
    by_size.insert({shape->shape.size, shape.get()});
    shapes[number] = std::move(shape);
  }
}

/* Shapes that no clump has any more, on any rank. */
void RigidClumps::drop_unused()
{
  std::set<int> used;
  for (const auto &k : known) used.insert(k.second.shape->number);
  const std::vector<int> all = from_all(world, std::vector<int>(used.begin(), used.end()));
  used.insert(all.begin(), all.end());
  for (auto s = by_size.begin(); s != by_size.end();)
    s = used.count(s->second->number) ? std::next(s) : by_size.erase(s);
  for (auto s = shapes.begin(); s != shapes.end();)
    s = used.count(s->first) ? std::next(s) : shapes.erase(s);
}

/* The clumps as the steps want them; forgets those that have left this rank. */
void RigidClumps::arrange()
{
  std::map<int64_t, Known> here;
  arrangements++;
  bodies.clear();
  not_ours.clear();
  member.resize(scene.member.size());
  owned.resize(scene.member.size());
  int end = 0;
  for (const auto &clump : scene.clumps) {
    const auto found = known.find(clump.molecule);
    if (found == known.end()) {
      for (int k = clump.begin; k < clump.end; k++)
        if (scene.owned[k] >= 0) not_ours.push_back(scene.owned[k]);
      continue;
    }
    const Known &k = here[clump.molecule] = std::move(found->second);
    bodies.push_back({k.shape, clump.molecule, end, (int) k.perm.size()});
    for (int p : k.perm) {
      member[end] = scene.member[clump.begin + p];
      owned[end++] = scene.owned[clump.begin + p];
    }
  }
  known.swap(here);
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] == 0) not_ours.push_back(i);
}

// --- resistances ---------------------------------------------------------------------------------------------

namespace {
  struct Progress {
    FILE *screen;
    double last;
    std::string what;
  };

  void show_progress(void *ctx, int solve, int solves, int products)
  {
    Progress *p = static_cast<Progress *>(ctx);
    const double now = MPI_Wtime();
    if (!p->screen || now - p->last < 5.0) return;
    p->last = now;
    fprintf(p->screen, "  %s: solve %d of %d, iteration %d\n", p->what.c_str(), solve + 1, solves,
            products);
    fflush(p->screen);
  }
}    // namespace

void RigidClumps::cannot_be_solved(const Shape &s, sd_status status, double need) const
{
  const std::string who = command + ": keyword rigid_clumps: the clump of molecule " +
      std::to_string(s.molecule) + ", " + std::to_string(s.shape.n) + " spheres, shell " +
      std::to_string(settings.shell) + ": ";
  if (status == SD_ENOMEMORY)
    fail(lmp,
         who + "its resistance needs " + text(need / 1e9) + " GB, more than " +
             text(SOLVE_MEMORY / 1e9) + "; use a smaller shell");
  if (status == SD_ESINGULAR)
    fail(lmp, who + "two of its spheres of equal radius are at one point");
  fail(lmp, who + sd_status_string(status));
}

/* Resistances of the new shapes, shared out among the ranks. */
void RigidClumps::solve()
{
  struct Solved {
    sd_status status;
    double need, seconds;
  };
  std::map<int, Solved> results;
  int turn = 0;
  const auto first = shapes.upper_bound(solved);
  for (auto at = first; at != shapes.end(); ++at, turn++) {
    if (turn % comm->nprocs != comm->me) continue;
    Shape &s = *at->second;
    Progress progress = {screen, MPI_Wtime(),
                         "shape " + std::to_string(s.number) + ", the clump of molecule " +
                             std::to_string(s.molecule)};
    sd_clump_options options = SD_CLUMP_OPTIONS;
    options.shell = settings.shell;
    options.rotation = settings.rotation;
    options.memory = SOLVE_MEMORY;
    options.progress = show_progress;
    options.progress_ctx = &progress;
    sd_clump_need need = {};
    const double start = MPI_Wtime();
    const sd_status status = sd_clump_create(&s.shape, &options, &shells, &s.clump, &need);
    results[s.number] = {status, std::min(need.dense, need.iterative), MPI_Wtime() - start};
  }
  // Only now the ranks wait for each other.
  turn = 0;
  for (auto at = first; at != shapes.end(); ++at, turn++) {
    Shape &s = *at->second;
    const int root = turn % comm->nprocs;
    Solved r = results[s.number];
    MPI_Bcast(&r, sizeof(r), MPI_BYTE, root, world);
    if (r.status != SD_OK) cannot_be_solved(s, r.status, r.need);
    sd_clump clump = s.clump;
    MPI_Bcast(&clump, sizeof(clump), MPI_BYTE, root, world);
    const int size = 72 * s.shape.n;
    clump.table = comm->me == root ? s.clump.table : (double *) malloc(sizeof(double) * size);
    if (!clump.table) fail_one(lmp, command + ": keyword rigid_clumps: out of memory");
    s.clump = clump;
    MPI_Bcast(s.clump.table, size, MPI_DOUBLE, root, world);
    announce(s, r.seconds);
  }
  if (!shapes.empty()) solved = std::max(solved, shapes.rbegin()->first);
}

const sd_body_shape &RigidClumps::blocks(const Shape &s) const
{
  if (s.body.m > 0) return s.body;
  const sd_status status =
      sd_body_shape_create(&s.shape, settings.shell > 1 ? &s.clump : nullptr, &s.body);
  if (status == SD_OK) return s.body;
  fail_one(lmp,
           command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(s.molecule) +
               ", " + std::to_string(s.shape.n) + " spheres: " + sd_status_string(status));
}

void RigidClumps::announce(const Shape &s, double seconds) const
{
  if (comm->me != 0) return;
  const sd_clump &c = s.clump;
  std::string out = "Rigid clumps, shape " + std::to_string(s.number) + " (molecule " +
      std::to_string(s.molecule) + "): " + std::to_string(s.shape.n) + " spheres, " +
      std::to_string(c.points) + " points, hydrodynamic radius " + text(c.radius) + ", solved in " +
      text(seconds) + " s" +
      (c.iterations ? ", " + std::to_string(c.iterations) + " iterations" : "") + "\n";
  out += "  centre of hydrodynamic stress, from the centroid of centres:";
  for (double d : c.centre) out += " " + text(fabs(d) < 1e-12 * s.shape.size ? 0.0 : d);
  out += "\n  resistance about it over viscosity, force and torque from velocity and angular "
         "velocity:\n";
  for (int p = 0; p < 6; p++) {
    out += "   ";
    for (int q = 0; q < 6; q++) {
      const double r = c.R_centre[6 * p + q];
      const double rounding = 1e-12 * sqrt(c.R_centre[7 * p] * c.R_centre[7 * q]);
      char number_text[24];
      snprintf(number_text, sizeof(number_text), " %13.6g", fabs(r) <= rounding ? 0.0 : r);
      out += number_text;
    }
    out += "\n";
  }
  utils::logmesg(lmp, out);
}

}    // namespace StokesDyn
