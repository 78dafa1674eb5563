#include "rigid_clumps.h"

#include "keywords.h"

#include "sd_linear.h"

#include "atom.h"
#include "comm.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double SOLVE_MEMORY = 4e9;    // bytes that the solve of a shape may take

RigidClumps::RigidClumps(LAMMPS *lmp, Scene &scene, const std::string &command) :
    Pointers(lmp), scene(scene), command(command), shells()
{
}

RigidClumps::~RigidClumps()
{
  forget();
}

void RigidClumps::forget()
{
  for (auto &s : shapes) {
    sd_shape_free(&s.shape);
    sd_clump_free(&s.clump);
  }
  shapes.clear();
  sd_shells_free(&shells);
  new_run();
}

void RigidClumps::new_run()
{
  known.clear();
  of_clump.clear();
  loose_molecules.clear();
}

double RigidClumps::memory_usage() const
{
  double bytes = sizeof(double) *
      ((double) ghosts.capacity() + radius.capacity() + x.capacity() + F.capacity() + T.capacity());
  for (const auto &s : shapes) bytes += 72.0 * sizeof(double) * s.shape.n;
  return bytes;
}

// --- shapes ----------------------------------------------------------------------------------------------------

std::vector<double> RigidClumps::from_all_ranks(const std::vector<double> &mine, MPI_Comm world)
{
  int nprocs, n = 0, size = mine.size();
  MPI_Comm_size(world, &nprocs);
  std::vector<int> counts(nprocs), at(nprocs);
  MPI_Allgather(&size, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 0; p < nprocs; p++) {
    at[p] = n;
    n += counts[p];
  }
  std::vector<double> all(n + 1);
  MPI_Allgatherv(const_cast<double *>(mine.data()), size, MPI_DOUBLE, all.data(), counts.data(),
                 at.data(), MPI_DOUBLE, world);
  all.resize(n);
  return all;
}

/* Positions [3n] and radii [n] of a clump's spheres in order of tag. */
void RigidClumps::geometry(const Scene::Clump &clump, std::vector<double> &centres,
                           std::vector<double> &radii) const
{
  centres.clear();
  radii.clear();
  for (int k = clump.begin; k < clump.end; k++) {
    const double *xk = atom->x[scene.member[k]];
    centres.insert(centres.end(), xk, xk + 3);
    radii.push_back(radius[scene.member[k]]);
  }
}

/* After a re-neighbouring: which shape has each clump of this rank? */
void RigidClumps::recognise()
{
  std::vector<size_t> unknown;
  int64_t other_spheres = 0;
  for (size_t c = 0; c < scene.clumps.size(); c++) {
    const auto &clump = scene.clumps[c];
    const int64_t *tags = &scene.member_tag[clump.begin];
    const auto found = known.find(clump.molecule);
    if (found == known.end())
      unknown.push_back(c);
    else if (found->second.tag.size() != (size_t) (clump.end - clump.begin) ||
             !std::equal(found->second.tag.begin(), found->second.tag.end(), tags))
      other_spheres = std::max(other_spheres, clump.molecule);
  }
  int64_t mine[2] = {(int64_t) unknown.size(), other_spheres}, any[2];
  MPI_Allreduce(mine, any, 2, MPI_LMP_BIGINT, MPI_MAX, world);
  if (any[1] && !settings.auto_resolve)
    fail(lmp,
         command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(any[1]) +
             " has gained or lost atoms, so it is not rigid (rigid_clumps auto solves such clumps "
             "anew)");
  if (any[1]) {
    std::vector<double> changed;
    if (other_spheres) changed.push_back(other_spheres);
    for (double molecule : from_all_ranks(changed, world)) {
      loose_molecules.insert((int64_t) molecule);
      known.erase((int64_t) molecule);
    }
    recognise();    // one molecule a rank and round: this hardly ever happens
    return;
  }
  if (any[0]) {
    radius.assign(atom->radius, atom->radius + atom->nlocal);
    scene.refresh(radius, 1);
    add_shapes(unknown);
    match(unknown);
  }
  of_clump.clear();
  for (const auto &clump : scene.clumps) of_clump.push_back(&known[clump.molecule]);
}

/* The shapes that are new in the whole scene, in order of the molecule that shows them first. */
void RigidClumps::add_shapes(const std::vector<size_t> &unknown)
{
  std::vector<double> centres, radii, mine;
  std::vector<int> perm;
  std::vector<double> scratch;
  std::vector<sd_shape> seen;    // by this rank, in this call
  std::vector<size_t> sorted(unknown);
  std::sort(sorted.begin(), sorted.end(), [this](size_t p, size_t q) {
    return scene.clumps[p].molecule < scene.clumps[q].molecule;
  });

  auto matches = [&](const sd_shape &shape, int n, const double *c, const double *r) {
    perm.resize(n);
    scratch.resize(6 * (size_t) n);
    return shape.n == n && sd_shape_match(&shape, n, c, r, perm.data(), scratch.data());
  };
  for (size_t c : sorted) {
    const auto &clump = scene.clumps[c];
    if (loose_molecules.count(clump.molecule)) continue;
    geometry(clump, centres, radii);
    const int n = radii.size();
    bool is_known = false;
    for (const auto &s : shapes)
      is_known = is_known || matches(s.shape, n, centres.data(), radii.data());
    for (const auto &s : seen) is_known = is_known || matches(s, n, centres.data(), radii.data());
    if (is_known) continue;
    sd_shape shape;
    if (sd_shape_create(n, centres.data(), radii.data(), &shape) != SD_OK)
      continue;    // add_shape complains
    seen.push_back(shape);
    mine.push_back(clump.molecule);
    mine.push_back(n);
    mine.insert(mine.end(), centres.begin(), centres.end());
    mine.insert(mine.end(), radii.begin(), radii.end());
  }
  for (auto &s : seen) sd_shape_free(&s);

  const std::vector<double> all = from_all_ranks(mine, world);
  std::map<int64_t, const double *> candidates;
  for (size_t k = 0; k < all.size(); k += 2 + 4 * (size_t) all[k + 1])
    candidates[(int64_t) all[k]] = &all[k];
  const size_t before = shapes.size();
  for (const auto &candidate : candidates) {
    const int n = candidate.second[1];
    const double *c = candidate.second + 2, *r = c + 3 * (size_t) n;
    bool is_known = false;
    for (const auto &s : shapes) is_known = is_known || matches(s.shape, n, c, r);
    if (is_known) continue;
    Shape shape = {};
    shape.molecule = candidate.first;
    const sd_status status = sd_shape_create(n, c, r, &shape.shape);
    if (status != SD_OK)
      fail(lmp,
           command + ": keyword rigid_clumps: the clump of molecule " +
               std::to_string(candidate.first) + ": " + sd_status_string(status));
    prepare(shape);
    shapes.push_back(shape);
  }
  solve(before);
}

/* Pseudo-inverse of a symmetric 3x3 matrix that is as large as size. */
static void pseudo_inverse3(const double A[9], double size, double inverse[9])
{
  double w[3], V[9];
  sd_eigen(3, A, w, V);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      inverse[3 * p + q] = 0.0;
      for (int k = 0; k < 3; k++)
        if (w[k] > 1e-10 * size) inverse[3 * p + q] += V[3 * p + k] * V[3 * q + k] / w[k];
    }
}

/* What the least-squares fits of a motion need. */
void RigidClumps::prepare(Shape &s)
{
  double xx[9] = {0.0}, inertia[9], w[3], V[9];
  for (int k = 0; k < s.shape.n; k++)
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) xx[3 * p + q] += s.shape.x[3 * k + p] * s.shape.x[3 * k + q];
  const double trace = xx[0] + xx[4] + xx[8];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) inertia[3 * p + q] = (p == q ? trace : 0.0) - xx[3 * p + q];
  // Centres on a line or a plane span no volume: what they cannot tell is left out of the fit.
  const double size = s.shape.rank == 0 ? INFINITY : trace;
  pseudo_inverse3(xx, size, s.gradient_inverse);
  pseudo_inverse3(inertia, size, s.spin_inverse);
  sd_eigen(3, xx, w, V);
  for (int p = 0; p < 3; p++) s.axis[p] = V[3 * p];
}

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
    fprintf(p->screen, "  %s: solve %d of 12, iteration %d\n", p->what.c_str(), solve + 1,
            products);
    fflush(p->screen);
  }
}    // namespace

/* Resistances of the shapes from number `first` on, shared out among the ranks. */
void RigidClumps::solve(size_t first)
{
  for (size_t k = first; k < shapes.size(); k++) {
    Shape &s = shapes[k];
    const int root = (k - first) % comm->nprocs;
    const std::string name =
        "shape " + std::to_string(k + 1) + ", the clump of molecule " + std::to_string(s.molecule);
    Solved result = {root, 0.0, 0.0, 0.0};
    if (comm->me == root) {
      Progress progress = {screen, MPI_Wtime(), name};
      sd_clump_options options = SD_CLUMP_OPTIONS;
      options.shell = settings.shell;
      options.rotation = settings.rotation;
      options.memory = SOLVE_MEMORY;
      options.progress = show_progress;
      options.progress_ctx = &progress;
      sd_clump_need need = {};
      const double start = MPI_Wtime();
      result.status = sd_clump_create(&s.shape, &options, &shells, &s.clump, &need);
      result.need = std::min(need.dense, need.iterative);
      result.seconds = MPI_Wtime() - start;
    }
    solved.push_back(result);
  }
  // Only now the ranks wait for each other.
  for (size_t k = first; k < shapes.size(); k++) {
    Shape &s = shapes[k];
    Solved &r = solved[k - first];
    MPI_Bcast(&r.status, 3, MPI_DOUBLE, r.root, world);
    const sd_status status = (sd_status) (int) r.status;
    const std::string who = command + ": keyword rigid_clumps: the clump of molecule " +
        std::to_string(s.molecule) + ", " + std::to_string(s.shape.n) + " spheres, shell " +
        std::to_string(settings.shell) + ": ";
    if (status == SD_ENOMEMORY)
      fail(lmp,
           who + "its resistance needs " + text(r.need / 1e9) + " GB, more than " +
               text(SOLVE_MEMORY / 1e9) + "; use a smaller shell");
    if (status == SD_ESINGULAR)
      fail(lmp, who + "two of its spheres of equal radius are at one point");
    if (status != SD_OK) fail(lmp, who + sd_status_string(status));

    double *table = s.clump.table;
    MPI_Bcast(&s.clump, sizeof(s.clump), MPI_BYTE, r.root, world);
    const int size = 72 * s.shape.n;
    s.clump.table = comm->me == r.root ? table : (double *) malloc(sizeof(double) * size);
    MPI_Bcast(s.clump.table, size, MPI_DOUBLE, r.root, world);
    announce(k, r.seconds);
  }
  solved.clear();
}

void RigidClumps::announce(size_t number, double seconds)
{
  if (comm->me != 0) return;
  const Shape &s = shapes[number];
  const sd_clump &c = s.clump;
  std::string out = "Rigid clumps, shape " + std::to_string(number + 1) + " (molecule " +
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

/* Every unknown clump of this rank gets its shape: there is one for each of them now. */
void RigidClumps::match(const std::vector<size_t> &unknown)
{
  std::vector<double> centres, radii, scratch;
  for (size_t c : unknown) {
    const auto &clump = scene.clumps[c];
    Known &k = known[clump.molecule];
    k.tag.assign(&scene.member_tag[clump.begin],
                 &scene.member_tag[clump.begin] + (clump.end - clump.begin));
    k.shape = -1;
    if (loose_molecules.count(clump.molecule)) continue;
    geometry(clump, centres, radii);
    const int n = radii.size();
    k.perm.resize(n);
    scratch.resize(6 * (size_t) n);
    for (size_t s = 0; s < shapes.size() && k.shape < 0; s++)
      if (shapes[s].shape.n == n &&
          sd_shape_match(&shapes[s].shape, n, centres.data(), radii.data(), k.perm.data(),
                         scratch.data()))
        k.shape = s;
  }
}

}    // namespace StokesDyn
