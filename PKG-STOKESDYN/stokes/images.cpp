#include "images.h"

#include "domain.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace StokesDyn {

void exchange_numbers(MPI_Comm world, const double *send, const int *to, double *receive,
                      const int *from)
{
  int ranks;
  MPI_Comm_size(world, &ranks);
  std::vector<int> to_at(ranks, 0), from_at(ranks, 0);
  for (int p = 1; p < ranks; p++) {
    to_at[p] = to_at[p - 1] + to[p - 1];
    from_at[p] = from_at[p - 1] + from[p - 1];
  }
  MPI_Alltoallv(const_cast<double *>(send), const_cast<int *>(to), to_at.data(), MPI_DOUBLE,
                receive, const_cast<int *>(from), from_at.data(), MPI_DOUBLE, world);
}

sd_ewald_box periodic_box(const LAMMPS_NS::Domain *domain)
{
  sd_ewald_box box = {};
  box.periodic = domain->xperiodic && domain->yperiodic && domain->zperiodic;
  std::copy_n(domain->boxlo, 3, box.origin);
  std::copy_n(domain->prd, 3, box.edge);
  const double tilt[3] = {domain->xy, domain->xz, domain->yz};
  if (domain->triclinic) std::copy_n(tilt, 3, box.tilt);
  return box;
}

Images::Images(MPI_Comm world) : world(world)
{
  MPI_Comm_rank(world, &me);
  MPI_Comm_size(world, &ranks);
}

namespace {
  /* Positions in units of the box's edges, so that its faces are planes of equal coordinates. */
  struct Fractions {
    const sd_ewald_box &box;

    void of(const double *x, double *f) const
    {
      const double *L = box.edge, *tilt = box.tilt;
      f[2] = (x[2] - box.origin[2]) / L[2];
      f[1] = (x[1] - box.origin[1] - tilt[2] * f[2]) / L[1];
      f[0] = (x[0] - box.origin[0] - tilt[0] * f[1] - tilt[1] * f[2]) / L[0];
    }
    void move(double *x, const int *step) const
    {
      const double *L = box.edge, *tilt = box.tilt;
      x[0] += step[0] * L[0] + step[1] * tilt[0] + step[2] * tilt[1];
      x[1] += step[1] * L[1] + step[2] * tilt[2];
      x[2] += step[2] * L[2];
    }
    /* A length across the faces of edge d, which are volume / (their area) apart. */
    double across(int d, double length) const
    {
      const double *L = box.edge, xy = box.tilt[0], xz = box.tilt[1], yz = box.tilt[2];
      const double s = xy * yz / L[1] - xz;
      if (d == 2) return length / L[2];
      if (d == 1) return length / L[1] * std::hypot(1.0, yz / L[2]);
      return length / L[0] * std::hypot(1.0, std::hypot(xy / L[1], s / L[2]));
    }
  };
}    // namespace

/* Blocks of fractions of all ranks, lo [3] and hi [3] of each, as their spheres fill them */
std::vector<double> Images::blocks(const sd_ewald_box &box, const std::vector<double> &x) const
{
  const Fractions fractions = {box};
  std::vector<double> all(6 * (size_t) ranks);
  double mine[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}, f[3];
  for (size_t i = 0; i < x.size(); i += 3) {
    fractions.of(&x[i], f);
    for (int d = 0; d < 3; d++) {
      mine[d] = std::min(mine[d], f[d]);
      mine[3 + d] = std::max(mine[3 + d], f[d]);
    }
  }
  MPI_Allgather(mine, 6, MPI_DOUBLE, all.data(), 6, MPI_DOUBLE, world);
  return all;
}

/* Who goes where: an image goes to a rank whose spheres it may be near, that is, whose block of
 * fractions, wider by the reach, holds it. */
void Images::choose(const sd_ewald_box &box, double reach, const std::vector<double> &x)
{
  const Fractions fractions = {box};
  std::vector<double> block = blocks(box, x);
  for (size_t k = 0; k < block.size(); k++)
    block[k] += (k % 6 < 3 ? -1.0 : 1.0) * fractions.across(k % 3, reach);
  std::vector<std::vector<int>> spheres_to(ranks), steps_to(ranks);
  for (size_t i = 0; i < x.size() / 3; i++) {
    double f[3];
    fractions.of(&x[3 * i], f);
    for (int p = 0; p < ranks; p++) {
      const double *lo = &block[6 * (size_t) p], *hi = lo + 3;
      int first[3], last[3], s[3];
      for (int d = 0; d < 3; d++) {    // none: a rank without spheres
        const bool inside = f[d] >= lo[d] && f[d] <= hi[d];
        first[d] = box.periodic && lo[d] <= hi[d] ? (int) std::ceil(lo[d] - f[d]) : inside ? 0 : 1;
        last[d] = box.periodic && lo[d] <= hi[d] ? (int) std::floor(hi[d] - f[d]) : 0;
      }
      for (s[0] = first[0]; s[0] <= last[0]; s[0]++)
        for (s[1] = first[1]; s[1] <= last[1]; s[1]++)
          for (s[2] = first[2]; s[2] <= last[2]; s[2]++) {
            if (p == me && s[0] == 0 && s[1] == 0 && s[2] == 0) continue;
            spheres_to[p].push_back(i);
            steps_to[p].insert(steps_to[p].end(), s, s + 3);
          }
    }
  }
  to.resize(ranks);
  sphere.clear();
  steps.clear();
  for (int p = 0; p < ranks; p++) {
    to[p] = spheres_to[p].size();
    sphere.insert(sphere.end(), spheres_to[p].begin(), spheres_to[p].end());
    steps.insert(steps.end(), steps_to[p].begin(), steps_to[p].end());
  }
  from.resize(ranks);
  MPI_Alltoall(to.data(), 1, MPI_INT, from.data(), 1, MPI_INT, world);
}

/* row(k, out) writes what goes of the k-th sphere that goes. */
template <class Row> void Images::send(int width, const Row &row, double *images)
{
  out.resize((size_t) width * sphere.size() + 1);
  for (size_t k = 0; k < sphere.size(); k++) row(k, &out[width * k]);
  std::vector<int> numbers_to(to), numbers_from(from);
  for (int p = 0; p < ranks; p++) {
    numbers_to[p] *= width;
    numbers_from[p] *= width;
  }
  exchange_numbers(world, out.data(), numbers_to.data(), images, numbers_from.data());
}

void Images::find(const sd_ewald_box &box, double reach, std::vector<double> &x,
                  std::vector<double> &a, std::vector<double> &w)
{
  choose(box, reach, x);
  const Fractions fractions = {box};
  const size_t count = std::accumulate(from.begin(), from.end(), (size_t) 0);
  std::vector<double> images(5 * count + 1);
  send(
      5,
      [&](size_t k, double *row) {
        const int i = sphere[k];
        std::copy_n(&x[3 * (size_t) i], 3, row);
        fractions.move(row, &steps[3 * k]);
        row[3] = a[i];
        row[4] = w[i];
      },
      images.data());
  x.reserve(x.size() + 3 * count);    // and not twice as much, as they grow by themselves
  a.reserve(a.size() + count);
  w.reserve(w.size() + count);
  for (size_t g = 0; g < count; g++) {
    const double *row = &images[5 * g];
    x.insert(x.end(), row, row + 3);
    a.push_back(row[3]);
    w.push_back(row[4]);
  }
}

void Images::refresh(const double *rows, double *images, int width)
{
  send(
      width,
      [&](size_t k, double *row) {
        std::copy_n(rows + width * (size_t) sphere[k], width, row);
      },
      images);
}

double Images::memory_usage() const
{
  return sizeof(int) * ((double) sphere.capacity() + steps.capacity()) +
      sizeof(double) * (double) out.capacity();
}

}    // namespace StokesDyn
