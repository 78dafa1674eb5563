#include "directions.h"

#include "lammps_compat.h"

#include "sd_linear.h"
#include "sd_pose.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

bool Directions::on() const
{
  return atom->mu_flag || atom->ellipsoid_flag || Compat::has_quat(atom);
}

void Directions::init(bool moved)
{
  ellipsoids = atom->ellipsoid_flag ? Compat::ellipsoids(atom) : nullptr;
  any_moved = moved;
}

bool Directions::quaternion(int i, double q[4]) const
{
  if (Compat::has_quat(atom)) {
    std::copy_n(Compat::quat(atom)[i], 4, q);
    return true;
  }
  if (!ellipsoids || atom->ellipsoid[i] < 0) return false;
  ellipsoids->pack_comm_bonus(1, &i, q);
  return true;
}

void Directions::set_quaternion(int i, const double q[4])
{
  if (Compat::has_quat(atom)) {
    std::copy_n(q, 4, Compat::quat(atom)[i]);
    return;
  }
  double buffer[4];
  std::copy_n(q, 4, buffer);
  ellipsoids->unpack_comm_bonus(1, i, buffer);
}

bool Directions::direction(int i, double e[3]) const
{
  double q[4], R[9];
  if (has_moment(i)) {
    std::copy_n(atom->mu[i], 3, e);
    sd_normalize(e);
    return true;
  }
  if (!quaternion(i, q)) return false;
  sd_quaternion_rotation(q, R);
  for (int d = 0; d < 3; d++) e[d] = R[3 * d + 2];
  return true;
}

void Directions::note_found(int i, const double W[3])
{
  if (!on()) return;
  double *row = turning.writable(i);
  std::copy_n(W, 3, row);
  if (any_moved) quaternion(i, row + 6);
}

void Directions::turn_of_step(int i, const sd_step &step, const double *y, double w[3])
{
  std::fill_n(w, 3, 0.0);
  if (!on() || !turning.has(i)) return;
  double *row = turning.row(i);
  sd_step_move(&step, 3, row, row + 3, y, w);
  std::copy_n(row, 3, row + 3);
}

void Directions::turn(int i, const double W[3], double dt)
{
  if (!on()) return;
  double w[3], q[4], R[9];
  for (int d = 0; d < 3; d++) w[d] = dt * W[d];
  if (has_moment(i)) sd_turn_direction_by(w, atom->mu[i][3], atom->mu[i]);
  if (!quaternion(i, q)) return;
  sd_rotation(w, R);
  sd_turn_quaternion(R, q);
  set_quaternion(i, q);
}

void Directions::turn(int i, const double R[9])
{
  double q[4];
  if (has_moment(i)) sd_turn_direction(R, atom->mu[i][3], atom->mu[i]);
  if (!quaternion(i, q)) return;
  sd_turn_quaternion(R, q);
  set_quaternion(i, q);
}

void Directions::turn_moved(int i, const double W[3], double dt)
{
  double q[4];
  if (on() && turning.has(i) && quaternion(i, q)) set_quaternion(i, turning[i] + 6);
  turn(i, W, dt);
}

std::vector<double> Directions::all() const
{
  std::vector<double> out;
  for (int i = 0; i < atom->nlocal && on(); i++) {
    double row[7] = {0.0};
    if (atom->mu_flag) std::copy_n(atom->mu[i], 3, row);
    quaternion(i, row + 3);
    out.insert(out.end(), row, row + 7);
  }
  return out;
}

void Directions::restore(const std::vector<double> &from)
{
  for (int i = 0; 7 * (size_t) i < from.size(); i++) {
    const double *row = &from[7 * (size_t) i];
    double q[4];
    if (atom->mu_flag) std::copy_n(row, 3, atom->mu[i]);
    if (quaternion(i, q)) set_quaternion(i, row + 3);
  }
}

}    // namespace StokesDyn
