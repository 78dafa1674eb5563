/* The bodies of sd_bodies.h: who they are, what they consist of, and how each of them moves alone.
 *
 *   bodies     free spheres of one point first, then rigid bodies of a shape; 6 numbers each, U of
 *              the centre and W, or force and torque about it
 *   spheres    what loads and films (sd_tie.h) act on; 6 numbers each, rigid parts of bodies
 *   points     rows of unknowns, the forces l on the fluid: width 3, or 6 with torques; rigid parts
 *              of spheres. In the model of one point per sphere the points are the spheres
 *
 * A body belongs to one rank, with all its spheres and points. All is in space axes. */
#ifndef SD_BODY_H
#define SD_BODY_H

#include "sd_body_shape.h"
#include "sd_faces.h"
#include "sd_rigid.h"
#include "sd_solve.h"
#include "sd_world.h"

SD_BEGIN_C

struct sd_tie;

/* A body of a shape: points at c + a R X_k in a fluid of viscosity eta, and at those rows */
typedef struct {
  const sd_body_shape *shape;
  double R[9], a, eta;
  /* [shape->m] rows of its points in the order of the shape */
  const int *row;
} sd_body;

/* What is known of how a body moves: its load; or its velocity, while the force on it is not; or its
 * force and angular velocity, while the torque on it is not; or its torque and the velocity of its
 * centre, while the force on it is not */
typedef enum { SD_BODY_FREE, SD_BODY_HELD, SD_BODY_SPUN, SD_BODY_PINNED } sd_body_known;

typedef struct {
  /* free spheres of one point: [lone] their rows. They are bodies 0 ... lone - 1 */
  int lone;
  const int *loner;
  /* bodies of a shape, of the width of the points: lone ... lone + shaped - 1 */
  int shaped;
  const sd_body *body;
  /* 1: no rank has any of these, and all ranks know it; 0: where that matters they ask each other */
  int none_shaped;
  /* [bodies] sd_body_known; NULL: all are free */
  const char *known;
  /* Spheres on bodies: width 6, in the model without torques 3. Points on spheres: whole NULL: the
   * spheres are the points, of equal width */
  sd_rigid spheres, points;
  /* [3 spheres] arms by which films act, where these stand otherwise than points; NULL: those of
   * spheres */
  const double *film_arm;
  /* points on spheres, how these face each other, for what ties them; NULL: not known */
  const sd_faces *faces;
  /* [width points] 6 pi eta a in rows of forces, 8 pi eta a^3 in those of torques */
  const double *D;
  /* M without D^-1: the pairs of an engine; and what a model adds for each sphere alone, to the rows u of
   * spheres begin ... end - 1 (NULL: nothing, and so wherever the spheres are the points) */
  sd_apply *apply;
  void *apply_ctx;
  void (*add)(const void *ctx, int begin, int end, const double *l, double *u);
  const void *add_ctx;
  /* lubrication; NULL: none */
  struct sd_tie *tie;
  /* sum */
  sd_world world;
} sd_bodies;

static inline int sd_bodies_count(const sd_bodies *A)
{
  return A->lone + A->shaped;
}
static inline sd_body_known sd_bodies_known(const sd_bodies *A, int b)
{
  return A->known ? (sd_body_known) A->known[b] : SD_BODY_FREE;
}
/* Is number d of the velocity of the body known, and that of its load not? */
static inline int sd_bodies_velocity_known(const sd_bodies *A, int b, int d)
{
  const sd_body_known known = sd_bodies_known(A, b);
  return known == SD_BODY_HELD || (known == SD_BODY_SPUN && d >= 3) ||
      (known == SD_BODY_PINNED && d < 3);
}
/* Spheres on bodies, as films see them */
static inline sd_rigid sd_bodies_films(const sd_bodies *A)
{
  sd_rigid K = A->spheres;
  if (A->film_arm) K.arm = A->film_arm;
  return K;
}
/* How many numbers l has, and those of spheres have */
static inline long sd_bodies_unknowns(const sd_bodies *A)
{
  return (long) A->points.width * A->points.n;
}
static inline long sd_bodies_loads(const sd_bodies *A)
{
  return (long) A->spheres.width * A->spheres.n;
}

/* K V by rows, and K^T of rows [6 bodies]. on_spheres [6 spheres]: scratch, or where points are not
 * the spheres what becomes of these on the way */
void sd_bodies_move(const sd_bodies *A, const double *V, double *on_spheres, double *rows);
void sd_bodies_collect(const sd_bodies *A, const double *rows, double *on_spheres, double *f);

/* K V of rows begin ... end - 1, of a few points at a time, so that whoever needs it once finds it in the
 * cache. moved: what sd_bodies_move_spheres makes of V, in on_spheres [6 spheres] or V itself. From zero on
 * sd_bodies_next goes to the next ones; returns 0 behind the last. */
enum { SD_BODIES_PART = 96 };
typedef struct {
  long begin, end;
  double v[6 * SD_BODIES_PART];
} sd_bodies_part;
const double *sd_bodies_move_spheres(const sd_bodies *A, const double *V, double *on_spheres);
int sd_bodies_next(const sd_bodies *A, const double *moved, sd_bodies_part *part);

SD_END_C
#endif
