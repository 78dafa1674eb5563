#include "cloud.h"

#include "copy.h"
#include "ranks.h"

#include "comm.h"

#include <algorithm>
#include <numeric>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Cloud::gather(const sd_spheres &own, const std::vector<int64_t> &tags, const std::vector<int64_t> &molecules,
                   const Epoch &rows)
{
  struct Sphere {
    double x[3], a, w;
    int64_t tag, molecule;
  };
  const bool many = comm->nprocs > 1;
  std::vector<Sphere> told;    // of one rank nobody need be
  for (size_t k = 0; k < tags.size() && many; k++)
    told.push_back({{own.x[3 * k], own.x[3 * k + 1], own.x[3 * k + 2]}, own.a[k], own.w[k], tags[k], molecules[k]});
  if (many) told = from_all(world, told);
  const auto tag_of = [&](size_t j) { return many ? told[j].tag : tags[j]; };
  spheres_of_rank = from_all(world, std::vector<int>(1, (int) tags.size()));
  n = many ? (int) told.size() : (int) tags.size();
  if (!sorted.is(rows)) {
    std::vector<int> by_tag(n);
    std::iota(by_tag.begin(), by_tag.end(), 0);
    std::sort(by_tag.begin(), by_tag.end(), [&](int p, int q) { return tag_of(p) < tag_of(q); });
    place_of.resize(n);
    for (int k = 0; k < n; k++) place_of[by_tag[k]] = k;
    sorted.set(rows);
  }
  x.resize(3 * (size_t) n);
  for (auto *v : {&a, &w}) v->resize(n);
  molecule.resize(n);
  const auto put = [&](size_t j, const double *place, double radius, double fluid, int64_t of_clump) {
    const size_t k = place_of[j];
    copy<3>(place, &x[3 * k]);
    a[k] = radius;
    w[k] = fluid;
    molecule[k] = of_clump;
  };
  if (many)
    for (size_t j = 0; j < told.size(); j++) put(j, told[j].x, told[j].a, told[j].w, told[j].molecule);
  else
    for (size_t j = 0; j < tags.size(); j++) put(j, &own.x[3 * j], own.a[j], own.w[j], molecules[j]);
}

size_t Cloud::own_rows_of(const int *first) const
{
  const int *spheres = spheres_of_rank.data(), mine = spheres[comm->me];
  const int begin = std::accumulate(spheres, spheres + comm->me, 0);
  size_t rows = 0;
  for (int j = begin; j < begin + mine; j++) rows += first[place_of[j] + 1] - first[place_of[j]];
  return rows;
}

void Cloud::to_all(const double *own_rows, double *rows, int width, const int *first) const
{
  const size_t m = width;
  std::vector<double> all;
  if (comm->nprocs > 1) {
    const size_t here = first ? own_rows_of(first) : spheres_of_rank[comm->me];
    all = from_all(world, std::vector<double>(own_rows, own_rows + m * here));
  }
  const double *from = comm->nprocs > 1 ? all.data() : own_rows;
  for (int j = 0; j < n; j++) {
    const size_t k = place_of[j], at = first ? first[k] : k, count = first ? first[k + 1] - at : 1;
    copy_row(m * count, from, rows + m * at);
    from += m * count;
  }
}

void Cloud::to_own(const double *rows, double *own_rows, int width, const int *first)
{
  const size_t m = width;
  in_order_of_rank.resize(m * (first ? first[n] : n) + 1);
  double *to = comm->nprocs > 1 ? in_order_of_rank.data() : own_rows;
  std::vector<int> counts;
  int j = 0;
  for (int spheres : spheres_of_rank) {
    const double *start = to;
    for (const int end = j + spheres; j < end; j++) {
      const size_t k = place_of[j], at = first ? first[k] : k, count = first ? first[k + 1] - at : 1;
      copy_row(m * count, rows + m * at, to);
      to += m * count;
    }
    counts.push_back(mpi_count((double) (to - start)));
  }
  if (comm->nprocs == 1) return;
  MPI_Reduce_scatter(in_order_of_rank.data(), own_rows, counts.data(), MPI_DOUBLE, MPI_SUM, world);
}

}    // namespace StokesDyn
