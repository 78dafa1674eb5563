/* Films between spheres that are shells of points (sd_multiblob.h): what two spheres resist of
 * their relative motion beyond what their shells know.
 *
 *   D = Q^T (R_exact - <R_shells>) Q          <>: mean over the orientations of both shells
 *
 * Q takes the motion of the pair as one rigid body out of its velocities (sd_pair_resistance.h):
 * shells know the common motion of a pair and of all its neighbours, so nothing is shared. d:
 * unit vector from sphere 1 to 2, R the distance of the centres. A film sees the approach u =
 * d.(U2 - U1), the relative spin w = d.(W2 - W1), and the turns om_q = (W_q - Om) across d
 * against the line of centres, which turns with Om = d x (U2 - U1)/R:
 *
 *   power = A_n u^2 + A_t w^2 + sum_pq B_pq om_p.om_q                 five numbers of gap and ratio
 *   t_q = B_q1 om_1 + B_q2 om_2,   F_2 = A_n u d - (t_1 + t_2) x d/R = -F_1
 *   T_1 = t_1 - A_t w d,   T_2 = t_2 + A_t w d                      forces and torques on the fluid
 *
 * A_n goes like 1/xi, B like ln(1/xi), A_t stays finite; xi: gap over the mean radius. The mean
 * shell is a little too stiff between xi 0.25 and 1, by 0.002 Stokes drags, so A_n, A_t and the
 * eigenvalues of B_pq/(8 pi a_p^1.5 a_q^1.5) are clipped at 0: D >= 0.
 *
 * Shells are all alike, or of 12, 42, 162, 642 points by radius, the larger ones half shells
 * (sd_multiblob_half.h); then each pair of numbers of points has its own means. Source: our
 * own; make_film_table makes the numbers. */
#ifndef SD_FILM_H
#define SD_FILM_H

#include "sd_two_sphere.h"

SD_BEGIN_C

/* Of two radii; and of the gap */
#define SD_FILM_LARGEST_RATIO 10.0
#define SD_FILM_LARGEST_XI 2.0

enum { SD_FILM_RATIOS = 10, SD_FILM_GAPS = 12, SD_FILM_STEPS = 720, SD_FILM_NUMBERS = 6 };

/* For a viscosity of 1 */
typedef struct {
  /* force over speed; torque over spin; torques over turns, 11 12 22 */
  double A_n, A_t, B[3];
  /* what the mean shells themselves resist of an approach, beyond their drags; like A_n */
  double shells_approach;
} sd_film;

/* What films are read from, ready after create. It owns no memory. */
typedef struct {
  const sd_two_sphere *exact;
  /* nodes of the gaps (sd_two_sphere_nodes) */
  double node[SD_FILM_GAPS], root[SD_FILM_GAPS];
  const double (*shells)[SD_FILM_GAPS][5];
  /* films of equal spheres, the commonest, by steps of the gap up to SD_FILM_LARGEST_XI */
  double equal[SD_FILM_STEPS][SD_FILM_NUMBERS];
  /* those by radius, every second one; NULL: all are alike */
  const double (*half)[SD_FILM_GAPS][5];
} sd_films;

/* Of shells of n points with or without the one-body addition; `exact` outlives it. As long as some hundred
 * films. SD_OK; SD_EOUTSIDE: another n than 12 and 42. */
sd_status sd_films_create(int n, int one_body, const sd_two_sphere *exact, sd_films *out);

/* SD_OK; SD_EOUTSIDE: xi not in [SD_TWO_SPHERE_SMALLEST_XI, SD_FILM_LARGEST_XI], a ratio above
 * SD_FILM_LARGEST_RATIO or that of `exact`. The means over orientations are within 1e-3 of
 * themselves; a given pair of shells differs from its mean by 1 to 2 % of the shells' share. */
sd_status sd_film_at(const sd_films *films, double a1, double a2, double xi, sd_film *film);

/* Of shells by radius, with or without the addition; as above. SD_OK. */
sd_status sd_films_create_by_radius(int one_body, const sd_two_sphere *exact, sd_films *out);

/* The film of sphere 1 of n1 points with sphere 2 of n2; where all are alike that of sd_film_at. xi as
 * there, but the end is where the gap is SD_FILM_LARGEST_XI harmonic means 2 a1 a2/(a1 + a2) of the
 * radii. SD_OK; SD_EOUTSIDE: beyond; or numbers of points for which there are no means at this ratio
 * (sd_film_kinds): the larger sphere never has the fewer points. */
sd_status sd_film_between(const sd_films *films, int n1, int n2, double a1, double a2, double xi,
                          sd_film *film);

/* scale times the film, as the resistance of a pair at this distance of the centres: it resists no
 * rigid motion of the pair, to rounding. */
sd_pair_resistance sd_film_resistance(const sd_film *film, double distance, double scale);

SD_END_C
#endif
