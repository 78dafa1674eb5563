#include "fix_stokes_dynamics_field.h"

#include "callback.h"
#include "image_file.h"
#include "keywords.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const double MOST_POINTS = 2147483647.0 / 3.0;

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
  in.parse({{"lo", [&] {
               for (double &x : lo) x = in.number();
               has_lo = true;
             }},
            {"hi", [&] {
               for (double &x : hi) x = in.number();
               has_hi = true;
             }}});
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
  if (hydrodynamics().settings.scene.wall.sign)
    voice.fail("the pair style has keyword wall, whose images are not in the flow that this fix "
               "knows; use it without a wall");
  const int directions = domain->xperiodic + domain->yperiodic + domain->zperiodic;
  if (directions != 0 && directions != 3)
    voice.fail("the box is periodic in " + std::to_string(directions) + " of 3 directions: the "
               "flow is known for a box that is periodic in all or in none");
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

/* Every rank knows all forces, and takes its share of planes. */
void FixStokesDynamicsField::add_flow(Hydrodynamics &hydro, const sd_ewald_box &box,
                                      const sd_field_grid &g, double *u)
{
  const std::vector<double> all = from_all(world, hydro.on_fluid());
  const size_t n = all.size() / 10;
  std::vector<double> x, a, F, T;
  take_apart(all, n, {{&x, 3}, {&a, 1}, {&F, 3}, {&T, 3}});
  const bool turns = std::any_of(T.begin(), T.end(), [](double t) { return t != 0.0; });
  const sd_field_sources sources = {(int) n, x.data(), a.data(), F.data(),
                                    turns ? T.data() : nullptr};
  static const sd_field_sum SUMS[] = {SD_FIELD_AUTO, SD_FIELD_DIRECT, SD_FIELD_SPLIT};
  const Scene::Settings &scene = hydro.settings.scene;
  const sd_world ranks = hydro.scene.ranks();
  const sd_status status = sd_field_add(&tables, SUMS[scene.far_field], &box,
                                        scene.far_field_tolerance, &sources, &g, &ranks, u);
  if (status != SD_OK)
    fail_by(voice.at_step(), status, "the flow of " + std::to_string(n) +
                                     " spheres or points at " + std::to_string(g.n[0]) + " x " +
                                     std::to_string(g.n[1]) + " x " + std::to_string(g.n[2]) +
                                     " points: " + sd_status_string(status));
}

/* In a box that deforms with the fluid an image moves with the flow there. */
std::vector<unsigned char> FixStokesDynamicsField::put_spheres(const Hydrodynamics &hydro,
                                                               const sd_ewald_box &box,
                                                               const sd_field_grid &g,
                                                               double *u) const
{
  std::vector<double> mine, x, a, V;
  for (int i : hydro.ambient.who()) {
    mine.insert(mine.end(), atom->x[i], atom->x[i] + 3);
    mine.push_back(atom->radius[i]);
    mine.insert(mine.end(), atom->v[i], atom->v[i] + 3);
    mine.insert(mine.end(), atom->omega[i], atom->omega[i] + 3);
  }
  const std::vector<double> all = from_all(world, mine);
  take_apart(all, all.size() / 10, {{&x, 3}, {&a, 1}, {&V, 6}});
  const double *j = hydro.ambient.jumps();    // xx yy zz yz xz xy, velocity and edge
  double jump[9] = {0.0};
  if (j) {
    const double rows[9] = {j[0], 0.0, 0.0, j[5], j[1], 0.0, j[4], j[3], j[2]};
    std::copy_n(rows, 9, jump);
  }
  const sd_field_bodies spheres = {(int) a.size(), x.data(), a.data(), V.data(), j ? jump : nullptr};
  std::vector<unsigned char> inside(sd_field_points(&g) + 1);
  const sd_status status = sd_field_inside(&spheres, &box, &g, u, inside.data());
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
  const sd_ewald_box box = Scene::box_of(domain);
  std::vector<double> u = hydro.ambient.at_places(places_of(g));
  u.resize(3 * sd_field_points(&g) + 1);
  add_flow(hydro, box, g, u.data());
  const std::vector<unsigned char> inside = put_spheres(hydro, box, g, u.data());
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
  return sizeof(double) * (double) (tables.source_room + tables.scratch_room);
}
