#include "lubrication.h"

#include "callback.h"
#include "keywords.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Lubrication::Lubrication(LAMMPS *lmp, const std::string &command) :
    Pointers(lmp), command(command), images(lmp->world)
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
}

/* The largest radius of all, 0: there is no sphere */
double Lubrication::measure()
{
  double most[2] = {0.0, -INFINITY};
  for (double radius : a) {
    most[0] = std::max(most[0], radius);
    most[1] = std::max(most[1], -radius);
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
  if (most[0] > 0.0) provide(most[0], -most[1]);
  return most[0];
}

void Lubrication::place(const Ambient &ambient)
{
  const std::vector<int> &who = ambient.who();
  const size_t n = who.size();
  x.resize(3 * n);
  a.resize(n);
  w.resize(n);
  u.resize(6 * n + 6);
  body.assign(n + 1, 0);
  for (size_t k = 0; k < n; k++) {
    const int i = who[k];
    std::copy_n(atom->x[i], 3, &x[3 * k]);
    a[k] = atom->radius[i];
    w[k] = 1.0 / sqrt(ambient.viscosity(i));
    ambient.fluid(i, &u[6 * k]);
    if (atom->molecule) body[k] = atom->molecule[i];
  }
  const double largest = measure();
  images.find(periodic_box(domain), (2.0 + settings.range) * largest, x, a, w);
  sd_lubrication_scene scene = {};
  scene.functions = functions;
  scene.gap = settings.gap;
  scene.range = settings.range;
  scene.n = n;
  scene.n_all = a.size();
  scene.spheres = {x.data(), a.data(), w.data()};
  scene.body = body.data();
  scene.u = u.data();
  scene.world.ctx = this;
  scene.world.me = comm->me;
  scene.world.ranks = comm->nprocs;
  scene.world.refresh = [](void *ctx, const double *rows, double *others, int width) {
    return callback([=] {
      static_cast<Lubrication *>(ctx)->images.refresh(rows, others, width);
      return SD_OK;
    });
  };
  scene.world.sum = [](void *ctx, double *values, int count) {
    MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM,
                  static_cast<Lubrication *>(ctx)->world);
    return SD_OK;
  };
  check(sd_lubrication_place(&near, &scene));
}

void Lubrication::forces(const double *v, double *out)
{
  check(sd_lubrication_apply(&near, v, out));
  for (long j = 0; j < 6 * (long) near.n; j++) out[j] = near.carried[j] - out[j];
}

double Lubrication::memory_usage() const
{
  return sizeof(double) * (14.0 * near.count + 64.0 * near.n_all) + images.memory_usage();
}

}    // namespace StokesDyn
