#include "lubrication.h"

#include "keywords.h"

#include "sd_linear.h"
#include "sd_multiblob_wall.h"
#include "sd_wall_film.h"

#include "comm.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Lubrication::Lubrication(LAMMPS *lmp, const std::string &command) : Pointers(lmp), command(command)
{
}

Lubrication::~Lubrication()
{
  sd_lubrication_free(&near);
  sd_two_sphere_free(functions);
}

/* What may fail on one rank alone */
void Lubrication::check(sd_status status) const
{
  if (status != SD_OK)
    fail_one(lmp, command + ": keyword lubrication: " + sd_status_string(status));
}

/* Functions for all pairs that there are, made anew when radii become more different. */
void Lubrication::provide(double largest, double smallest)
{
  const double ratio = largest / smallest;
  if (shells && ratio > SD_FILM_LARGEST_RATIO)
    fail(lmp,
         command + ": keyword lubrication: radii from " + text(smallest) + " to " + text(largest) +
             ": with multiblob it knows pairs up to a ratio of 10; use group to select, or "
             "lubrication no");
  if (ratio <= largest_ratio) return;
  sd_two_sphere *wider = nullptr;
  const sd_status status = sd_two_sphere_create(ratio, &wider);
  if (status == SD_EOUTSIDE)
    fail(lmp,
         command + ": keyword lubrication: radii from " + text(smallest) + " to " + text(largest) +
             ": it knows pairs up to a ratio of 100; use group to select, or lubrication no");
  check(status);
  sd_two_sphere_free(functions);
  functions = wider;
  largest_ratio = ratio;
  if (shells) check(sd_films_create(shells->points, shells->one_body, functions, &films));
}

void Lubrication::place(Scene &where, const Ambient &ambient)
{
  if (where.largest() > 0.0) provide(where.largest(), where.smallest());
  u = where.rows(6, [&](int i, double *out) { ambient.fluid(i, out); });
  where.drift(u.data(), 6, 1.0);
  sd_lubrication_scene scene = {};
  scene.functions = functions;
  scene.films = shells ? &films : nullptr;
  scene.gap = settings.gap;
  scene.range = settings.range;
  scene.n = where.size();
  scene.n_all = where.size_with_copies();
  scene.spheres = where.local();
  scene.body = where.all_molecules().data();
  scene.u = u.data();
  scene.drift = where.drift_of_copies();
  scene.world.ctx = &where;
  scene.world.me = comm->me;
  scene.world.ranks = comm->nprocs;
  scene.world.refresh = Scene::refresh;
  scene.world.reduce = Scene::reduce;
  scene.world.sum = Scene::sum;
  check(sd_lubrication_place(&near, &scene));
  if (where.settings.wall.sign) add_wall(where);
}

/* The film of each sphere at its own height; its floor is in radii of the sphere. */
void Lubrication::add_wall(const Scene &where)
{
  const sd_wall &wall = where.settings.wall;
  const sd_spheres s = where.local();
  const sd_multiblob *model = shells ? &where.shells->model() : nullptr;
  std::vector<double> r(model ? 3 * model->n : 0), work(model ? sd_multiblob_wall_work(model) : 0);
  double normal[3] = {0.0};
  normal[wall.axis] = wall.sign;
  for (size_t k = 0; k < (size_t) where.size(); k++) {
    const double *x = s.x + 3 * k, *flow = &u[6 * k], eta = 1.0 / (s.w[k] * s.w[k]);
    double B[36], E[6];
    if (model) {
      for (int p = 0; p < model->n; p++) {
        sd_multiply3(where.shells->turns() + 9 * k, model->r + 3 * p, &r[3 * p]);
        for (int d = 0; d < 3; d++) r[3 * p + d] *= s.a[k];
      }
      check(sd_multiblob_wall_film(model, &wall, x, s.a[k], r.data(), shells->one_body, settings.gap,
                                   eta, flow, B, E, work.data()));
    } else {
      const sd_wall_film film = sd_wall_film_at(s.a[k], sd_wall_height(&wall, x), settings.gap);
      sd_wall_film_matrix(&film, normal, eta, B);
      sd_wall_film_flow(&film, normal, eta, flow, E);
    }
    sd_lubrication_add_own(&near, (int) k, B, E);
  }
}

void Lubrication::forces(const double *v, double *out)
{
  check(sd_lubrication_apply(&near, v, out));
  for (long j = 0; j < 6 * (long) near.n; j++) out[j] = near.carried[j] - out[j];
}

double Lubrication::memory_usage() const
{
  return sizeof(double) * (14.0 * near.count + 64.0 * near.n_all);
}

}    // namespace StokesDyn
