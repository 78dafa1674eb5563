#include "far_field.h"

#include "lattice.h"
#include "ranks.h"
#include "scene_at_boundary.h"

#include "sd_ewald_cost.h"

#include "comm.h"
#include "domain.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

// Of spheres near those of a rank: 10 GB. Of one sphere, where a box is less than a tenth of it wide: of more, in cells
// as large as the range, a placing takes seconds, and soon minutes.
static const double MOST_IMAGES = 1e8, MOST_OF_EACH = 1e5;

// Residual down to which a solve goes with products of floats: a hundred times their rounding, and more.
static const double FLOATS_SOLVE_TO = 0.99e-4;

FarField::FarField(const Voice &voice, const Scene &scene, const Shells &shells) :
    Pointers(voice.lmp), voice(voice), scene(scene), shells(shells), settings(scene.settings)
{
}

sd_mobility_how FarField::how() const
{
  return {settings.law(), width(), &ewald, &second_level, &slab, harmless_error()};
}

/* Noise, too, asks for more digits than the tolerance says: a root goes on where a solve has ended. */
double FarField::harmless_error() const
{
  return settings.residual < FLOATS_SOLVE_TO || positive > 0.0 ? 0.0 : settings.far_field_tolerance;
}

/* Noise is drawn for points: there is no mean over those of a sphere. */
double FarField::tolerance_of_sums() const
{
  return settings.far_field_tolerance * (shells.on() && positive == 0.0 ? shells.looser() : 1.0);
}

bool FarField::periodic() const
{
  return domain->xperiodic && domain->yperiodic && domain->zperiodic;
}

/* How many of which size there are on all ranks. */
sd_ewald_sizes FarField::sizes_of_all(double largest) const
{
  sd_ewald_sizes s = {};
  s.all.largest = largest;
  const double *a = scene.local().a;
  for (int k = 0; k < scene.size(); k++) sd_ewald_count(&s, shells.grain(a[k]), shells.points(a[k]));
  static_assert(sizeof(s) == (1 + SD_EWALD_OCTAVES) * 4 * sizeof(double), "numbers alone");
  const int numbers = sizeof(s) / sizeof(double);
  sd_ewald_sizes most = s;
  MPI_Allreduce(MPI_IN_PLACE, &s, numbers, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, &most, numbers, MPI_DOUBLE, MPI_MAX, world);
  s.all.largest = most.all.largest;
  for (int k = 0; k < SD_EWALD_OCTAVES; k++) s.octave[k].largest = most.octave[k].largest;
  return s;
}

/* The spheres of all ranks, and the box that they are summed in: LAMMPS's if it is periodic, else
 * one around them, which goes along with them. */
sd_ewald_sizes FarField::measure(sd_ewald_box &box) const
{
  const sd_spheres s = scene.local();
  double most[7] = {0.0, -INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY};
  for (int k = 0; k < scene.size(); k++) {
    const double outside = shells.extent(s.a[k]);
    most[0] = std::max(most[0], shells.grain(s.a[k]));
    for (int d = 0; d < 3; d++) {
      most[1 + d] = std::max(most[1 + d], outside - s.x[3 * k + d]);
      most[4 + d] = std::max(most[4 + d], outside + s.x[3 * k + d]);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 7, MPI_DOUBLE, MPI_MAX, world);
  const sd_ewald_sizes all = sizes_of_all(most[0]);
  if (periodic())
    box = Lattice::of(domain).ewald_box();
  else if (all.all.count > 0.0) {
    double lo[3], hi[3];
    for (int d = 0; d < 3; d++) {
      lo[d] = -most[1 + d];
      hi[d] = most[4 + d];
    }
    if (box.periodic) box = {};
    const sd_wall &wall = settings.boundary.image_wall();
    sd_ewald_box_around(&box, wall.sign ? wall.axis : -1, lo, hi, most[0]);
  }
  return all;
}

/* How the sum is split, of spheres that there are, in a box that is periodic or open */
sd_status FarField::choose_split(const sd_ewald_box &box, const sd_ewald_sizes &sizes)
{
  const sd_wall &wall = settings.boundary.image_wall();
  const double tolerance = tolerance_of_sums();
  sd_status status;
  if (wall.sign)
    status = sd_ewald_choose_at_wall(&box, &wall, &sizes, tolerance, &ewald);
  else if (positive > 0.0 && box.periodic)
    status = sd_ewald_choose_positive(&box, &sizes, width(), tolerance, positive, &ewald);
  else
    status = sd_ewald_levels_choose(&box, &sizes, width(), tolerance, &ewald, &second_level);
  if (harmless_error() < (1.0 - 1e-9) * SD_EWALD_SINGLE) ewald.single = 0;
  ewald.box = box;
  return status;
}

void FarField::no_grid(double count, const std::string &where, sd_status status) const
{
  voice.fail("keyword far_field: no grid for Ewald sums of " + text(count) + " spheres " + where +
             " at far_field_tolerance " + text(settings.far_field_tolerance) + ": " + sd_status_string(status));
}

/* Of spheres of other ranks and images, near those of one; each: images of one sphere */
void FarField::refuse_images(double each, double images, double largest) const
{
  if (!(images < MOST_IMAGES && each < MOST_OF_EACH))
    voice.fail("keyword far_field: the largest sphere, radius " + text(largest) +
               ", is so large for the periodic box that it would see " + text(images) +
               " images; is it in other units?");
}

/* Is the sum over everybody split, and how? In an open box only if that costs less, or is asked
 * for; of a few spheres it is known without a look at them. The same on all ranks. */
bool FarField::split()
{
  if (settings.far_field == SceneSettings::DIRECT) return false;
  const bool must = periodic() || settings.far_field == SceneSettings::EWALD;
  const double points_here = shells.on() ? shells.first_of_rows()[scene.size()] : scene.size();
  if (!must && sum_of_all(world, points_here) <= SD_EWALD_FEWEST) return false;
  sd_ewald_box box = ewald.box;
  const sd_ewald_sizes sizes = measure(box);
  ewald.count = sizes.all.count;
  second_level = {};
  if (sizes.all.count == 0.0) return must;
  const sd_status status = choose_split(box, sizes);
  if (status != SD_OK && must)
    no_grid(sizes.all.count, "in a box of " + text(box.edge[0]) + " x " + text(box.edge[1]) + " x " +
            text(box.edge[2]), status);
  const double near = pow(ewald.reach, 3), far = pow(second_level.split.range, 3);
  const double a_volume = 8.0 / sd_ewald_volume(&box);
  if (box.periodic)
    refuse_images(a_volume * std::max(near, far), a_volume * sizes.all.count * std::max(near, second_level.count * far),
                  sizes.all.largest);
  const double all_pairs =
      sizes.all.count * sizes.all.count * (settings.boundary.image_wall().sign ? SD_PAIR_AT_WALL : 1.0);
  return must || (status == SD_OK && sd_ewald_levels_cost(&ewald, &second_level) < all_pairs);
}

const sd_mobility_engine *FarField::choose()
{
  if (settings.boundary.slab()) {
    split_slab();
    return &sd_mobility_slab;
  }
  if (!split()) return &sd_mobility_all_pairs;
  return second_level.from > 0.0 ? &sd_mobility_levels : &sd_mobility_ewald;
}

/* The points of all ranks */
sd_slab_spheres FarField::measure_slab(const sd_slab_walls &walls) const
{
  const sd_spheres s = scene.local();
  double bounds[4] = {0.0, 0.0, -INFINITY, -INFINITY};    // largest radius, 1/smallest; heights
  for (int k = 0; k < scene.size(); k++) {
    const double height = sd_slab_height(&walls, s.x + 3 * (size_t) k), outside = shells.extent(s.a[k]);
    if (!(s.a[k] > 0.0)) continue;
    bounds[0] = std::max(bounds[0], shells.grain(s.a[k]));
    bounds[1] = std::max(bounds[1], 1.0 / shells.grain(s.a[k]));
    bounds[2] = std::max(bounds[2], outside - height);
    bounds[3] = std::max(bounds[3], outside + height);
  }
  MPI_Allreduce(MPI_IN_PLACE, bounds, 4, MPI_DOUBLE, MPI_MAX, world);
  return {sizes_of_all(bounds[0]), bounds[1] > 0.0 ? 1.0 / bounds[1] : 0.0, -bounds[2], bounds[3]};
}

/* The slab of all spheres; there is no other way to sum it. */
void FarField::split_slab()
{
  const sd_slab_walls walls = settings.boundary.slab_walls();
  refuse_wide_spheres(voice, settings.boundary, scene.largest());
  const sd_slab_spheres all = measure_slab(walls);
  const sd_ewald_class &sizes = all.sizes.all;
  if (sizes.largest > SD_SLAB_RATIO * (1.0 + 1e-9) * all.smallest)
    voice.fail("keyword far_field: " + settings.boundary.where() +
               ", periodic along it, the largest radius must be at most " +
               text(SD_SLAB_RATIO) + " times the smallest, and they are " +
               text(scene.largest()) + " and " + text(scene.smallest()) +
               ": use group to select spheres");
  sd_ewald_box box = Lattice::of(domain).ewald_box();
  box.periodic = 1;
  const sd_status status = sd_slab_choose(&walls, &box, &all, tolerance_of_sums(), &slab);
  ewald = slab.ewald;
  second_level = {};
  const int axis = walls.wall->axis;
  if (status != SD_OK)
    no_grid(sizes.count, settings.boundary.where() + ", in a cell of " + text(box.edge[(axis + 1) % 3]) +
            " x " + text(box.edge[(axis + 2) % 3]) + " and heights from " + text(all.lo) + " to " +
            text(all.hi), status);
  const double area = ewald.count > 0.0 ? sd_ewald_volume(&ewald.box) / ewald.box.edge[axis] : 1.0;
  const double each = 4.0 * ewald.reach * ewald.reach / area;
  refuse_images(each, sizes.count * each, sizes.largest);
}

static std::string parameters_of(const sd_ewald &e)
{
  return "grid " + std::to_string(e.grid[0]) + " x " + std::to_string(e.grid[1]) + " x " +
      std::to_string(e.grid[2]) + ", windows of " + std::to_string(e.points) +
      " points, splitting parameter " + text(e.xi) + ", near part up to " + text(e.range);
}

/* The parameters, once a run and when they are others than those told last. */
void FarField::tell()
{
  if (!told.first_in(scene.all_epochs().run)) return;
  const sd_ewald &e = ewald;
  std::string now = "Far field by Ewald sums of " + text(e.count + second_level.count) +
      " spheres " +
      settings.boundary.summed() +
      (e.images.wall.sign ? " and their images in the wall" : "") + ": " + parameters_of(e);
  if (second_level.from > 0.0)
    now += "; " + text(second_level.count) + " spheres of radius " + text(second_level.from) +
        " and more on a second level: " + parameters_of(second_level.split);
  now += "; far_field_tolerance " + text(settings.far_field_tolerance) + (e.single ? ", in single precision\n" : "\n");
  if (now != said && comm->me == 0) utils::logmesg(lmp, now);
  said = now;
}

std::vector<double> FarField::open_box() const
{
  const sd_ewald_box &b = ewald.box;
  if (settings.boundary.slab()) return {slab.lo, slab.hi, slab.ewald.count, 0.0, 0.0, 0.0};
  if (b.periodic || b.edge[0] == 0.0) return {};
  return {b.origin[0], b.origin[1], b.origin[2], b.edge[0], b.edge[1], b.edge[2]};
}

void FarField::set_open_box(const std::vector<double> &box)
{
  ewald.box = {};
  slab.ewald.count = 0.0;
  if (box.size() != 6) return;
  if (settings.boundary.slab()) {
    slab.lo = box[0];
    slab.hi = box[1];
    slab.ewald.count = box[2];
    return;
  }
  std::copy_n(box.begin(), 3, ewald.box.origin);
  std::copy_n(box.begin() + 3, 3, ewald.box.edge);
}

}    // namespace StokesDyn
