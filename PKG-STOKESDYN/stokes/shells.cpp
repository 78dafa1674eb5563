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
    voice.fail("keyword multiblob: '" + std::to_string(settings.points) + "': " +
               sd_status_string(status));
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

void Shells::put(int n, const sd_spheres &spheres)
{
  const size_t points = (size_t) n * blob.n;
  const sd_multiblob_spheres s = {spheres.x, spheres.a, turn.data(), mask.data(), n};
  x.resize(3 * points + 3);
  b.resize(points + 1);
  w.resize(points + 1);
  sd_multiblob_expand(&blob, &s, nullptr, x.data(), b.data());
  for (size_t k = 0; k < points; k++) w[k] = spheres.w[k / blob.n];
}

void Shells::expand(const Halo &halo, int n_all, const sd_spheres &spheres)
{
  const int n = n_all - halo.count();
  if (n_all > n) {
    const std::vector<double> rows = sent(n);
    std::vector<double> copies(10 * (size_t) (n_all - n) + 10);
    halo.refresh(rows.data(), copies.data(), 10);
    turn.resize(9 * (size_t) n_all + 9);
    mask.resize(n_all + 1);
    for (int k = n; k < n_all; k++)
      turn_row(k, &copies[10 * (size_t) (k - n)],
               (sd_multiblob_mask) copies[10 * (size_t) (k - n) + 9]);
  }
  put(n_all, spheres);
}

void Shells::expand_cloud(int n, const double *rows, const sd_spheres &spheres)
{
  const std::vector<double> own_turn = turn;
  const std::vector<sd_multiblob_mask> own_mask = mask;
  turn.resize(9 * (size_t) n + 9);
  mask.resize(n + 1);
  for (int k = 0; k < n; k++)
    turn_row(k, rows + 10 * (size_t) k, (sd_multiblob_mask) rows[10 * (size_t) k + 9]);
  put(n, spheres);
  turn = own_turn;
  mask = own_mask;
}

double Shells::memory_usage() const
{
  return sizeof(double) *
      (double) (turn.capacity() + mask.capacity() + x.capacity() + b.capacity() + w.capacity());
}

}    // namespace StokesDyn
