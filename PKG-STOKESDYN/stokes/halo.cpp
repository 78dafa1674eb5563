#include "halo.h"

#include "domain.h"

#include "sd_linear.h"

#include <algorithm>
#include <cmath>

namespace StokesDyn {

Lattice Lattice::of(const LAMMPS_NS::Domain *domain)
{
  Lattice l = {};
  const double tilt[3] = {domain->yz, domain->xz, domain->xy};
  std::copy_n(domain->boxlo, 3, l.origin);
  std::copy_n(domain->prd, 3, l.h);
  if (domain->triclinic) std::copy_n(tilt, 3, l.h + 3);
  for (int d = 0; d < 3; d++) l.periodic[d] = domain->periodicity[d] && d < domain->dimension;
  return l;
}

/* Fractions of this rank's rows, sorted into cells of its block, so that a search in a part of the
 * block looks at that part alone. */
struct Halo::Sorted {
  int n, cells;
  double lo[3], hi[3];
  std::vector<double> f;
  std::vector<int> first, order;

  Sorted(const Lattice &lattice, const std::vector<double> &x) : n((int) (x.size() / 3)), f(x.size())
  {
    std::fill_n(lo, 3, INFINITY);
    std::fill_n(hi, 3, -INFINITY);
    for (size_t i = 0; i < x.size(); i += 3) {
      double from_origin[3];
      sd_minus(&x[i], lattice.origin, from_origin);
      sd_in_edges(lattice.h, from_origin, &f[i]);
      for (int d = 0; d < 3; d++) {
        lo[d] = std::min(lo[d], f[i + d]);
        hi[d] = std::max(hi[d], f[i + d]);
      }
    }
    cells = std::max(1, std::min(64, (int) std::cbrt(n / 4.0)));
    first.assign((size_t) cells * cells * cells + 1, 0);
    order.resize(n);
    std::vector<int> cell_of(n);
    for (int i = 0; i < n; i++) {
      const double *fi = &f[3 * (size_t) i];
      cell_of[i] = (along(2, fi[2]) * cells + along(1, fi[1])) * cells + along(0, fi[0]);
      first[cell_of[i] + 1]++;
    }
    for (size_t c = 1; c < first.size(); c++) first[c] += first[c - 1];
    std::vector<int> next(first.begin(), first.end() - 1);
    for (int i = 0; i < n; i++) order[next[cell_of[i]]++] = i;
  }
  int along(int d, double f) const
  {
    const double q = cells * (f - lo[d]) / (hi[d] - lo[d]);
    return q >= cells ? cells - 1 : q > 0.0 ? (int) q : 0;    // not a number: 0
  }
};

/* The first and last step along d that brings something of one block into another; none where the
 * last is before the first. The same on the rank that sends and on the one that receives. */
static void range_of_steps(const Lattice &lattice, int d, const double from[6], const double into[6],
                           double *first, double *last)
{
  const bool filled = from[d] <= from[3 + d] && into[d] <= into[3 + d];
  const bool apart = into[d] > from[3 + d] || into[3 + d] < from[d];
  *first = 0.0;
  *last = filled && !apart ? 0.0 : -1.0;
  if (!filled || !lattice.periodic[d]) return;
  *first = std::ceil(into[d] - from[3 + d]);
  *last = std::floor(into[3 + d] - from[d]);
}

static bool meets(const Lattice &lattice, const double from[6], const double into[6])
{
  bool all = true;
  for (int d = 0; d < 3; d++) {
    double first, last;
    range_of_steps(lattice, d, from, into, &first, &last);
    all = all && first <= last;
  }
  return all;
}

static const double MOST_COPIES = 1e7, MOST_PER_SPHERE = 1000.0;

/* What of this rank goes to the block lo ... hi of rank p, by any step. */
bool Halo::send_to(int p, const double *lo, const double *hi, const Lattice &lattice,
                   const Sorted &s)
{
  const double most = std::max(MOST_COPIES, MOST_PER_SPHERE * s.n);
  const double from[6] = {s.lo[0], s.lo[1], s.lo[2], s.hi[0], s.hi[1], s.hi[2]};
  const double into[6] = {lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]};
  double first[3], last[3], shifts = 1.0;
  for (int d = 0; d < 3; d++) {
    range_of_steps(lattice, d, from, into, first + d, last + d);
    shifts *= last[d] - first[d] + 1.0;
  }
  if (shifts > most) return false;
  int t[3];
  for (t[0] = (int) first[0]; t[0] <= last[0]; t[0]++)
    for (t[1] = (int) first[1]; t[1] <= last[1]; t[1]++)
      for (t[2] = (int) first[2]; t[2] <= last[2]; t[2]++) {
        if (p == post.me && t[0] == 0 && t[1] == 0 && t[2] == 0) continue;
        int c0[3], c1[3];
        double a[3], b[3];
        for (int d = 0; d < 3; d++) {
          a[d] = lo[d] - t[d];
          b[d] = hi[d] - t[d];
          c0[d] = s.along(d, a[d]);
          c1[d] = s.along(d, b[d]);
        }
        for (int k = c0[2]; k <= c1[2]; k++)
          for (int j = c0[1]; j <= c1[1]; j++) {
            const int row = (k * s.cells + j) * s.cells;
            for (int m = s.first[row + c0[0]]; m < s.first[row + c1[0] + 1]; m++) {
              const double *f = &s.f[3 * (size_t) s.order[m]];
              if (!(f[0] >= a[0] && f[0] <= b[0] && f[1] >= a[1] && f[1] <= b[1] && f[2] >= a[2] &&
                    f[2] <= b[2]))
                continue;
              sphere.push_back(s.order[m]);
              steps.insert(steps.end(), t, t + 3);
            }
          }
        if ((double) sphere.size() > most) return false;
      }
  return true;
}

void Halo::clear()
{
  post.partners.clear();
  sphere.clear();
  steps.clear();
  copies = 0;
}

bool Halo::find(const Lattice &lattice, double reach, const std::vector<double> &x)
{
  const Sorted sorted(lattice, x);
  double mine[6];
  std::copy_n(sorted.lo, 3, mine);
  std::copy_n(sorted.hi, 3, mine + 3);
  std::vector<double> block(6 * (size_t) post.ranks), wide;
  MPI_Allgather(mine, 6, MPI_DOUBLE, block.data(), 6, MPI_DOUBLE, post.world);
  wide = block;
  for (size_t k = 0; k < wide.size(); k++)    // a pair at the reach itself is not lost by rounding
    wide[k] += (k % 6 < 3 ? -1.0 : 1.0) * sd_across_faces(lattice.h, k % 3, reach * (1.0 + 1e-9));
  clear();
  for (int p = 0; p < post.ranks; p++) {
    const double *theirs = &block[6 * (size_t) p], *wider = &wide[6 * (size_t) p];
    const bool out = meets(lattice, mine, wider);
    if (!out && !meets(lattice, theirs, &wide[6 * (size_t) post.me])) continue;
    const size_t before = sphere.size();
    if (out && !send_to(p, wider, wider + 3, lattice, sorted)) return false;
    post.partners.push_back({p, (int) (sphere.size() - before), 0});
  }
  post.tell();
  copies = post.rows_in();
  return true;
}

void Halo::refresh(const double *rows, double *out, int width) const
{
  outbox.resize((size_t) width * sphere.size() + 1);
  for (size_t k = 0; k < sphere.size(); k++)
    std::copy_n(rows + width * (size_t) sphere[k], width, &outbox[width * k]);
  post.carry(outbox.data(), out, width);
}

void Halo::reduce(const double *of_copies, double *rows, int width) const
{
  outbox.resize((size_t) width * sphere.size() + 1);
  post.reversed().carry(of_copies, outbox.data(), width);
  for (size_t k = 0; k < sphere.size(); k++)
    for (int d = 0; d < width; d++) rows[width * (size_t) sphere[k] + d] += outbox[width * k + d];
}

void Halo::place(const double h[6], const double *x, double *out) const
{
  outbox.assign(3 * sphere.size() + 1, 0.0);
  for (size_t k = 0; k < sphere.size(); k++) {
    if (x) std::copy_n(x + 3 * (size_t) sphere[k], 3, &outbox[3 * k]);
    sd_add_edges(h, &steps[3 * k], &outbox[3 * k]);
  }
  post.carry(outbox.data(), out, 3);
}

void Halo::extend(const double h[6], std::vector<double> &x,
                  std::initializer_list<std::vector<double> *> columns) const
{
  const size_t n = x.size() / 3, all = n + copies;
  x.resize(3 * all);
  place(h, x.data(), x.data() + 3 * n);
  for (auto *column : columns) {
    column->resize(all);
    refresh(column->data(), column->data() + n, 1);
  }
}

double Halo::memory_usage() const
{
  return sizeof(int) * ((double) sphere.capacity() + steps.capacity()) +
      sizeof(double) * (double) outbox.capacity();
}

}    // namespace StokesDyn
