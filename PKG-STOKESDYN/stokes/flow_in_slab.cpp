#include "flow_in_slab.h"

#include "hydrodynamics.h"
#include "keywords.h"
#include "ranks.h"

#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Of a speck, over the smallest radius: it goes along with the fluid but for its square. */
static const double SPECK = 1e-4;
/* A speck does not average over a sphere, as spheres do: the same splitting leaves it a larger error. */
static const double AT_SPECKS = 0.3;
/* Of this rank in a piece, at least */
static const double FEWEST = 200.0;

/* These spheres of all ranks and as many specks, at the heights of all */
sd_slab_spheres FlowInSlab::with_specks(MPI_Comm world, const sd_slab_walls &walls, const Piece &sources,
                                        const std::vector<double> &x)
{
  double bounds[4] = {0.0, 0.0, -INFINITY, -INFINITY};    // largest, 1/smallest; heights
  for (double a : sources.a) {
    bounds[0] = std::max(bounds[0], a);
    bounds[1] = std::max(bounds[1], 1.0 / a);
  }
  for (const auto *places : {&sources.x, &x})
    for (size_t k = 0; k < places->size(); k += 3) {
      const double height = sd_slab_height(&walls, &(*places)[k]);
      bounds[2] = std::max(bounds[2], -height);
      bounds[3] = std::max(bounds[3], height);
    }
  MPI_Allreduce(MPI_IN_PLACE, bounds, 4, MPI_DOUBLE, MPI_MAX, world);
  double sums[3] = {0.0};
  for (double a : sources.a) {
    sums[0] += 1.0;
    sums[1] += a * a;
    sums[2] += a * a * a * a;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, world);
  sd_slab_spheres all = {{}, SPECK / bounds[1], -bounds[2], bounds[3]};
  all.sizes.all = {2.0 * sums[0], sums[1], sums[2], bounds[0]};
  return all;
}

/* The splitting for all of these. Radius of a speck */
double FlowInSlab::choose(const Voice &voice, const SceneSettings &settings, const Piece &sources,
                          const std::vector<double> &x)
{
  const sd_slab_walls walls = settings.boundary.slab_walls();
  const sd_slab_spheres all = with_specks(voice.lmp->world, walls, sources, x);
  sd_ewald_box box = Lattice::of(voice.lmp->domain).ewald_box();
  box.periodic = 1;
  const sd_status status =
      sd_slab_choose(&walls, &box, &all, AT_SPECKS * settings.far_field_tolerance, &slab);
  if (status != SD_OK)
    voice.at_step().fail("the flow of " + text(all.sizes.all.count / 2.0) + " spheres or points at heights from " +
                         text(all.lo) + " to " + text(all.hi) +
                         ": no grid for Ewald sums: " + sd_status_string(status) +
                         "; give lo and hi nearer to the spheres");
  return all.smallest;
}

void FlowInSlab::add_piece(const Voice &voice, const SceneSettings &settings, Piece &piece, std::vector<double> &u)
{
  const Lattice lattice = Lattice::of(voice.lmp->domain);
  const int n = (int) piece.a.size();
  Halo halo(voice.lmp->world);
  if (!halo.find(lattice, slab.ewald.reach, piece.x))
    voice.at_step().fail_one("the largest sphere or point sees more than 1000 images of each and 1e7 in "
                             "all; is it in other units than the box?");
  std::vector<double> w(n, 1.0);
  halo.extend(lattice.h, piece.x, {&piece.a, &w});
  sd_mobility_scene where = {};
  where.how.law = settings.law();
  where.how.width = 3;
  where.how.slab = &slab;
  where.n = n;
  where.n_all = (int) piece.a.size();
  where.spheres = {piece.x.data(), piece.a.data(), w.data()};
  where.world = halo.ranks();
  u.resize(3 * (size_t) n + 3);
  rows = std::max(rows, (double) where.n_all);
  sd_status status = sd_mobility_place(&omega, &sd_mobility_slab, &where);
  if (status == SD_OK) status = sd_mobility_apply(&omega, piece.F.data(), u.data());
  if (status != SD_OK)
    fail_by(voice.at_step(), status,
            std::string("the flow by an ") + sd_mobility_slab.name + ": " + sd_status_string(status));
}

/* Into the box along its periods: windows and halos then have as far to go as for atoms. */
static void wrap(const Lattice &lattice, double *x)
{
  for (int d = 0; d < 3; d++)
    if (lattice.periodic[d])
      x[d] -= lattice.h[d] * std::floor((x[d] - lattice.origin[d]) / lattice.h[d]);
}

/* Neighbours on a grid go to different pieces: multiples of the golden ratio spread evenly. */
static size_t piece_of(size_t k, size_t pieces)
{
  return (size_t) (((uint64_t) k * 0x9E3779B97F4A7C15ull) >> 32) % pieces;
}

void FlowInSlab::add(const Voice &voice, const SceneSettings &settings, const FlowSources &sources,
                     const std::vector<double> &x, double *u)
{
  const Lattice lattice = Lattice::of(voice.lmp->domain);
  const sd_slab_walls walls = settings.boundary.slab_walls();
  const MPI_Comm world = voice.lmp->world;
  const Piece spheres = {sources.x, sources.a, sources.F};
  std::vector<size_t> wet;
  std::vector<double> places;
  for (size_t k = 0; k < x.size() / 3; k++) {
    const double height = sd_slab_height(&walls, &x[3 * k]);
    if (walls.kind != SD_SLAB_LAYER && !(height > 0.0)) continue;
    if (walls.kind == SD_SLAB_SLIT && !(height < walls.height)) continue;
    wet.push_back(k);
    places.insert(places.end(), &x[3 * k], &x[3 * k] + 3);
    wrap(lattice, &places[places.size() - 3]);
  }
  const double of_all = sum_of_all(world, (double) spheres.a.size());
  if (of_all == 0.0) return;
  const double speck = choose(voice, settings, spheres, places);
  const double at_once = std::max(FEWEST, of_all / voice.lmp->comm->nprocs);
  const size_t pieces = largest_of_all(world, (bigint) std::ceil(wet.size() / at_once));
  for (size_t p = 0; p < pieces; p++) {
    Piece piece = spheres;
    std::vector<size_t> which;
    for (size_t k = 0; k < wet.size(); k++) {
      if (piece_of(k, pieces) != p) continue;
      which.push_back(wet[k]);
      piece.x.insert(piece.x.end(), &places[3 * k], &places[3 * k] + 3);
      piece.a.push_back(speck);
    }
    piece.F.resize(piece.x.size() + 3);
    std::vector<double> moves;
    add_piece(voice, settings, piece, moves);
    for (size_t k = 0; k < which.size(); k++)
      for (int d = 0; d < 3; d++)
        u[3 * which[k] + d] += moves[3 * (spheres.a.size() + k) + d];
  }
}

double FlowInSlab::memory_usage() const
{
  return 8.0 * sizeof(double) * rows;
}

}    // namespace StokesDyn
