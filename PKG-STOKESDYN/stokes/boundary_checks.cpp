#include "boundary_checks.h"

#include "ambient.h"
#include "fixes.h"
#include "keywords.h"
#include "ranks.h"
#include "scene.h"
#include "settings.h"

#include "domain.h"

#include "sd_constants.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const char AXES[] = "xyz";

// --- before a run --------------------------------------------------------------------------------

static double side_of_box(const Domain *domain, const sd_wall &wall)
{
  return wall.sign > 0 ? domain->boxlo[wall.axis] : domain->boxhi[wall.axis];
}

/* Is a side of a triclinic box at right angles to its axis? */
static bool upright(const Domain *domain, int axis)
{
  if (!domain->triclinic || axis == 2) return true;
  return axis == 1 ? domain->yz == 0.0 : domain->xy == 0.0 && domain->xz == 0.0;
}

static void find_edges(const Voice &voice, Boundary &boundary)
{
  const Domain *domain = voice.lmp->domain;
  for (int w = 0; w < boundary.walls; w++) {
    sd_wall &wall = boundary.wall[w];
    if (!boundary.at_edge[w]) continue;
    if (domain->boundary[wall.axis][wall.sign < 0] != 1)
      voice.fail("keyword wall: EDGE: that side of the box follows the spheres (boundary s or m): "
                 "give the position of the wall, or boundary f there");
    if (!upright(domain, wall.axis))
      voice.fail(
          "keyword wall: EDGE: that side of the box is tilted: give the position of the wall");
    wall.at = side_of_box(domain, wall);
  }
  if (boundary.walls == 2 && !(boundary.wall[0].at < boundary.wall[1].at))
    voice.fail("keyword wall: " + wall_name(boundary.wall[0]) + " must be below " +
               wall_name(boundary.wall[1]));
}

static void check_walls(const Voice &voice, const Boundary &boundary, int periodic)
{
  const Domain *domain = voice.lmp->domain;
  const int across = boundary.wall[0].axis;
  const std::string axis(1, AXES[across]);
  if (domain->periodicity[across])
    voice.fail("keyword wall: it needs boundary f, s or m across it, and " + axis +
               " is periodic: use " +
               boundary.letters() + ", or f f f");
  if (periodic == 1)
    voice.fail(
        "keyword wall: the box is periodic in one of the two directions along it: use " +
        boundary.letters() + ", or f f f");
  if (boundary.walls == 2 && periodic == 0)
    voice.fail(
        "keyword wall: between two walls the box must be periodic along them: use " +
        boundary.letters() +
        ", or leave out the farther wall (at 25 radii a wall changes "
        "velocities by 3 %)");
}

/* Without a cut-off */
static void check_periods(const Voice &voice, int periodic)
{
  if (periodic == 0) return;
  if (voice.lmp->domain->dimension == 2)
    voice.fail("keyword cut_off_distance: 'inf' in two dimensions requires boundary f f p (or s, m "
               "in x and y): there are no sums over periodic images of a plane");
  if (periodic == 1)
    voice.fail(
        "keyword cut_off_distance: 'inf' requires a box that is periodic in all three "
        "directions (boundary p p p), in two (p p f and the like) or in none: along a single "
        "row of images the flow of a net force has no limit. Use boundary p p p with the open "
        "directions long enough, or no periodic direction, or clumps_only yes");
}

static Boundary::Kind kind_of(const Boundary &boundary, int periodic, bool everybody)
{
  if (!everybody || periodic == 0) return boundary.walls ? Boundary::WALL : Boundary::OPEN;
  if (periodic == 3) return Boundary::PERIODIC;
  return boundary.walls == 2 ? Boundary::SLIT
      : boundary.walls == 1  ? Boundary::FLOOR
                             : Boundary::LAYER;
}

static void check_sums(const Voice &voice, const StokesSettings &s)
{
  if (s.scene.tensor == SD_TENSOR_OSEEN)
    voice.fail("keyword tensor: 'oseen' with cut_off_distance inf requires a box that is not "
               "periodic");
  if (s.scene.far_field == Scene::Settings::DIRECT)
    voice.fail("keywords far_field direct and precondition sparse require a box that is not "
               "periodic: only Ewald sums go over all periodic images");
}

/* What sums in a slab have not got */
static void check_slab(const Voice &voice, const StokesSettings &s)
{
  const Domain *domain = voice.lmp->domain;
  const std::string where = s.scene.boundary.where();
  if (s.scene.rotation && !s.shells.on())
    voice.fail("keyword rotation: yes: " + where +
               ", periodic along it, torques of one-point spheres are "
               "not summed: use multiblob 12 in its place, or rotation no");
  if (domain->triclinic && (domain->xy != 0.0 || domain->xz != 0.0 || domain->yz != 0.0))
    voice.fail(
        "a box that is periodic in two directions must not be tilted with cut_off_distance inf, "
        "and it has xy xz yz " +
        text(domain->xy) + " " + text(domain->xz) + " " + text(domain->yz));
  check_sums(voice, s);
}

static const std::string GIVE_WALLS =
    ": give the pair style a wall (a floor, or two walls), or use boundary p p p";

/* The stream must rest at a wall. */
static void check_stream(const Voice &voice, const sd_wall &wall, const Ambient::Settings &fluid)
{
  if (fluid.grid || fluid.box) return;
  for (int k = 1; k <= 3; k++) {    // the one across the wall last
    const int d = (wall.axis + k) % 3;
    const Field &u = fluid.velocity[d];
    if (u.is_variable() || u.number() == 0.0) continue;
    const std::string there = wall_name(wall) + ", and its component " + AXES[d] + " is '" +
        text(u.number()) + "' there: ";
    if (k == 3)
      voice.fail("keyword fluid_velocity: nothing flows through the wall " + there +
                 "give 0, or a variable that is 0 at the wall");
    voice.warn("keyword fluid_velocity: the fluid rests at the wall " + there +
               "a shear flow is a "
               "variable, such as RATE*(z-zlo)");
  }
}

void find_boundary(const Voice &voice, StokesSettings &settings)
{
  const Domain *domain = voice.lmp->domain;
  Scene::Settings &scene = settings.scene;
  Boundary &boundary = scene.boundary;
  const bool everybody = scene.everybody();
  int periodic = 0;
  for (int d = 0; d < domain->dimension; d++) periodic += domain->periodicity[d] != 0;
  if (boundary.walls) check_walls(voice, boundary, periodic);
  if (boundary.walls && periodic && !everybody)
    voice.fail(
        "keyword wall: in a box that is periodic along it, it requires cut_off_distance inf and "
        "clumps_only no: or use boundary f f f");
  if (everybody) check_periods(voice, periodic);
  boundary.kind = kind_of(boundary, periodic, everybody);
  for (int d = 0; d < 3 && boundary.slab(); d++)
    if (!domain->periodicity[d]) boundary.across = d;
  if (boundary.slab()) check_slab(voice, settings);
  if (boundary.kind == Boundary::PERIODIC) check_sums(voice, settings);
  find_edges(voice, boundary);
  for (int w = 0; w < boundary.walls; w++) check_stream(voice, boundary.wall[w], settings.ambient);
}

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
                           ", and its component " + AXES[wall.axis] + " there is " + text(part[1]) +
                           " of the largest velocity: give one that is 0 at the wall");
    if (films && part[0] > RESTS)
      voice.at_step().fail("keyword fluid_velocity: the fluid moves along the wall " + wall_name(wall) +
                           ", where its velocity is " + text(part[0]) +
                           " of the largest, and the films of keyword lubrication are those of walls "
                           "at rest: give a velocity that is 0 at the wall, or lubrication no");
  }
}

/* A force along a layer shears the fluid beyond it without end. */
void check_layer(const Voice &voice, const StokesSettings &s, bool overdamped)
{
  if (s.scene.boundary.kind != Boundary::LAYER) return;
  if (!overdamped)
    voice.fail(
        "boundary: in a box without walls that is periodic in two directions drags that follow "
        "from velocities have a net force along it, which shears the fluid above and below "
        "without end" +
        GIVE_WALLS + ", or fix stokes_dynamics/overdamped");
  if (s.shells.on() || s.rigid.on)
    voice.fail("boundary: in a box without walls that is periodic in two directions multiblobs and "
               "rigid clumps are not available" +
               GIVE_WALLS);
}

void refuse_in_layer(const Voice &voice, const Boundary &boundary, const std::string &holds, bool noisy)
{
  if (boundary.kind != Boundary::LAYER) return;
  if (!holds.empty())
    voice.fail(
        holds + ": in a box without walls that is periodic in two directions spheres that are held "
        "have a net force along it, which shears the fluid above and below without end" +
        GIVE_WALLS);
  if (noisy)
    voice.fail("keyword temperature: in a box without walls that is periodic in two directions the "
               "diffusion of all spheres together along it has no bound" +
               GIVE_WALLS);
}

void refuse_moving_box(const Voice &voice, const Boundary &boundary)
{
  if (!boundary.slab()) return;
  for (int k = 0; k < voice.lmp->modify->nfix; k++) {
    const Fix *fix = voice.lmp->modify->fix[k];
    if (!(fix->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE))) continue;
    voice.fail(
        "boundary: " + name_of(fix) + " changes the box, and " + boundary.where() +
        ", periodic "
        "along it, boxes must stay as they are: leave it out, or use boundary p p p without wall");
  }
}

// --- in every step -------------------------------------------------------------------------------

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
    sd_wall_block(&wall, 3, x, a, x, a, 1.0, image);
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
          "the forces along " + std::string(1, AXES[along[d]]) + " add up to " + text(sums[d]) +
          ": in a box without walls that is periodic in two "
          "directions a net force along it shears the fluid above and below without "
          "end" +
          GIVE_WALLS + ", or forces that add up to 0");
}

}    // namespace StokesDyn
