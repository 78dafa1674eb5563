#include "rigid_clumps.h"

#include "keywords.h"

#include "sd_linear.h"

#include "atom.h"
#include "comm.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double RIGID_TO = 1e-4;       // of its size: more is not the same shape any more
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
  double bytes =
      sizeof(double) * ((double) ghosts.capacity() + radius.capacity() + x.capacity() + F.capacity() + T.capacity());
  for (const auto &s : shapes) bytes += 72.0 * sizeof(double) * s.shape.n;
  return bytes;
}

// --- shapes ----------------------------------------------------------------------------------------------------

/* The same numbers of all ranks, one rank after the other. */
static std::vector<double> from_all_ranks(const std::vector<double> &mine, MPI_Comm world)
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
  out +=
      "\n  resistance about it over viscosity, force and torque from velocity and angular "
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

// --- every step ----------------------------------------------------------------------------------------------------

/* To ghosts: eta (0: takes no part), v, angular velocity, fluid velocity and its gradient, as far as needed. */
void RigidClumps::gather(const Motion &m)
{
  column = {0, 1, 4, 4, 4, 4};
  if (settings.rotation) column.u = column.gradient = column.end = 7;
  if (m.gradient) {
    column.gradient = column.u + 3;
    column.end = column.gradient + 9;
  }
  scene.refresh_ghosts(ghosts, column.end, [&](int i, double *row) {
    row[0] = m.active[i] ? (m.eta ? m.eta[i] : m.eta_uniform) : 0.0;
    memcpy(row + column.v, atom->v[i], 3 * sizeof(double));
    if (settings.rotation) memcpy(row + column.omega, atom->omega[i], 3 * sizeof(double));
    if (m.gradient) {
      memcpy(row + column.u, m.u_inf ? m.u_inf + 3 * (size_t) i : m.u_uniform, 3 * sizeof(double));
      memcpy(row + column.gradient, m.gradient + 9 * (size_t) i, 9 * sizeof(double));
    }
  });
}

/* Slip of a clump in pose R, c: s0 at the centroid and the gradient A (row-major) of the slip field. Spheres in the shape's order. */
void RigidClumps::slip(const Shape &s, const double R[9], const double c[3], const Motion &m,
                       double s0[3], double W[3], double A[9]) const
{
  const int n = s.shape.n;
  const double share = 1.0 / n;
  const bool spins = settings.rotation && s.shape.rank < 2;    // the centres do not tell all of it
  double U[3] = {0.0}, L[3] = {0.0}, spin[3] = {0.0}, u[3] = {0.0}, G[9] = {0.0};
  for (int k = 0; k < n; k++) {
    const Sphere &sphere = spheres[k];
    const double *v = sphere.v;
    const double r[3] = {x[3 * k] - c[0], x[3 * k + 1] - c[1], x[3 * k + 2] - c[2]};
    double rv[3];
    sd_cross(r, v, rv);
    for (int d = 0; d < 3; d++) {
      U[d] += v[d] * share;
      L[d] += rv[d];
    }
    if (spins)
      for (int d = 0; d < 3; d++) spin[d] += sphere.omega[d] * share;
    if (!m.gradient) continue;
    for (int d = 0; d < 3; d++) u[d] += sphere.u[d] * share;
    for (int d = 0; d < 9; d++) G[d] += sphere.gradient[d] * share;
  }
  // Angular velocity from the velocities of the centres; about an axis that all of them sit on, from the spheres' own.
  double body[3], turned[3];
  sd_multiply3t(R, L, body);
  sd_multiply3(s.spin_inverse, body, turned);
  if (spins) {
    sd_multiply3t(R, spin, body);
    const double about = sd_dot(body, s.axis);
    for (int d = 0; d < 3; d++)
      turned[d] = s.shape.rank == 0 ? body[d] : turned[d] + about * s.axis[d];
  }
  double w[3];
  sd_multiply3(R, turned, w);
  if (!m.gradient) {
    for (int d = 0; d < 3; d++) {
      s0[d] = m.u_uniform[d] - U[d];
      W[d] = -w[d];
    }
    return;
  }
  // What the given gradient does not explain of the fluid velocities at the centres is fitted: all of it, where the fluid velocity is
  // stored per atom.
  double B[9] = {0.0}, RB[9], fit[9], Rt[9], residual[9];
  for (int k = 0; k < n; k++) {
    const Sphere &sphere = spheres[k];
    const double r[3] = {x[3 * k] - c[0], x[3 * k + 1] - c[1], x[3 * k + 2] - c[2]};
    double e[3];
    sd_multiply3(G, r, e);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) B[3 * p + q] += (sphere.u[p] - u[p] - e[p]) * r[q];
  }
  // B (sum r r)^-1 = B R (sum X X)^-1 R^T
  sd_product3(B, R, RB);
  sd_product3(RB, s.gradient_inverse, fit);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) Rt[3 * p + q] = R[3 * q + p];
  sd_product3(fit, Rt, residual);
  const double Wx[9] = {0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0};
  for (int d = 0; d < 9; d++) A[d] = G[d] + residual[d] - Wx[d];
  for (int d = 0; d < 3; d++) s0[d] = u[d] - U[d];
}

enum { SPLIT = 1, BENT = 2 };

void RigidClumps::begin_step(const Motion &m, std::vector<char> &loose)
{
  if (scene.update_clumps()) recognise();
  gather(m);
  const int nlocal = atom->nlocal;
  loose.resize(nlocal);
  for (int i = 0; i < nlocal; i++) loose[i] = atom->molecule[i] == 0;
  worst = 0;
  bent.clear();
}

bool RigidClumps::evaluate(size_t number, const Motion &m, std::vector<char> &loose)
{
  const auto &clump = scene.clumps[number];
  const Known &of = *of_clump[number];
  const int n = clump.end - clump.begin, nlocal = atom->nlocal;
  if (of.shape < 0) {
    for (int k = clump.begin; k < clump.end; k++)
      if (scene.owned[k] >= 0) loose[scene.owned[k]] = 1;
    return false;
  }
  if (x.size() < 3 * (size_t) n) {
    x.resize(3 * (size_t) n);
    F.resize(3 * (size_t) n);
    T.resize(3 * (size_t) n);
    spheres.resize(n);
  }
  int taking_part = 0;
  double eta = 0.0;
  for (int k = 0; k < n; k++) {
    const int j = scene.member[clump.begin + of.perm[k]];
    memcpy(&x[3 * (size_t) k], atom->x[j], 3 * sizeof(double));
    if (j < nlocal) {
      taking_part += m.active[j];
      eta += m.eta ? m.eta[j] : m.eta_uniform;
      spheres[k] = {atom->v[j], settings.rotation ? atom->omega[j] : nullptr,
                    m.u_inf ? m.u_inf + 3 * (size_t) j : m.u_uniform,
                    m.gradient ? m.gradient + 9 * (size_t) j : nullptr};
    } else {
      const double *row = &ghosts[(size_t) column.end * (j - nlocal)];
      taking_part += row[0] > 0.0;
      eta += row[0];
      spheres[k] = {row + column.v, row + column.omega, row + column.u, row + column.gradient};
    }
  }
  if (taking_part == 0) return false;
  if (taking_part < n) {
    worst = std::max(worst, 4 * clump.molecule + SPLIT);
    return false;
  }
  const Shape &s = shapes[of.shape];
  double R[9], c[3], s0[3], W[3], A[9];
  const double deviation = sd_shape_pose(&s.shape, x.data(), R, c);
  if (!(deviation <= RIGID_TO * s.shape.size)) {
    worst = std::max(worst, 4 * clump.molecule + BENT);
    bent.push_back(clump.molecule);
    return false;
  }
  slip(s, R, c, m, s0, W, A);
  double *torque = settings.rotation ? T.data() : nullptr;
  if (m.gradient)
    sd_clump_forces(&s.clump, R, eta / n, s0, A, F.data(), torque);
  else
    sd_clump_forces_rigid(&s.clump, R, eta / n, s0, W, F.data(), torque);
  return true;
}

void RigidClumps::end_step(std::vector<char> &loose)
{
  int64_t any;
  MPI_Allreduce(&worst, &any, 1, MPI_LMP_BIGINT, MPI_MAX, world);
  if (any % 4 == SPLIT)
    fail(lmp,
         command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(any / 4) +
             " is split by the keyword group or region: all of its spheres must be selected, or "
             "none");
  if (any % 4 == BENT && !settings.auto_resolve)
    fail(lmp,
         command + ": keyword rigid_clumps: the clump of molecule " + std::to_string(any / 4) +
             " is not rigid: its shape has changed by more than " + text(RIGID_TO) +
             " of its size (rigid_clumps auto solves such clumps anew)");
  if (any) {    // from now on the solver has them
    for (double molecule : from_all_ranks(bent, world)) {
      loose_molecules.insert((int64_t) molecule);
      const auto found = known.find((int64_t) molecule);
      if (found != known.end()) found->second.shape = -1;
    }
    for (size_t number = 0; number < scene.clumps.size(); number++)
      if (of_clump[number]->shape < 0)
        for (int k = scene.clumps[number].begin; k < scene.clumps[number].end; k++)
          if (scene.owned[k] >= 0) loose[scene.owned[k]] = 1;
  }
}

}    // namespace StokesDyn
