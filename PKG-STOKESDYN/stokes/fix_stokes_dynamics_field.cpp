#include "fix_stokes_dynamics_field.h"

#include "callback.h"
#include "halo.h"
#include "image_file.h"
#include "keywords.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const double MOST_POINTS = 2147483647.0 / 3.0;
/* Squares of distances must be numbers. */
static const double FARTHEST = 1e150;

FixStokesDynamicsField::FixStokesDynamicsField(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg)
{
  Keywords in = keywords(narg, arg);
  nevery = (int) in.positional("N").integer(1);
  file = in.positional("FILE").word();
  in.require(file.find('*') != std::string::npos,
             "FILE: '" + file + "' must have a *, which becomes the number of the step");
  double all = 1.0;
  static const char *const NAMES[] = {"nx", "ny", "nz"};
  for (int d = 0; d < 3; d++) {
    points[d] = (int) in.positional(NAMES[d]).integer(1);
    all *= points[d];
  }
  in.require(all < MOST_POINTS, "a grid of " + text(all) + " points must have fewer than 7e8");
  const auto corner = [&](double x[3], bool &given) {
    for (int d = 0; d < 3; d++) {
      x[d] = in.number();
      in.require(fabs(x[d]) < FARTHEST, "keywords lo and hi: '" + text(x[d]) +
                                            "' is too far away, the limit is " + text(FARTHEST));
    }
    given = true;
  };
  in.parse({{"lo", [&] { corner(lo, has_lo); }}, {"hi", [&] { corner(hi, has_hi); }}});
  for (int d = 0; d < 3 && has_lo && has_hi; d++)
    in.require(points[d] == 1 ? hi[d] >= lo[d] : hi[d] > lo[d],
               "keyword hi: '" + text(hi[d]) + "' must be above lo, " + text(lo[d]));
}

int FixStokesDynamicsField::setmask()
{
  return FixConst::END_OF_STEP;
}

void FixStokesDynamicsField::init()
{
  const Boundary &boundary = hydrodynamics().settings.scene.boundary;
  if (boundary.slab()) return;
  if (boundary.walled())
    voice.fail("the pair style has keyword wall, whose images are not in the flow that this fix "
               "knows in an open box; make the box periodic along the wall (" +
               boundary.letters() + "), or use it without a wall");
  const int directions = domain->xperiodic + domain->yperiodic + domain->zperiodic;
  if (directions != 0 && directions != 3)
    voice.fail("the box is periodic in " + std::to_string(directions) + " of 3 directions: the "
               "flow is known for a box that is periodic in all or in none, and in two of them with "
               "cut_off_distance inf of the pair style");
}

/* Without inertia velocities are found when the setup of all fixes is done, and then this is called
 * again. */
void FixStokesDynamicsField::setup(int /*vflag*/)
{
  if (!hydrodynamics().overdamped) end_of_step();
}

/* Planes of the grid that rank p and those before it have */
int FixStokesDynamicsField::end_of_share(int planes, int p) const
{
  return (int) ((bigint) planes * (p + 1) / comm->nprocs);
}

/* nx ny nz points from corner to corner; a single one is in the middle. */
sd_field_grid FixStokesDynamicsField::grid() const
{
  sd_field_grid g = {};
  const double *from = has_lo ? lo : domain->triclinic ? domain->boxlo_bound : domain->boxlo;
  const double *to = has_hi ? hi : domain->triclinic ? domain->boxhi_bound : domain->boxhi;
  for (int d = 0; d < 3; d++) {
    const double length = to[d] - from[d];
    g.n[d] = points[d];
    g.lo[d] = points[d] == 1 ? from[d] + 0.5 * length : from[d];
    g.step[d] = points[d] > 1 ? length / (points[d] - 1) : length > 0.0 ? length : 1.0;
    if (!(g.step[d] > 0.0))
      voice.at_step().fail("the box from " + text(from[d]) + " to " + text(to[d]) +
                           " leaves no room for the grid");
  }
  g.from = end_of_share(g.n[2], comm->me - 1);
  g.to = end_of_share(g.n[2], comm->me);
  return g;
}

static std::vector<double> places_of(const sd_field_grid &g)
{
  std::vector<double> x;
  x.reserve(3 * sd_field_points(&g));
  for (int k = g.from; k < g.to; k++)
    for (int j = 0; j < g.n[1]; j++)
      for (int i = 0; i < g.n[0]; i++)
        x.insert(x.end(),
                 {g.lo[0] + i * g.step[0], g.lo[1] + j * g.step[1], g.lo[2] + k * g.step[2]});
  return x;
}

/* How the box repeats itself; in two dimensions across them as it does along them */
StokesDyn::Lattice FixStokesDynamicsField::images() const
{
  StokesDyn::Lattice lattice = StokesDyn::Lattice::of(domain);
  if (domain->dimension == 2) std::fill_n(lattice.periodic, 3, domain->xperiodic);
  return lattice;
}

/* Of the places x of all ranks those within reach of the planes of this one, each periodic image by itself */
Halo FixStokesDynamicsField::near_planes(const sd_field_grid &g, double reach, const std::vector<double> &x) const
{
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    lo[d] = g.lo[d] + (d == 2 ? g.from : 0) * g.step[d];
    hi[d] = g.lo[d] + ((d == 2 ? g.to : g.n[d]) - 1) * g.step[d];
  }
  if (g.from == g.to) lo[2] = INFINITY;
  Halo halo(world);
  if (!halo.find_around(images(), reach, x, lo, hi))
    voice.at_step().fail_one("keywords lo and hi: the grid, at z from " + text(lo[2]) + " to " +
                             text(hi[2]) + ", sees more than 1000 images of each sphere and 1e7 in "
                             "all; is it in other units than the box?");
  return halo;
}

/* Numbers [width n] of what is on this rank -> of what is near its planes */
static std::vector<double> near_by(const Halo &halo, const std::vector<double> &mine, int width)
{
  std::vector<double> near(width * ((size_t) halo.count() + 1));
  halo.refresh(mine.data(), near.data(), width);
  return near;
}

static std::vector<double> places_near_by(const Halo &halo, const double h[6], const std::vector<double> &x)
{
  std::vector<double> near(3 * ((size_t) halo.count() + 1));
  halo.place(h, x.data(), near.data());
  return near;
}

static sd_field_sources as_core(const FlowSources &s, int n)
{
  return {n, s.x.data(), s.a.data(), s.F.data(), s.T.data()};
}

static sd_field_cloud measure_all(MPI_Comm world, const FlowSources &sources)
{
  const sd_field_sources mine = as_core(sources, (int) sources.a.size());
  sd_field_cloud c;
  sd_field_measure(&mine, &c);
  double sums[] = {c.all.count, c.all.squares, c.all.fourths, c.torque, c.check};
  double most[] = {c.all.largest, -c.lo[0], -c.lo[1], -c.lo[2], c.hi[0], c.hi[1], c.hi[2]};
  MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, most, 7, MPI_DOUBLE, MPI_MAX, world);
  c.all = {sums[0], sums[1], sums[2], most[0]};
  c.torque = sums[3];
  c.check = sums[4];
  for (int d = 0; d < 3; d++) {
    c.lo[d] = -most[1 + d];
    c.hi[d] = most[4 + d];
  }
  return c;
}

/* The sources of all ranks go round, so many at a time. */
sd_status FixStokesDynamicsField::add_all_pairs(const FlowSources &sources, const sd_field_grid &g, double *u)
{
  const size_t at_once = 100000;
  sd_status status = SD_OK;
  for (int p = 0; p < comm->nprocs; p++) {
    bigint count = (bigint) sources.a.size();
    MPI_Bcast(&count, 1, MPI_LMP_BIGINT, p, world);
    for (size_t from = 0; from < (size_t) count; from += at_once) {
      const size_t n = std::min(at_once, (size_t) count - from);
      const auto theirs = [&](const std::vector<double> &mine, size_t width) {
        std::vector<double> some(width * n);
        if (p == comm->me) std::copy_n(&mine[width * from], some.size(), some.data());
        MPI_Bcast(some.data(), (int) some.size(), MPI_DOUBLE, p, world);
        return some;
      };
      const FlowSources all = {theirs(sources.x, 3), theirs(sources.a, 1), theirs(sources.F, 3),
                               theirs(sources.T, 3), {}};
      const sd_field_sources some = as_core(all, (int) n);
      if (status == SD_OK) status = sd_field_add_all(&tables, &some, &g, u);
    }
  }
  return status;
}

sd_status FixStokesDynamicsField::add_split(Hydrodynamics &hydro, const FlowSources &sources, double range,
                                            const sd_field_grid &g, double *u)
{
  const sd_world ranks = hydro.engine.ranks();
  const Halo halo = near_planes(g, range, sources.x);
  const FlowSources there = {places_near_by(halo, images().h, sources.x), near_by(halo, sources.a, 1),
                             near_by(halo, sources.F, 3), near_by(halo, sources.T, 3), {}};
  const sd_field_sources ours = as_core(sources, (int) sources.a.size()), near = as_core(there, halo.count());
  return sd_field_add_split(&tables, &ours, &near, &g, &ranks, u);
}

/* Every rank takes its share of planes. */
void FixStokesDynamicsField::add_flow(Hydrodynamics &hydro, const sd_field_grid &g, double *u)
{
  const FlowSources sources = hydro.on_fluid();
  if (hydro.settings.scene.boundary.slab())
    in_slab.add(voice, hydro.settings.scene, sources, places_of(g), u);
  else
    add_sums(hydro, sources, g, u);
}

/* Where the sources near to these are enough, the rank knows no others. */
void FixStokesDynamicsField::add_sums(Hydrodynamics &hydro, const FlowSources &sources,
                                      const sd_field_grid &g, double *u)
{
  const sd_field_cloud all = measure_all(world, sources);
  static const sd_field_sum SUMS[] = {SD_FIELD_AUTO, SD_FIELD_DIRECT, SD_FIELD_SPLIT};
  const SceneSettings &scene = hydro.settings.scene;
  const sd_ewald_box box = Lattice::of(domain).ewald_box();
  double range;
  sd_status status = sd_field_plan(&tables, SUMS[scene.far_field], &box, scene.far_field_tolerance,
                                   &all, &g, &range);
  if (status == SD_OK)
    status = std::isinf(range) ? add_all_pairs(sources, g, u) : add_split(hydro, sources, range, g, u);
  if (status != SD_OK)
    fail_by(voice.at_step(), status, "the flow of " + text(all.all.count) +
                                     " spheres or points at " + std::to_string(g.n[0]) + " x " +
                                     std::to_string(g.n[1]) + " x " + std::to_string(g.n[2]) +
                                     " points: " + sd_status_string(status));
}

/* In a box that deforms with the fluid an image moves with the flow there: faster by how much the velocity
 * grows with each edge. */
std::vector<unsigned char> FixStokesDynamicsField::put_spheres(const Hydrodynamics &hydro,
                                                               const sd_field_grid &g,
                                                               double *u) const
{
  std::vector<double> x, a, V, faster;
  double largest = 0.0;
  for (int i : hydro.ambient.who()) {
    x.insert(x.end(), atom->x[i], atom->x[i] + 3);
    a.push_back(atom->radius[i]);
    V.insert(V.end(), atom->v[i], atom->v[i] + 3);
    V.insert(V.end(), atom->omega[i], atom->omega[i] + 3);
    largest = std::max(largest, atom->radius[i]);
  }
  largest = among_all(world, largest, MPI_MAX);
  const Halo halo = near_planes(g, largest, x);
  x = places_near_by(halo, images().h, x);
  a = near_by(halo, a, 1);
  V = near_by(halo, V, 6);
  if (const double *jumps = hydro.ambient.jumps()) {
    faster.resize(3 * (size_t) halo.count() + 3);
    halo.place(jumps, nullptr, faster.data());
    for (size_t k = 0; k < (size_t) halo.count(); k++)
      for (int d = 0; d < 3; d++) V[6 * k + d] += faster[3 * k + d];
  }
  const sd_field_bodies spheres = {halo.count(), x.data(), a.data(), V.data()};
  std::vector<unsigned char> inside(sd_field_points(&g) + 1);
  const sd_status status = sd_field_inside(&spheres, &g, u, inside.data());
  if (status != SD_OK) voice.fail_one(sd_status_string(status));
  inside.resize(sd_field_points(&g));
  return inside;
}

void FixStokesDynamicsField::end_of_step()
{
  if (update->ntimestep % nevery) return;
  Hydrodynamics &hydro = hydrodynamics();
  if (!hydro.computed_in((double) update->ntimestep))
    voice.at_step().fail("the pair style was not computed in this step (pair_modify compute no?)");
  const sd_field_grid g = grid();
  std::vector<double> u = hydro.ambient.at_places(places_of(g));
  u.resize(3 * sd_field_points(&g) + 1);
  add_flow(hydro, g, u.data());
  const std::vector<unsigned char> inside = put_spheres(hydro, g, u.data());
  u.resize(3 * sd_field_points(&g));
  write(g, u, inside);
}

/* One rank writes, what the others have comes to it one after the other. */
void FixStokesDynamicsField::write(const sd_field_grid &g, const std::vector<double> &u,
                                   const std::vector<unsigned char> &inside) const
{
  const size_t star = file.find('*');
  const std::string path =
      file.substr(0, star) + std::to_string(update->ntimestep) + file.substr(star + 1);
  int well = 1;
  if (comm->me != 0) {
    MPI_Send(const_cast<double *>(u.data()), mpi_count((double) u.size()), MPI_DOUBLE, 0, 0, world);
    MPI_Send(const_cast<unsigned char *>(inside.data()), mpi_count((double) inside.size()),
             MPI_BYTE, 0, 0, world);
  } else {
    const ImageFile::Grid image = {g.lo, g.step, g.n};
    ImageFile out(path, image, hydrodynamics().memory->time());
    const auto put = [&](auto numbers, MPI_Datatype type, size_t of_point) {
      const size_t of_plane = of_point * g.n[0] * g.n[1];
      for (int p = 0; p < comm->nprocs; p++) {
        numbers.resize(of_plane * (end_of_share(g.n[2], p) - end_of_share(g.n[2], p - 1)));
        if (p > 0)
          MPI_Recv(numbers.data(), mpi_count((double) numbers.size()), type, p, 0, world,
                   MPI_STATUS_IGNORE);
        out.put(numbers.data(), sizeof(numbers[0]) * numbers.size());
      }
      out.end();
    };
    out.begin("velocity", "Float64", 3, sizeof(double));
    put(u, MPI_DOUBLE, 3);
    out.begin("inside", "UInt8", 1, 1);
    put(inside, MPI_BYTE, 1);
    well = out.finish();
  }
  MPI_Bcast(&well, 1, MPI_INT, 0, world);
  if (!well)
    voice.fail("the file '" + path + "' could not be written; does its folder exist, and is there "
               "room?");
}

double FixStokesDynamicsField::memory_usage()
{
  return sizeof(double) * (double) (tables.source_room + tables.scratch_room + tables.centre_room) +
      in_slab.memory_usage();
}
