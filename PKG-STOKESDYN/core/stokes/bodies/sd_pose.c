#include "sd_pose.h"

#include "sd_linear.h"

#include <math.h>
#include <string.h>

void sd_step_move(const sd_step *step, int n, const double *v, const double *v_old, const double *y, double *move)
{
  for (int k = 0; k < n; k++)
    move[k] = step->dt * (v[k] + step->change * (v[k] - v_old[k])) + (y ? step->noise * y[k] : 0.0);
}

/* c = cos(h), s = sin(h)/(2 h), h = |w|/2: the quaternion (c, s w) */
static void half_turn(const double w[3], double *cosine, double *sine)
{
  const double square = 0.25 * sd_dot(w, w);
  double c, s;
  if (square < 0.0025) {
    /* as a step turns: by series, cut where the next term is below 3e-20 */
    c = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    s = 0.5 - square / 12.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)));
  } else {
    const double half = sqrt(square);
    c = cos(half);
    s = sin(half) / (2.0 * half);
  }
  *cosine = c;
  *sine = s;
}

void sd_rotation(const double w[3], double R[9])
{
  double c, s;
  half_turn(w, &c, &s);
  const double q[4] = {c, s * w[0], s * w[1], s * w[2]};
  sd_quaternion_rotation(q, R);
}

void sd_quaternion_rotation(const double q[4], double R[9])
{
  const double square = q[0] * q[0] + sd_dot(q + 1, q + 1);
  const double norm = square > 0.0 ? 1.0 / sqrt(square) : 0.0;
  const double a = norm * q[0], x = norm * q[1], y = norm * q[2], z = norm * q[3];
  R[0] = 1.0 - 2.0 * (y * y + z * z);
  R[1] = 2.0 * (x * y - a * z);
  R[2] = 2.0 * (x * z + a * y);
  R[3] = 2.0 * (x * y + a * z);
  R[4] = 1.0 - 2.0 * (x * x + z * z);
  R[5] = 2.0 * (y * z - a * x);
  R[6] = 2.0 * (x * z - a * y);
  R[7] = 2.0 * (y * z + a * x);
  R[8] = 1.0 - 2.0 * (x * x + y * y);
}

static void set_length(double length, double v[3])
{
  const double norm = sqrt(sd_dot(v, v)), factor = norm > 0.0 ? length / norm : 1.0;
  for (int d = 0; d < 3; d++) v[d] *= factor;
}

void sd_turn_direction(const double R[9], double length, double v[3])
{
  double turned[3];
  sd_multiply3(R, v, turned);
  memcpy(v, turned, sizeof(turned));
  set_length(length, v);
}

/* (c^2 - s^2 w.w) v + 2 s^2 (w.v) w + 2 c s w x v of the quaternion (c, s w) */
void sd_turn_direction_by(const double w[3], double length, double v[3])
{
  double c, s, across[3];
  half_turn(w, &c, &s);
  const double own = c * c - s * s * sd_dot(w, w), along = 2.0 * s * s * sd_dot(w, v);
  sd_cross(w, v, across);
  for (int d = 0; d < 3; d++) v[d] = own * v[d] + along * w[d] + 2.0 * c * s * across[d];
  set_length(length, v);
}

/* Unit quaternion of a rotation, by the largest of its four numbers, so that nothing cancels:
 * 4 a^2 = 1 + tr R and the like, products of two of them from sums and differences of entries of R.
 * Source: Shepperd, J. Guidance Control 1, 223 (1978). */
static void quaternion_of(const double R[9], double q[4])
{
  const double trace = R[0] + R[4] + R[8];
  int most = 0;
  for (int d = 1; d < 4; d++)
    if (R[4 * (d - 1)] > (most ? R[4 * (most - 1)] : trace)) most = d;
  if (most == 0) {
    q[0] = 1.0 + trace;
    for (int d = 0; d < 3; d++) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      q[d + 1] = R[3 * f + e] - R[3 * e + f];
    }
    return;
  }
  const int d = most - 1, e = (d + 1) % 3, f = (d + 2) % 3;
  q[0] = R[3 * f + e] - R[3 * e + f];
  q[d + 1] = 1.0 + 2.0 * R[4 * d] - trace;
  q[e + 1] = R[3 * d + e] + R[3 * e + d];
  q[f + 1] = R[3 * d + f] + R[3 * f + d];
}

void sd_turn_quaternion(const double R[9], double q[4])
{
  double p[4], out[4], cross[3];
  quaternion_of(R, p);
  sd_cross(p + 1, q + 1, cross);
  out[0] = p[0] * q[0] - sd_dot(p + 1, q + 1);
  for (int d = 1; d < 4; d++) out[d] = p[0] * q[d] + q[0] * p[d] + cross[d - 1];
  const double norm = sqrt(out[0] * out[0] + sd_dot(out + 1, out + 1));
  for (int k = 0; k < 4; k++) q[k] = norm > 0.0 ? out[k] / norm : 0.0;
}

void sd_pose_step(double pose[12], const double centre[3], const double step[6], int n,
                  const double *X, double turn[9], double *x)
{
  double R[9], before[3], after[3], *c = pose + 9;
  sd_multiply3(pose, centre, before);
  sd_rotation(step + 3, turn);
  sd_product3(turn, pose, R);
  memcpy(pose, R, sizeof(R));
  sd_multiply3(R, centre, after);
  for (int d = 0; d < 3; d++) c[d] += step[d] + (before[d] - after[d]);
  for (int k = 0; k < n; k++) {
    sd_multiply3(R, X + 3 * k, x + 3 * k);
    for (int d = 0; d < 3; d++) x[3 * k + d] += c[d];
  }
}

double sd_next_step(double last, double fastest, double tmin, double tmax, double xmax)
{
  double dt = fastest > 0.0 ? xmax / fastest : tmax;
  dt = fmin(dt, 2.0 * last);
  return fmin(fmax(dt, tmin), tmax);
}

int sd_grows(sd_growth *state, double error)
{
  const double LARGE = 0.1, MANY = 8.0;
  if (state->last > 0.0 && error > state->last)
    state->grows++;
  else {
    state->grows = 0;
    state->first = error;
  }
  state->large = error > LARGE ? state->large + 1 : 0;
  state->last = error;
  return error > LARGE &&
      ((state->grows >= 3 && error > MANY * state->first) || state->large >= 20);
}
