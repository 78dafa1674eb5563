#include "preconditioner.h"

#include "callback.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double RHO =
    3.0;    // reach of the sparse factor: 42 blocks a sphere in a compact cloud
static const double RIGID =
    1e-9;    // of its size: rounding. A small clump that has bent more gets a new block, so that a restarted run has the same
static const double BENT = 0.02;    // of its size: a clump that has changed more gets a new block
static const double WORTH_COUNTING =
    10.0;    // iterations saved: then what a factor would cost is counted
static const double PATIENCE =
    4.0;    // of blocks by list: a change must have been worth as many; the first warm starts are poor
static const int SMALL_CLUMP = 64;    // spheres: cheaper to factor anew than to keep

void Preconditioner::free_shapes()
{
  for (auto &s : shapes) sd_shape_free(&s);
  shapes.clear();
}

void Preconditioner::forget()
{
  sd_sparse_free(&sparse);
  sd_blocks_free(&blocks);
  sparse = sd_sparse();
  blocks = sd_blocks();
  free_shapes();
  present = NONE;
  numbers = Numbers();
  first_iterations = -1;
  worn = true;
}

/* Members of each molecule with two spheres or more; true if they are at least half of the spheres. */
bool Preconditioner::group_by_molecule(const std::vector<int64_t> &molecule, const double *a)
{
  std::map<int64_t, std::vector<int>> clumps;
  int spheres = 0, inside = 0;
  for (int i = 0; i < n; i++)
    if (a[i] > 0.0) {
      spheres++;
      if (molecule[i] != 0) clumps[molecule[i]].push_back(i);
    }
  first.assign(1, 0);
  member.clear();
  for (const auto &clump : clumps) {
    if (clump.second.size() < 2) continue;
    member.insert(member.end(), clump.second.begin(), clump.second.end());
    first.push_back(member.size());
    inside += clump.second.size();
  }
  return 2 * inside >= spheres && inside > 0;
}

/* The same where every sphere sees all of its clump, in images that are next to one another. A clump that this rank has at two borders
 * of a periodic box comes twice, as it is seen from either; no atom is in two blocks. */
void Preconditioner::group_by_list()
{
  const sd_pairs &list = scene.list();
  const int nlocal = atom->nlocal;
  std::vector<char> done(nlocal, 0);
  first.assign(1, 0);
  member.clear();
  for (int i = 0; i < nlocal; i++) {
    if (done[i] || list.first[i] == list.first[i + 1]) continue;
    member.push_back(i);
    for (long k = list.first[i]; k < list.first[i + 1]; k++) {
      const int j = list.neighbor[k];
      member.push_back(j);
      if (j < nlocal) done[j] = 1;
    }
    first.push_back(member.size());
  }
}

/* 6 pi eta a and 8 pi eta a^3 */
void Preconditioner::diagonal(const sd_spheres &s)
{
  all_drag.resize(n);
  all_spin.resize(n);
  for (int i = 0; i < n; i++) {
    const double eta_a = s.a[i] > 0.0 ? s.a[i] / (s.w[i] * s.w[i]) : 0.0;
    all_drag[i] = 6.0 * SD_PI * eta_a;
    all_spin[i] = 8.0 * SD_PI * eta_a * s.a[i] * s.a[i];
  }
}

/* auto, all pairs: blocks where there are clumps, else the sparse factor; or nothing, if that costs less (sd_choice.h). Every rank
 * sees the whole cloud and chooses alike. */
Preconditioner::Kind Preconditioner::choose(bool clumps)
{
  const Kind candidate = clumps ? CLUMP : SPARSE;
  if (candidate == CLUMP)
    costs = sd_costs_blocks(n, width, first.size() - 1, first.data(), !small);
  else {
    costs = sd_costs_sparse(n, width, &numbers.size);
    if (numbers.spheres != n && numbers.choice.gain > WORTH_COUNTING * costs.without) {
      const sd_spheres s = scene.cloud();
      sd_sparse_size part;
      sd_sparse_count(&s, n, RHO, comm->me, comm->nprocs, &part);
      add_up(part);
      costs = sd_costs_sparse(n, width, &numbers.size);
    }
    if (numbers.spheres != n && !numbers.choice.with) costs.set_up = INFINITY;    // not yet known
  }
  if (!numbers.choice.begun || numbers.candidate != candidate) {
    numbers.candidate = candidate;
    sd_choice_begin(&numbers.choice, &costs, tolerance);
  }
  return numbers.choice.with ? candidate : NONE;
}

/* auto, lists. A solve from zero, and those to come without warm start, have the iterations that the tolerance lets expect; warm starts
 * begin without blocks, since they often leave next to nothing to do. */
Preconditioner::Kind Preconditioner::choose_by_list()
{
  const int nlocal = atom->nlocal;
  const size_t count = first.size() - 1;
  std::vector<double> share(count + 1);
  for (size_t k = 0; k < count; k++) {
    const long size = first[k + 1] - first[k];
    share[k] = std::count_if(&member[first[k]], &member[first[k]] + size,
                             [nlocal](int i) {
                               return i < nlocal;
                             }) /
        (double) size;
  }
  costs = sd_costs_by_list(nlocal, scene.list().first[nlocal], width, count, first.data(),
                           share.data(), whole);
  double sums[3] = {costs.without, costs.with, costs.every};
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, world);
  costs.without = sums[0];
  costs.with = sums[1];
  costs.every = sums[2];
  if (costs.every == 0.0) return NONE;
  if (warm_start && !warm) {
    sd_choice once;
    sd_choice_begin(&once, &costs, tolerance);
    return once.with ? CLUMP : NONE;
  }
  if (!numbers.choice.begun || numbers.candidate != CLUMP) {
    numbers.candidate = CLUMP;
    sd_choice_begin(&numbers.choice, &costs, warm ? 1.0 : tolerance);
  }
  costs.set_up = PATIENCE * costs.every;
  return numbers.choice.with ? CLUMP : NONE;
}

/* What the parts of a factor add up to */
void Preconditioner::add_up(sd_sparse_size &part)
{
  double sums[3] = {part.blocks, part.squares, part.cubes};
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, world);
  numbers.size = {sums[0], sums[1], sums[2]};
  numbers.spheres = n;
}

void Preconditioner::attach(sd_system &system)
{
  present = NONE;
  width = system.spin ? 6 : 3;
  warm = system.warm;
  const bool cloud = scene.view() == SD_VIEW_ALL;
  whole = scene.settings.clumps_only && std::isinf(scene.settings.cutoff);
  if (kind == NONE) return;

  std::vector<int64_t> molecule;
  const double *a;
  if (cloud) {
    if (scene.cloud_changed()) worn = true;
    n = scene.cloud_size();
    a = scene.cloud().a;
  } else {
    n = atom->nlocal + (whole ? atom->nghost : 0);
    a = scene.radii();
  }
  bool clumps = false;
  first.assign(1, 0);
  member.clear();
  if (kind != SPARSE && whole)
    group_by_list();
  else if (kind != SPARSE && atom->molecule) {
    if (!cloud) molecule.assign(atom->molecule, atom->molecule + n);
    clumps = group_by_molecule(cloud ? scene.cloud_molecules() : molecule, a);
  }
  small = member.size() <= (first.size() - 1) * (size_t) SMALL_CLUMP;
  // The same on all ranks: the solver's sums and most applications are collective.
  Kind want = kind;
  if (kind == AUTO) want = cloud ? choose(clumps) : choose_by_list();
  if (want == NONE) return;

  if (cloud || whole) diagonal(cloud ? scene.cloud() : scene.local());
  drag = cloud || whole ? all_drag.data() : system.drag;
  spin = !system.spin ? nullptr : cloud || whole ? all_spin.data() : system.spin;
  if (want == SPARSE) {
    int ready = !worn || make_sparse();
    MPI_Allreduce(MPI_IN_PLACE, &ready, 1, MPI_INT, MPI_MIN, world);
    if (!ready) return;    // one that cannot be made is done without
    worn = false;
    sparse.drag = drag;
    sparse.spin = spin;
  }
  pending = want == CLUMP;
  present = want;
  system.precondition = cloud ? apply : whole ? apply_whole : apply_own;
  system.precondition_ctx = this;
}

/* Blocks are made or turned at their first use: a warm start often needs none at all. Blocks that cannot be made are done without. */
sd_status Preconditioner::apply_blocks(const double *r, double *z)
{
  if (pending) {
    pending = false;
    usable = (!worn && turn_blocks()) || make_blocks();
    if (whole || scene.view() == SD_VIEW_ALL) {    // ranks that share a clump must treat it alike
      int all = usable;
      MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, world);
      usable = all;
    }
    worn = !usable;
    blocks.drag = drag;
    blocks.spin = spin;
  }
  const bool other_rank = scene.view() == SD_VIEW_ALL && comm->me > 0;    // the first one does it all
  if (usable) return sd_blocks_apply(&blocks, r, z);
  for (long i = 0; i < n; i++)
    for (int d = 0; d < width; d++)
      z[width * i + d] =
          drag[i] == 0.0 || other_rank ? 0.0 : (d < 3 ? drag[i] : spin[i]) * r[width * i + d];
  return SD_OK;
}

sd_status Preconditioner::apply_own(void *ctx, const double *r, double *z)
{
  return callback([=] {
    return static_cast<Preconditioner *>(ctx)->apply_blocks(r, z);
  });
}

sd_status Preconditioner::apply_whole(void *ctx, const double *r, double *z)
{
  Preconditioner *p = static_cast<Preconditioner *>(ctx);
  return callback([=] {
    const size_t own = p->width * (size_t) p->atom->nlocal;
    p->in.assign(r, r + own);
    p->scene.refresh(p->in, p->width);
    p->out.resize(p->width * (size_t) p->n + 1);
    const sd_status status = p->apply_blocks(p->in.data(), p->out.data());
    std::copy_n(p->out.begin(), own, z);
    return status;
  });
}

bool Preconditioner::make_sparse()
{
  const sd_law law = scene.law();
  const sd_spheres s = scene.cloud();
  sd_sparse_free(&sparse);
  sparse = sd_sparse();
  numbers.wear = {};
  const bool another = numbers.spheres > 0.0 && numbers.spheres != n;    // spheres came or went
  const bool made =
      sd_sparse_create(&sparse, &law, &s, n, width, RHO, comm->me, comm->nprocs) == SD_OK;
  sd_sparse_size part = made ? sd_sparse_sized(&sparse) : sd_sparse_size();
  add_up(part);
  costs = sd_costs_sparse(n, width, &numbers.size);
  if (another) numbers.choice.gain += costs.set_up;
  return made;
}

bool Preconditioner::make_blocks()
{
  const sd_law law = scene.law();
  const bool cloud = scene.view() == SD_VIEW_ALL;
  sd_spheres s = cloud ? scene.cloud() : scene.local();
  if (!cloud &&
      !whole) {    // a clump may lie across a periodic boundary: images that are next to one another
    near.resize(3 * (size_t) n + 3);
    for (size_t k = 0; k + 1 < first.size(); k++)
      for (long m = first[k]; m < first[k + 1]; m++)
        domain->closest_image(s.x + 3 * (long) member[first[k]], s.x + 3 * (long) member[m],
                              &near[3 * (size_t) member[m]]);
    s.x = near.data();
  }
  sd_blocks_free(&blocks);
  blocks = sd_blocks();
  free_shapes();
  first_iterations = -1;
  const int count = first.size() - 1;
  if (!cloud)
    return sd_blocks_create(&blocks, &law, &s, n, width, count, first.data(), member.data()) ==
        SD_OK;
  int made = sd_blocks_create_part(&blocks, &law, &s, n, width, count, first.data(), member.data(),
                                   comm->me, comm->nprocs) == SD_OK;
  MPI_Allreduce(MPI_IN_PLACE, &made, 1, MPI_INT, MPI_MIN, world);
  if (!made) return false;
  MPI_Allreduce(MPI_IN_PLACE, blocks.rigid, 3 * width * (int) blocks.first[count], MPI_DOUBLE,
                MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, blocks.mobility, 9 * count, MPI_DOUBLE, MPI_SUM, world);
  for (int k = 0; k < count; k++) {
    std::vector<double> x, a;
    for (long m = first[k]; m < first[k + 1]; m++) {
      x.insert(x.end(), s.x + 3 * (long) member[m], s.x + 3 * (long) member[m] + 3);
      a.push_back(s.a[member[m]]);
    }
    sd_shape shape;
    if (sd_shape_create(a.size(), x.data(), a.data(), &shape) != SD_OK) return false;
    shapes.push_back(shape);
  }
  sd_blocks_couple(&blocks, &law, &s, RHO);    // uncoupled blocks are a preconditioner as well
  return true;
}

/* Clumps of a cloud that have moved as rigid bodies keep their blocks; false if one has not. */
bool Preconditioner::turn_blocks()
{
  if (scene.view() != SD_VIEW_ALL || blocks.blocks != (int) first.size() - 1 ||
      shapes.size() + 1 != first.size())
    return false;
  const sd_law law = scene.law();
  const sd_spheres s = scene.cloud();
  std::vector<double> clump;
  for (size_t k = 0; k < shapes.size(); k++) {
    clump.clear();
    for (long m = first[k]; m < first[k + 1]; m++)
      clump.insert(clump.end(), s.x + 3 * (long) member[m], s.x + 3 * (long) member[m] + 3);
    double R[9], c[3];
    if (!(sd_shape_pose(&shapes[k], clump.data(), R, c) <= (small ? RIGID : BENT) * shapes[k].size))
      return false;
    sd_blocks_turn(&blocks, k, R);
  }
  sd_blocks_couple(&blocks, &law, &s, RHO);    // for where the clumps are now
  return true;
}

sd_status Preconditioner::apply(void *ctx, const double *r, double *z)
{
  Preconditioner *p = static_cast<Preconditioner *>(ctx);
  return callback([=] {
    p->in.resize((size_t) p->width * p->n + 1);
    p->out.resize((size_t) p->width * p->n + 1);
    p->scene.to_cloud(r, p->in.data(), p->width);
    const sd_status status = p->present == SPARSE
        ? sd_sparse_apply(&p->sparse, p->in.data(), p->out.data())
        : p->apply_blocks(p->in.data(), p->out.data());
    p->scene.from_cloud(p->out.data(), z, p->width);
    return status;
  });
}

void Preconditioner::learn(const sd_solve_report &report)
{
  bool made = false;    // is there to be another factor?
  if (present == SPARSE) {
    costs = sd_costs_sparse(n, width, &numbers.size);
    made = sd_wear_learn(&numbers.wear, &costs, report.iterations);
    worn = worn || made;
  }
  if (present == CLUMP && report.iterations > 0) {
    if (first_iterations < 0) first_iterations = report.iterations;
    if (report.iterations > first_iterations + first_iterations / 2 + 3) worn = true;
  }
  if (kind != AUTO || costs.without == 0.0) return;
  // Blocks by list pay in a single solve, and that from zero says nothing of the warm ones to come.
  if (scene.view() != SD_VIEW_ALL && warm_start && !warm) return;
  sd_choice_learn(&numbers.choice, &costs, report.iterations, made);
  if (numbers.choice.solves == 0.0) worn = true;    // it goes the other way now
}

}    // namespace StokesDyn
