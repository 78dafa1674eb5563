#include "lubrication.h"

#include "ambient.h"
#include "keywords.h"
#include "scene.h"

#include "sd_linear.h"
#include "sd_lubrication_noise.h"
#include "sd_multiblob_wall.h"
#include "sd_wall_film.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* What may fail on one rank alone */
void Lubrication::check(sd_status status) const
{
  if (status != SD_OK)
    voice.of("keyword lubrication").fail_one(sd_status_string(status));
}

/* Functions for all pairs that there are, made anew when radii become more different, and films of
 * the shells that spheres are now: another pair_style may have come in between. */
void Lubrication::provide(double largest, double smallest)
{
  const double ratio = largest / smallest;
  const bool halves = shells.on() && shells.halves();
  const int points = shells.settings.points, one_body = shells.settings.one_body;
  const std::array<int, 3> kind = {points, one_body, halves};
  if (shells.on() && ratio > SD_FILM_LARGEST_RATIO)
    voice.fail("keyword lubrication: radii from " + text(smallest) + " to " + text(largest) +
               ": with multiblob lubrication is for ratios of radii up to 10; use group to select "
               "spheres, or lubrication no");
  if (ratio > largest_ratio) {
    sd_two_sphere *wider = nullptr;
    const sd_status status = sd_two_sphere_create(ratio, &wider);
    if (status == SD_EOUTSIDE)
      voice.fail("keyword lubrication: radii from " + text(smallest) + " to " + text(largest) +
                 ": lubrication is for ratios of radii up to 100; use group to select spheres, or "
                 "lubrication no");
    check(status);
    functions.reset(wider);
    largest_ratio = ratio;
    films.exact = nullptr;
  }
  if (!shells.on() || (films.exact && kind == kind_of_films)) return;
  check(halves ? sd_films_create_by_radius(one_body, functions.get(), &films)
               : sd_films_create(points, one_body, functions.get(), &films));
  kind_of_films = kind;
}

/* places [3 n]: of the rows */
void Lubrication::surround(const Scene &where, const double *places)
{
  const size_t n = where.size();
  const sd_spheres rows = where.local();
  const Lattice lattice = Lattice::of(domain);
  x.assign(places, places + 3 * n);
  a.assign(rows.a, rows.a + n);
  w.assign(rows.w, rows.w + n);
  if (!halo.find_or_keep(lattice, (2.0 + settings.range) * where.largest(), x))
    voice.fail_one("keyword lubrication: the largest radius, " + text(where.largest()) +
                   ", reaches more than 1000 images of each sphere and 1e7 in all; is it in other units?");
  halo.extend(lattice.h, x, {&a, &w});
  above = halo.above();
  drift.assign(where.drift_of_images() ? 3 * (size_t) halo.count() + 3 : 0, 0.0);
  if (where.drift_of_images()) halo.place(where.drift_of_images(), nullptr, drift.data());
}

void Lubrication::place(const Scene &where, const Ambient *fluid, bool noisy)
{
  surround(where, where.local().x);
  place_films(where, fluid, noisy);
  for (int k = 0; k < where.settings.boundary.walls; k++) add_wall(where, where.settings.boundary.wall[k]);
}

void Lubrication::place_at(const Scene &where, const std::vector<double> &places)
{
  surround(where, places.data());
  place_films(where, nullptr, false);
}

/* In these surroundings */
void Lubrication::place_films(const Scene &where, const Ambient *fluid, bool noisy)
{
  const bool halves = shells.on() && shells.halves();
  if (where.largest() > 0.0) provide(where.largest(), where.smallest());
  const bool asks_flow = !shells.on() || where.settings.boundary.walls > 0;
  if (asks_flow) u.assign(6 * (size_t) where.size() + 6, 0.0);
  if (asks_flow && fluid) {
    u = where.rows(6, [&](int i, double *out) { fluid->fluid(i, out); });
    where.drift(u.data(), 6, 1.0);
  }
  sd_lubrication_scene scene = {};
  scene.functions = functions.get();
  scene.films = shells.on() ? &films : nullptr;
  points.clear();
  for (size_t k = 0; k < a.size() && halves; k++) points.push_back(shells.points(a[k]));
  scene.points = halves ? points.data() : nullptr;
  scene.gap = settings.gap;
  scene.range = settings.range;
  scene.n = where.size();
  scene.n_all = (int) a.size();
  scene.spheres = {x.data(), a.data(), w.data()};
  scene.body = where.all_molecules().data();
  scene.u = shells.on() ? nullptr : u.data();
  scene.drift = !fluid || drift.empty() ? nullptr : drift.data();
  scene.noisy = noisy;
  scene.world = halo.ranks();
  check(sd_lubrication_place(&near, &scene));
}

/* The film of each sphere at its own height (those of two walls add up, since the points of a shell know
 * both walls already); its floor is in radii of the sphere. */
void Lubrication::add_wall(const Scene &where, const sd_wall &wall)
{
  const sd_spheres s = where.local();
  std::vector<double> r, b;
  double normal[3] = {0.0};
  normal[wall.axis] = wall.sign;
  for (size_t k = 0; k < (size_t) where.size(); k++) {
    const double *x = s.x + 3 * k, *flow = &u[6 * k], eta = 1.0 / (s.w[k] * s.w[k]);
    double B[36], E[6];
    if (shells.on()) {
      const sd_multiblob *model = &shells.model_of(s.a[k]);
      const sd_multiblob_spheres one = {x, s.a + k, shells.turn_of(k), nullptr, 1, nullptr, nullptr};
      r.resize(3 * model->n);
      b.resize(model->n);
      sd_multiblob_expand(model, &one, r.data(), nullptr, b.data());
      const sd_multiblob_sphere sphere = {model, x, s.a[k], r.data(), shells.settings.one_body};
      check(sd_multiblob_wall_film(&sphere, &wall, settings.gap, eta, flow, B, E));
    } else {
      const sd_wall_film film = sd_wall_film_at(s.a[k], sd_wall_height(&wall, x), settings.gap);
      sd_wall_film_matrix(&film, normal, eta, B);
      sd_wall_film_flow(&film, normal, eta, flow, E);
    }
    sd_lubrication_add_own(&near, (int) k, B, E);
  }
}

/* Whose pair it is, whoever asks: by the lower tag, and by which of all images the two see each
 * other */
struct Pairs {
  sd_random_key key;
  std::vector<double> tags;
  const double *x;
  Lattice lattice;
};

/* By how many edges the second stands off the closest place, counted otherwise than by halves,
 * where two places of a lattice are equally close */
static void image_of(const Lattice &lattice, const double r[3], int steps[3])
{
  double f[3];
  sd_in_edges(lattice.h, r, f);
  for (int d = 0; d < 3; d++) steps[d] = lattice.periodic[d] ? (int) floor(f[d] + 0.5123) : 0;
}

static int draw_pair(void *ctx, int i, int at, double g[12])
{
  const Pairs &pairs = *static_cast<Pairs *>(ctx);
  const int64_t one = ubuf(pairs.tags[i]).i, other = ubuf(pairs.tags[at]).i;
  double r[3];
  int steps[3], first = one <= other;
  if (first)
    sd_minus(pairs.x + 3 * (size_t) at, pairs.x + 3 * (size_t) i, r);
  else
    sd_minus(pairs.x + 3 * (size_t) i, pairs.x + 3 * (size_t) at, r);
  image_of(pairs.lattice, r, steps);
  if (one == other) {    // an image of itself: which of the two stands higher
    for (int d = 2; d >= 0; d--)
      if (steps[d] != 0) first = steps[d] > 0;
    for (int d = 0; d < 3 && !first; d++) steps[d] = -steps[d];
  }
  uint32_t which = 0;
  for (int step : steps) which = 1024 * which + (uint32_t) (step + 512);
  const uint64_t tag = sd_random_pair(std::min(one, other), std::max(one, other), which);
  sd_random_normals(&pairs.key, tag, 12, g);
  return first;
}

sd_status Lubrication::draw(const Scene &where, const sd_random_key &key, double *F) const
{
  const size_t n = where.size();
  Pairs pairs = {key, std::vector<double>(a.size() + 1), x.data(), Lattice::of(domain)};
  for (size_t k = 0; k < n; k++) pairs.tags[k] = ubuf(where.tag((int) k)).d;
  halo.refresh(pairs.tags.data(), &pairs.tags[n], 1);    // on all ranks: who has no copies may be copied
  return sd_lubrication_noise(&near, draw_pair, &pairs, F);
}

void Lubrication::forces(const double *v, double *out)
{
  check(sd_lubrication_forces(&near, v, out));
}

double Lubrication::memory_usage() const
{
  return sizeof(double) * (14.0 * near.count + 70.0 * near.n_all) + halo.memory_usage();
}

}    // namespace StokesDyn
