/* Of velocities: bodies near a wall, whose blocks are those of the place where they stand. */
#include "velocities.h"

#include "callback.h"
#include "keywords.h"
#include "settings.h"

#include "sd_linear.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Velocities::leave_wall()
{
  for (sd_body_shape &shape : standing) sd_body_shape_free(&shape);
  standing.clear();
}

/* Spheres of a body, in the order of its shape */
std::vector<int> Velocities::spheres_of(const sd_body &body) const
{
  const int points = scene.shells ? scene.shells->points() : 1;
  std::vector<int> rows;
  for (int k = 0; k < (body.shape ? body.shape->m : 1); k++)
    if (rows.empty() || rows.back() != body.row[k] / points) rows.push_back(body.row[k] / points);
  return rows;
}

sd_status Velocities::stand_at_wall(sd_body &body, double bodies)
{
  const sd_wall &wall = scene.settings.wall;
  const sd_spheres spheres = scene.local();
  const std::vector<int> rows = spheres_of(body);
  std::vector<double> x, a, turn;
  std::vector<sd_multiblob_mask> mask;
  double centre[3], extent = 0.0;
  sd_minus(spheres.x + 3 * (size_t) rows[0], &arm[3 * (size_t) rows[0]], centre);
  for (size_t k : rows) {
    x.insert(x.end(), spheres.x + 3 * k, spheres.x + 3 * k + 3);
    a.push_back(spheres.a[k]);
    extent = std::max(extent, std::sqrt(sd_dot(&arm[3 * k], &arm[3 * k])) + spheres.a[k]);
    if (!scene.shells) continue;
    turn.insert(turn.end(), scene.shells->turns() + 9 * k, scene.shells->turns() + 9 * k + 9);
    mask.push_back(scene.shells->masks()[k]);
  }
  const double height = sd_wall_height(&wall, centre);
  if (body.shape && !sd_body_wall_pays(body.shape->m, (int) bodies, height, extent)) return SD_OK;
  sd_body_shape shape;
  const sd_multiblob_spheres shells = {x.data(), a.data(), turn.data(), mask.data(),
                                       (int) rows.size()};
  const sd_status status = scene.shells
      ? sd_multiblob_wall_shape(&scene.shells->model(), &wall, &shells, centre, &shape)
      : sd_body_wall_shape(&wall, (int) rows.size(), 6, x.data(), a.data(), centre, &shape);
  if (status == SD_ESINGULAR && body.shape) return SD_OK;    // those of open space will do
  if (status != SD_OK) return status;
  standing.push_back(shape);
  body = {&standing.back(), {1, 0, 0, 0, 1, 0, 0, 0, 1}, 1.0, body.eta, body.row};
  return SD_OK;
}

/* The bodies have been arranged. */
void Velocities::stand_at_wall()
{
  double bodies = shaped.size();
  leave_wall();
  if (!scene.settings.wall.sign || !scene.settings.rotation) return;
  MPI_Allreduce(MPI_IN_PLACE, &bodies, 1, MPI_DOUBLE, MPI_SUM, world);
  standing.reserve(shaped.size());
  for (sd_body &body : shaped) {
    const sd_status status = stand_at_wall(body, bodies);
    if (status != SD_OK)
      fail_one(lmp,
               std::string(StokesSettings::COMMAND) +
                   ": keyword wall: blocks of a body: " + sd_status_string(status));
  }
}

}    // namespace StokesDyn
