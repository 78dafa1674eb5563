#include "shells.h"

#include "keywords.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Shells::make()
{
  sd_multiblob_shape_free(&lone);
  if (!settings.on()) return;
  sd_status status = sd_multiblob_create(settings.points, settings.one_body, &blob);
  if (status == SD_OK) status = sd_multiblob_shape_create(&blob, nullptr, &lone);
  if (status != SD_OK)
    fail_by(voice.of("keyword multiblob: '" + std::to_string(settings.points) + "'"), status);
  sd_squirmer_create(&blob, lone.points.inverse, &swimmer);
}

void Shells::take_root()
{
  const sd_status status = sd_body_shape_take_root(&lone.points);
  if (status != SD_OK) voice.of("keyword multiblob").fail_one(sd_status_string(status));
}

void Shells::free_rows(int n)
{
  static const double unity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  turn.resize(9 * (size_t) n + 9);
  mask.assign(n + 1, sd_multiblob_whole(&blob));
  for (int k = 0; k < n; k++) std::copy_n(unity, 9, &turn[9 * (size_t) k]);
}

void Shells::turn_row(int k, const double row[9], sd_multiblob_mask there)
{
  std::copy_n(row, 9, &turn[9 * (size_t) k]);
  mask[k] = there;
}

std::vector<double> Shells::sent(int n) const
{
  std::vector<double> rows(10 * (size_t) n + 10);
  for (size_t k = 0; k < (size_t) n; k++) {
    std::copy_n(&turn[9 * k], 9, &rows[10 * k]);
    rows[10 * k + 9] = (double) mask[k];
  }
  return rows;
}

void Shells::expand(int n, const std::vector<double> &rows, const sd_spheres &spheres)
{
  const size_t points = (size_t) n * blob.n;
  std::vector<double> turns(9 * (size_t) n + 9);
  std::vector<sd_multiblob_mask> whole(n + 1);
  for (size_t k = 0; k < (size_t) n; k++) {
    std::copy_n(&rows[10 * k], 9, &turns[9 * k]);
    whole[k] = (sd_multiblob_mask) rows[10 * k + 9];
  }
  const sd_multiblob_spheres s = {spheres.x, spheres.a, turns.data(), whole.data(), n};
  x.resize(3 * points + 3);
  b.resize(points + 1);
  w.resize(points + 1);
  sd_multiblob_expand(&blob, &s, nullptr, x.data(), b.data());
  for (size_t k = 0; k < points; k++) w[k] = spheres.w[k / blob.n];
}

double Shells::memory_usage() const
{
  return sizeof(double) *
      (double) (turn.capacity() + mask.capacity() + x.capacity() + b.capacity() + w.capacity());
}

}    // namespace StokesDyn
