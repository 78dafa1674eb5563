#include "sd_box_flow.h"

void sd_box_flow_at(const sd_box_flow *flow, const double x[3], double u[3])
{
  for (int p = 0; p < 3; p++) {
    u[p] = flow->corner_velocity[p];
    for (int q = 0; q < 3; q++) u[p] += flow->gradient[3 * p + q] * (x[q] - flow->corner[q]);
  }
}

/* The edges are (h0 0 0), (h5 h1 0), (h4 h3 h2), and grow by the gradient times them. */
sd_box sd_box_later(const sd_box_flow *flow, const sd_box *now, double t)
{
  const double *h = now->h, *G = flow->gradient;
  const double rate[6] = {G[0] * h[0],
                          G[4] * h[1],
                          G[8] * h[2],
                          G[4] * h[3] + G[5] * h[2],
                          G[0] * h[4] + G[1] * h[3] + G[2] * h[2],
                          G[0] * h[5] + G[1] * h[1]};
  double u[3];
  sd_box then = *now;
  sd_box_flow_at(flow, now->lo, u);
  for (int d = 0; d < 3; d++) then.lo[d] += t * u[d];
  for (int d = 0; d < 6; d++) then.h[d] += t * rate[d];
  return then;
}

void sd_step_in_box_of(const sd_step_in_box *s, const double V[3], const double place[3], const double x[3],
                       double step[3])
{
  for (int d = 0; d < 3; d++) step[d] = s->t * V[d];
  if (!s->carried) return;
  double of_box[3], end[3] = {x[0], x[1], x[2]};
  sd_box_flow_at(&s->flow, place, of_box);
  for (int d = 0; d < 3; d++) step[d] -= s->t * of_box[d];
  sd_box_step(&s->start, &s->at, &s->to, step, end);
  for (int d = 0; d < 3; d++) step[d] = end[d] - x[d];
}
