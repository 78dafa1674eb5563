#include "water_around.h"

#include "pair_sph_artvisc_tenscorr.h"

#include "atom.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <new>

using namespace LAMMPS_NS;

namespace StokesDyn {

WaterAround::~WaterAround()
{
  sd_cells_free(&cells);
}

void WaterAround::follow(const PairSph &pair, int bits, double h)
{
  if (neighbor->ago == 0 || update->setupflag || list_of != neighbor->lastcall)
    make(pair, bits, h);
  else
    look_at_places();
}

void WaterAround::look_at_places()
{
  places.resize(3 * points.size() + 1);
  grain_places.resize(3 * grains.size() + 1);
  for (size_t p = 0; p < points.size(); p++) std::copy_n(atom->x[points[p]], 3, &places[3 * p]);
  for (size_t j = 0; j < grains.size(); j++) std::copy_n(atom->x[grains[j]], 3, &grain_places[3 * j]);
}

void WaterAround::make(const PairSph &pair, int bits, double h)
{
  points.clear();
  grains.clear();
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    if (pair.is_particle(i))
      points.push_back(i);
    else if (i < atom->nlocal && (atom->mask[i] & bits))
      grains.push_back(i);
  look_at_places();
  sd_cells_free(&cells);
  cells = {};
  const double reach = 2.0 * h + neighbor->skin;
  if (sd_cells_fill(&cells, places.data(), (int) points.size(), 0.5 * reach) != SD_OK)
    throw std::bad_alloc();
  first.resize(grains.size() + 1);
  const auto look = [&](int *into) {
    sd_sph_look_around(&cells, places.data(), (int) grains.size(), grain_places.data(), reach, first.data(), into);
  };
  look(nullptr);
  particle.resize(first.back() + 1);
  weight.resize(particle.size());
  look(particle.data());
  walls.resize(points.size());
  for (size_t p = 0; p < points.size(); p++) walls[p] = pair.is_of_wall(points[p]);
  list_of = neighbor->lastcall;
}

bool WaterAround::is_beside_wall(size_t grain) const
{
  return std::any_of(&particle[first[grain]], &particle[first[grain + 1]], [this](int p) { return walls[p]; });
}

std::vector<double> WaterAround::at_points(const double *of_atoms, int columns) const
{
  std::vector<double> out(columns * points.size() + 1, 0.0);
  for (size_t p = 0; p < points.size(); p++)
    std::copy_n(of_atoms + columns * (size_t) points[p], columns, &out[columns * p]);
  return out;
}

std::vector<double> WaterAround::at_atoms(const std::vector<double> &of_points, int columns) const
{
  std::vector<double> out(columns * (size_t) (atom->nlocal + atom->nghost) + 1, 0.0);
  for (size_t p = 0; p < points.size(); p++)
    std::copy_n(&of_points[columns * p], columns, &out[columns * (size_t) points[p]]);
  return out;
}

std::vector<double> WaterAround::mean_of(const double *of_atoms, int columns)
{
  const sd_sph_around around = list();
  const std::vector<double> there = at_points(of_atoms, columns);
  std::vector<double> mean(columns * grains.size() + 1);
  const auto means = columns == 3 ? sd_sph_grain_vector_means : sd_sph_grain_means;
  means(&around, there.data(), mean.data());
  return mean;
}

}    // namespace StokesDyn
