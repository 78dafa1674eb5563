#include "halo.h"

#include "callback.h"

#include "sd_linear.h"
#include "sd_skin.h"

#include <algorithm>
#include <cmath>

namespace StokesDyn {

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

/* Does what is moved by so many edges go from rank `me` to p? What goes up by one sees from there what would
 * go down to it. */
static bool goes(Halo::Whom whom, int me, int p, double t, double u, double v)
{
  const double up = t != 0.0 ? t : u != 0.0 ? u : v;
  return whom == Halo::ALL || up > 0.0 || (whom == Halo::ABOVE ? up == 0.0 && p < me : up < 0.0 || p != me);
}

/* What of this rank, at f [3 n] in units of the edges, goes to the block `into` of rank p: each
 * sphere by the edges that take it there */
bool Halo::send_to(int p, const Lattice &lattice, const std::vector<double> &f, const double from[6],
                   const double into[6], Whom whom)
{
  const double most = std::max(MOST_COPIES, MOST_PER_SPHERE * (double) (f.size() / 3));
  double first[3], last[3], shifts = 1.0;
  for (int d = 0; d < 3; d++) {
    range_of_steps(lattice, d, from, into, first + d, last + d);
    shifts *= last[d] - first[d] + 1.0;
  }
  if (shifts > most) return false;
  for (size_t i = 0; i < f.size(); i += 3) {
    double begin[3], end[3];
    for (int d = 0; d < 3; d++) {
      begin[d] = std::max(first[d], std::ceil(into[d] - f[i + d]));
      end[d] = std::floor(into[3 + d] - f[i + d]);    // not a number where f is none: no step
      if (end[d] > last[d]) end[d] = last[d];
    }
    for (double t = begin[0]; t <= end[0]; t++)
      for (double u = begin[1]; u <= end[1]; u++)
        for (double v = begin[2]; v <= end[2]; v++) {
          if (!goes(whom, post.me, p, t, u, v)) continue;
          sphere.push_back((int) (i / 3));
          edges.insert(edges.end(), {(int) t, (int) u, (int) v});
        }
    if ((double) sphere.size() > most) return false;
  }
  return true;
}

void Halo::clear()
{
  post.partners.clear();
  sphere.clear();
  edges.clear();
  copies = 0;
  reached = 0.0;
}

/* f: the places in units of the edges */
Halo::Block Halo::around(const Lattice &lattice, const std::vector<double> &x,
                         std::vector<double> &f)
{
  Block block = {{INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}};
  double *face = block.face, from_origin[3];
  f.resize(x.size());
  for (size_t i = 0; i < x.size(); i += 3) {
    sd_minus(&x[i], lattice.origin, from_origin);
    sd_in_edges(lattice.h, from_origin, &f[i]);
    for (int d = 0; d < 3; d++) {
      face[d] = std::min(face[d], f[i + d]);
      face[3 + d] = std::max(face[3 + d], f[i + d]);
    }
  }
  return block;
}

bool Halo::find(const Lattice &lattice, double reach, const std::vector<double> &x, Whom whom)
{
  std::vector<double> f;
  const Block rows = around(lattice, x, f);
  return find(lattice, reach, rows, rows, f, whom);
}

/* Wherever the box begins */
static bool same_images(const Lattice &a, const Lattice &b)
{
  return std::equal(a.h, a.h + 6, b.h) && std::equal(a.periodic, a.periodic + 3, b.periodic);
}

/* A copy within reach of the rows now was within reach and a skin of them then, since it has moved as its sphere
 * has. Where that is left open, as of places that are no numbers, they do not hold. */
bool Halo::holds(const Lattice &lattice, double reach, const std::vector<double> &x, Whom whom) const
{
  const double spare = 0.5 * (reached - reach);
  bool all = x.size() == stood.size() && spare >= 0.0 && whom == whom_then && same_images(lattice, lattice_then);
  for (size_t i = 0; i < x.size() && all; i += 3) all = sd_distance_squared(&x[i], &stood[i]) <= spare * spare;
  return smallest_of_all(post.world, (int) all) == 1;
}

bool Halo::find_or_keep(const Lattice &lattice, double reach, const std::vector<double> &x, Whom whom)
{
  if (holds(lattice, reach, x, whom)) return true;
  const double wide = sd_with_skin(reach);
  if (!find(lattice, wide, x, whom)) return false;
  reached = wide;
  whom_then = whom;
  lattice_then = lattice;
  stood = x;
  return true;
}

bool Halo::find_around(const Lattice &lattice, double reach, const std::vector<double> &x,
                       const double lo[3], const double hi[3])
{
  std::vector<double> f, corners, of_corners;
  for (int k = 0; k < 8 && lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]; k++)
    for (int d = 0; d < 3; d++) corners.push_back(k >> d & 1 ? hi[d] : lo[d]);
  const Block rows = around(lattice, x, f), wanted = around(lattice, corners, of_corners);
  if (!find(lattice, reach, rows, wanted, f, ALL)) return false;
  post.tell();
  copies = post.rows_in();
  return true;
}

bool Halo::find(const Lattice &lattice, double reach, const Block &rows, const Block &wanted,
                const std::vector<double> &f, Whom whom)
{
  const Block mine[2] = {rows, wanted};
  std::vector<Block> all(2 * (size_t) post.ranks);    // of each rank
  MPI_Allgather(const_cast<Block *>(mine), 12, MPI_DOUBLE, all.data(), 12, MPI_DOUBLE, post.world);
  for (int p = 0; p < post.ranks; p++)
    for (int d = 0; d < 3; d++) {    // a pair at the reach itself is not lost by rounding
      double *wide = all[2 * (size_t) p + 1].face;
      const double more = sd_across_faces(lattice.h, d, reach * (1.0 + 1e-9));
      wide[d] -= more;
      wide[3 + d] += more;
    }
  const double *here = all[2 * (size_t) post.me + 1].face;
  clear();
  for (int p = 0; p < post.ranks; p++) {
    const double *theirs = all[2 * (size_t) p].face, *there = all[2 * (size_t) p + 1].face;
    const bool out = meets(lattice, rows.face, there);
    if (!out && !meets(lattice, theirs, here)) continue;
    const size_t before = sphere.size();
    if (out && !send_to(p, lattice, f, rows.face, there, whom)) return false;
    post.partners.push_back({p, (int) (sphere.size() - before), 0});
  }
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

void Halo::tell(const int *to, int *from) const
{
  Post numbers = post;
  for (Post::Partner &p : numbers.partners) p.out = to[p.rank];
  numbers.tell();
  std::fill_n(from, post.ranks, 0);
  for (const Post::Partner &p : numbers.partners) from[p.rank] = p.in;
}

Halo Halo::refined(const std::vector<int> &first) const
{
  Halo fine(post.world);
  size_t gone = 0, come = first.size() - 1 - copies;
  fine.copies = first.back() - first[come];
  for (const Post::Partner &p : post.partners) {
    const size_t before = fine.sphere.size();
    for (int k = 0; k < p.out; k++, gone++)
      for (int row = first[sphere[gone]]; row < first[sphere[gone] + 1]; row++)
        fine.sphere.push_back(row);
    fine.post.partners.push_back(
        {p.rank, (int) (fine.sphere.size() - before), first[come + p.in] - first[come]});
    come += p.in;
  }
  return fine;
}

void Halo::put_place(const double h[6], const double *x, size_t k, double *out) const
{
  for (int d = 0; d < 3; d++) out[d] = x ? x[3 * (size_t) sphere[k] + d] : 0.0;
  sd_add_edges(h, &edges[3 * k], out);
}

void Halo::place(const double h[6], const double *x, double *out) const
{
  outbox.resize(3 * sphere.size() + 1);
  for (size_t k = 0; k < sphere.size(); k++) put_place(h, x, k, &outbox[3 * k]);
  post.carry(outbox.data(), out, 3);
}

std::vector<double> Halo::above() const
{
  std::vector<double> out(copies + 1);
  outbox.resize(sphere.size() + 1);
  size_t k = 0;
  for (const Post::Partner &p : post.partners)
    for (int row = 0; row < p.out; row++, k++) {
      const int *moved = &edges[3 * k];
      outbox[k] = goes(ABOVE, post.me, p.rank, moved[0], moved[1], moved[2]);
    }
  post.carry(outbox.data(), out.data(), 1);
  return out;
}

void Halo::extend(const double h[6], std::vector<double> &x,
                  std::initializer_list<std::vector<double> *> columns)
{
  const size_t n = x.size() / 3, width = 3 + columns.size();
  outbox.resize(width * sphere.size() + 1);
  double *out = outbox.data();
  for (size_t k = 0; k < sphere.size(); k++) {
    put_place(h, x.data(), k, out);
    out += 3;
    for (const auto *column : columns) *out++ = (*column)[sphere[k]];
  }
  const std::vector<double> came = post.deliver(outbox.data(), (int) width);
  copies = post.rows_in();
  x.resize(3 * (n + copies));
  for (auto *column : columns) column->resize(n + copies);
  const double *in = came.data();
  for (size_t k = n; k < n + copies; k++) {
    std::copy_n(in, 3, &x[3 * k]);
    in += 3;
    for (auto *column : columns) (*column)[k] = *in++;
  }
}

sd_world Halo::ranks() const
{
  sd_world all = {};
  all.ctx = const_cast<Halo *>(this);
  all.me = post.me;
  all.ranks = post.ranks;
  all.sum = [](void *ctx, double *values, int count) {
    const MPI_Comm world = static_cast<Halo *>(ctx)->post.world;
    MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, world);
    return SD_OK;
  };
  all.refresh = [](void *ctx, const double *rows, double *copies, int width) {
    return callback([=] { static_cast<Halo *>(ctx)->refresh(rows, copies, width); });
  };
  all.reduce = [](void *ctx, const double *copies, double *rows, int width) {
    return callback([=] { static_cast<Halo *>(ctx)->reduce(copies, rows, width); });
  };
  all.tell = [](void *ctx, const int *to, int *from) {
    return callback([=] { static_cast<Halo *>(ctx)->tell(to, from); });
  };
  all.exchange = [](void *ctx, const double *send, const int *to, double *receive, const int *from) {
    const MPI_Comm world = static_cast<Halo *>(ctx)->post.world;
    return callback([=] { exchange_numbers(world, send, to, receive, from); });
  };
  return all;
}

double Halo::memory_usage() const
{
  return sizeof(int) * ((double) sphere.capacity() + edges.capacity()) +
      sizeof(double) * (double) (outbox.capacity() + stood.capacity());
}

}    // namespace StokesDyn
