#include "scene_at_boundary.h"

#include "ambient.h"
#include "boundary.h"
#include "keywords.h"
#include "ranks.h"
#include "scene.h"

#include "domain.h"

#include "sd_constants.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Less is what interpolation on a grid leaves of nothing. */
static const double RESTS = 1e-3;

void check_stream_at_walls(const Voice &voice, const Boundary &boundary, Ambient &ambient, bool films)
{
  for (int w = 0; w < boundary.walls; w++) {
    const sd_wall &wall = boundary.wall[w];
    double part[2];
    ambient.look_at_plane(wall.axis, wall.at, part);
    if (part[1] > RESTS)
      voice.at_step().fail("keyword fluid_velocity: nothing flows through the wall " + wall_name(wall) +
                           ", and its component " + axis_name(wall.axis) + " there is " + text(part[1]) +
                           " of the largest velocity: give one that is 0 at the wall");
    if (films && part[0] > RESTS)
      voice.at_step().fail("keyword fluid_velocity: the fluid moves along the wall " + wall_name(wall) +
                           ", where its velocity is " + text(part[0]) +
                           " of the largest, and the films of keyword lubrication are those of walls "
                           "at rest: give a velocity that is 0 at the wall, or lubrication no");
  }
}

/* Fewer spheres than are counted here cut both walls. */
static double cut_by(const Voice &voice, const Scene &scene, const sd_wall &wall, bool at_edge)
{
  const sd_spheres spheres = scene.local();
  const Domain *domain = voice.lmp->domain;
  double cut = 0.0;
  if (at_edge && wall.at != side_of_box(domain, wall))
    voice.at_step().fail("keyword wall: EDGE: that side of the box is at " +
                         text(side_of_box(domain, wall)) + " now and was at " + text(wall.at) +
                         " when the run began: walls do not move; give its position");
  for (int k = 0; k < scene.size(); k++) {
    const double height = sd_wall_height(&wall, spheres.x + 3 * (size_t) k);
    cut += height < spheres.a[k];
    if (height > 0.0) continue;
    voice.at_step().fail_one("keyword wall: the centre of atom " + std::to_string(scene.tag(k)) +
                             ", radius " + text(spheres.a[k]) + ", is " + text(0.0 - height) +
                             " behind the wall " + wall_name(wall) +
                             ": spheres must stand in "
                             "front of it; is it on the right side? A contact (fix wall/gran) or a "
                             "shorter time step keeps them there");
  }
  return cut;
}

void refuse_wide_spheres(const Voice &voice, const Boundary &boundary, double largest)
{
  const sd_wall *wall = boundary.wall;
  if (boundary.kind != Boundary::SLIT || 2.0 * largest <= wall[1].at - wall[0].at) return;
  voice.at_step().fail("keyword wall: the largest sphere, radius " + text(largest) +
                       ", does not fit "
                       "between " +
                       wall_name(wall[0]) + " and " + wall_name(wall[1]) +
                       ": the walls must be at least " + text(2.0 * largest) + " apart");
}

double spheres_cut_by_wall(const Voice &voice, const Scene &scene)
{
  const Boundary &boundary = scene.settings.boundary;
  double cut = 0.0;
  for (int w = 0; w < boundary.walls; w++)
    cut += cut_by(voice, scene, boundary.wall[w], boundary.at_edge[w]);
  return sum_of_all(voice.lmp->world, cut);
}

double least_lone_mobility(const Scene &scene)
{
  const Boundary &boundary = scene.settings.boundary;
  const sd_spheres spheres = scene.local();
  double least = 1.0;
  if (!boundary.walled()) return least;
  for (int k = 0; k < scene.size(); k++) {
    const double a = spheres.a[k], *x = spheres.x + 3 * (size_t) k;
    const sd_wall &wall = boundary.nearest(x);
    double image[9];
    sd_wall_block(&wall, 3, x, a, x, a, image);
    least = std::min(least, 1.0 + 6.0 * SD_PI * a * image[4 * wall.axis]);
  }
  return least;
}

void refuse_net_force(const Voice &voice, const Scene &scene, const std::vector<double> &F,
                      size_t width)
{
  const Boundary &boundary = scene.settings.boundary;
  if (boundary.kind != Boundary::LAYER) return;
  double sums[4] = {0.0};    // of forces along it, and of their sizes
  const int along[2] = {(boundary.across + 1) % 3, (boundary.across + 2) % 3};
  for (size_t k = 0; k < (size_t) scene.size(); k++)
    for (int d = 0; d < 2; d++) {
      sums[d] += F[width * k + along[d]];
      sums[2 + d] += std::fabs(F[width * k + along[d]]);
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, voice.lmp->world);
  for (int d = 0; d < 2; d++)
    if (std::fabs(sums[d]) > 1e-6 * sums[2 + d])
      voice.at_step().fail(
          "the forces along " + std::string(1, axis_name(along[d])) + " add up to " + text(sums[d]) +
          ": in a box without walls that is periodic in two "
          "directions a net force along it shears the fluid above and below without "
          "end" +
          Boundary::GIVE_WALLS + ", or forces that add up to 0");
}

}    // namespace StokesDyn
