/* Two spheres near contact: what grows without bound, or in its slope, when the gap closes. */
#ifndef SD_TWO_SPHERE_NEAR_H
#define SD_TWO_SPHERE_NEAR_H

#include "sd_pair_resistance.h"

/* a1, a2 > 0; xi > 0, gap over the mean radius. With l = a2/a1, p = 1 + l, L = ln(1 + 1/xi), over
 * 6 pi a1 (XA, YA), 4 pi a1^2 (YB) and 8 pi a1^3 (XC, YC):
 *
 *   XA11 = 2 l^2/(p^3 xi) + l (1 + 7l + l^2)/(5 p^3) L
 *          + (1 + 18l - 29l^2 + 18l^3 + l^4)/(42 p^3) xi L
 *   YA11 = 4l (2 + l + 2l^2)/(15 p^3) L + 2 (16 - 45l + 58l^2 - 45l^3 + 16l^4)/(375 p^3) xi L
 *   YB11 = -l (4 + l)/(5 p^2) L - (32 - 33l + 83l^2 + 43l^3)/(250 p^2) xi L
 *   XC11 = -l^2/(4p) xi L
 *   YC11 = 2l/(5p) L + (8 + 6l + 33l^2)/(125 p) xi L
 *   YC12 = l^2/(10 p) L + l (43 - 24l + 43l^2)/(500 p) xi L
 *
 * XA12 = -XA11 = -XA22, so YA and XC; YB12 = -YB11; those of sphere 2 with 1/l, the sign of YB
 * turned. What is left of the exact functions is O(1) and goes like xi^2 L. L instead of ln(1/xi)
 * is the same to that order and does not grow far away.
 * Source: Jeffrey & Onishi 1984; YC12 and XC are theirs with other scales. */
sd_pair_resistance sd_two_sphere_near(double a1, double a2, double xi);

#endif
