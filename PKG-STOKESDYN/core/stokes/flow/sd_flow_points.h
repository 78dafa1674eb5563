/* What flows at the points of spheres that are shells (sd_multiblob_points.h), from what is known at their
 * centres: u(X) + G r + r.H r/2 + (b^2/6) tr H for a point of radius b at r, exact for a quadratic flow. */
#ifndef SD_FLOW_POINTS_H
#define SD_FLOW_POINTS_H

#include "sd_flow.h"
#include "sd_multiblob_points.h"

SD_BEGIN_C

typedef struct {
  /* at the centre of sphere i: velocity + stride i */
  const double *velocity;
  int stride;
  /* [9 n] G, [SD_FLOW_SECOND n] H of sd_flow.h; H NULL: 0 */
  const double *gradient, *second;
} sd_flow_spheres;

/* u [3 rows]: with which the flow carries each point */
void sd_flow_at_points(const sd_multiblob_additions *points, const sd_flow_spheres *flow, double *u);

SD_END_C
#endif
