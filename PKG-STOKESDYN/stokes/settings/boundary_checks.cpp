#include "boundary_checks.h"

#include "ambient.h"
#include "fixes.h"
#include "keywords.h"
#include "settings.h"

#include "domain.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

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
  const std::string axis(1, axis_name(across));
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
  if (s.scene.far_field == SceneSettings::DIRECT)
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

/* The stream must rest at a wall. */
static void check_stream(const Voice &voice, const sd_wall &wall, const Ambient::Settings &fluid)
{
  if (fluid.grid || fluid.box) return;
  for (int k = 1; k <= 3; k++) {    // the one across the wall last
    const int d = (wall.axis + k) % 3;
    const Field &u = fluid.velocity[d];
    if (u.is_variable() || u.number() == 0.0) continue;
    const std::string there = wall_name(wall) + ", and its component " + axis_name(d) + " is '" +
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
  SceneSettings &scene = settings.scene;
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

/* A force along a layer shears the fluid beyond it without end. */
void check_layer(const Voice &voice, const StokesSettings &s, bool overdamped)
{
  if (s.scene.boundary.kind != Boundary::LAYER) return;
  if (!overdamped)
    voice.fail(
        "boundary: in a box without walls that is periodic in two directions drags that follow "
        "from velocities have a net force along it, which shears the fluid above and below "
        "without end" +
        Boundary::GIVE_WALLS + ", or fix stokes_dynamics/overdamped");
  if (s.shells.on() || s.rigid.on)
    voice.fail("boundary: in a box without walls that is periodic in two directions multiblobs and "
               "rigid clumps are not available" +
               Boundary::GIVE_WALLS);
}

void refuse_in_layer(const Voice &voice, const Boundary &boundary, const std::string &holds, bool noisy)
{
  if (boundary.kind != Boundary::LAYER) return;
  if (!holds.empty())
    voice.fail(
        holds + ": in a box without walls that is periodic in two directions spheres that are held "
        "have a net force along it, which shears the fluid above and below without end" +
        Boundary::GIVE_WALLS);
  if (noisy)
    voice.fail("keyword temperature: in a box without walls that is periodic in two directions the "
               "diffusion of all spheres together along it has no bound" +
               Boundary::GIVE_WALLS);
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

}    // namespace StokesDyn
