#include "directions.h"

#include "sd_pose.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void Directions::look(int i, const double W[3])
{
  if (on()) std::copy_n(W, 3, turning.give(i));
}

void Directions::step(int i, double dt, double weight, double scale, const double *noise)
{
  if (!on() || !turning.has(i)) return;
  double *row = turning.row(i), w[3];
  sd_mean_velocity(3, row, row + 3, weight, w);
  for (int d = 0; d < 3; d++) w[d] = dt * w[d] + (scale > 0.0 ? scale * noise[d] : 0.0);
  std::copy_n(row, 3, row + 3);
  turn(i, w, 1.0);
}

void Directions::turn(int i, const double W[3], double dt)
{
  if (!has(i)) return;
  double w[3], R[9];
  for (int d = 0; d < 3; d++) w[d] = dt * W[d];
  sd_rotation(w, R);
  turn(i, R);
}

void Directions::turn(int i, const double R[9])
{
  if (has(i)) sd_turn_direction(R, atom->mu[i][3], atom->mu[i]);
}

std::vector<double> Directions::all() const
{
  std::vector<double> out;
  for (int i = 0; i < atom->nlocal && on(); i++)
    out.insert(out.end(), atom->mu[i], atom->mu[i] + 3);
  return out;
}

void Directions::restore(const std::vector<double> &from)
{
  for (size_t i = 0; 3 * i < from.size(); i++) std::copy_n(&from[3 * i], 3, atom->mu[i]);
}

}    // namespace StokesDyn
