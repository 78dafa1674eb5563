#include "sd_tie_approach.h"

#include <string.h>

#include "sd_faces.h"
#include "sd_room.h"

/* b: what a strain adds to the approach of shells. Least squares of their mean resistance, 0.77 to
 * 0.60 from contact to a gap of 1; between 0.6 and 0.9 the products do not notice. */
static const double of_strain = 0.75;

/* B += c d d^T, xx yy zz xy xz yz */
static void add_square(double c, const double d[3], double B[6])
{
  for (int e = 0; e < 3; e++) B[e] += c * d[e] * d[e];
  B[3] += c * d[0] * d[1];
  B[4] += c * d[0] * d[2];
  B[5] += c * d[1] * d[2];
}

/* mine [n], L->others: does the sphere take part? Where all do, no rank has to be told. */
static sd_status know_whole(const sd_bodies *A, double *mine)
{
  const sd_lubrication *L = A->tie->L;
  const char *whole = A->faces ? A->faces->whole : NULL;
  for (int i = 0; i < L->n; i++) mine[i] = !whole || whole[i];
  for (int j = 0; j < L->n_all - L->n; j++) L->others[j] = 1.0;
  return whole && L->world.refresh && L->world.ranks > 1
      ? L->world.refresh(L->world.ctx, mine, L->others, 1)
      : SD_OK;
}

static int takes_part(const sd_lubrication *L, const double *mine, int i)
{
  return (i < L->n ? mine[i] : L->others[i - L->n]) != 0.0;
}

/* Of a sphere: how its surface moves, or, where rows are spheres, these */
static int numbers_seen(const sd_bodies *A)
{
  return A->faces ? SD_FACES_WIDTH : 6;
}

int sd_tie_approach_reserve(const sd_bodies *A)
{
  sd_tie_springs *X = &A->tie->springs;
  const sd_lubrication *L = A->tie->L;
  const size_t pairs = (size_t) (L->count + L->beyond), n = (size_t) L->n;
  const size_t width = (size_t) numbers_seen(A), others = (size_t) (L->n_all - L->n);
  return sd_reserve(&X->c, sizeof(*X->c), pairs + 1, &X->most_c) &&
      sd_reserve(&X->own, sizeof(double), 6 * (n + 1), &X->most_own) &&
      sd_reserve(&X->seen, sizeof(double), 2 * width * n + 1, &X->most_seen) &&
      sd_reserve(&X->there, sizeof(double), width * others + 1, &X->most_there);
}

sd_status sd_tie_approach_make(const sd_bodies *A, double *mine)
{
  sd_tie_springs *X = &A->tie->springs;
  const sd_lubrication *L = A->tie->L;
  memset(X->own, 0, sizeof(double) * 6 * (size_t) L->n);
  memset(X->c, 0, sizeof(*X->c) * (size_t) (L->count + L->beyond));
  if (!sd_tie_has_springs(A)) return SD_OK;
  const sd_status status = know_whole(A, mine);
  if (status != SD_OK) return status;
  for (long k = 0; k < L->count + L->beyond; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    if (j == i || !takes_part(L, mine, i) || !takes_part(L, mine, j)) continue;
    X->c[k] = L->model[k];
    if (i < L->n) add_square(X->c[k], L->link[k].d, X->own + 6 * (long) i);
    if (j < L->n) add_square(X->c[k], L->link[k].d, X->own + 6 * (long) j);
  }
  return SD_OK;
}

/* b d d: weights of e and of the moments that go with it */
static void strain_of(const double d[3], double w[6])
{
  for (int e = 0; e < 3; e++) w[e] = of_strain * d[e] * d[e];
  w[3] = 2.0 * of_strain * d[0] * d[1];
  w[4] = 2.0 * of_strain * d[0] * d[2];
  w[5] = 2.0 * of_strain * d[1] * d[2];
}

/* out += c s s^T v by spheres, of this many numbers each: with 9 the last 6 are strains */
static void add_springs(const sd_bodies *A, int width, const double *v, const double *others,
                        double *out)
{
  const sd_lubrication *L = A->tie->L;
  const int strains = width == SD_FACES_WIDTH ? 6 : 0;
  for (long k = 0; k < L->count; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    const double *d = L->link[k].d;
    const double *vi = v + width * (long) i;
    const double *vj = j < L->n ? v + width * (long) j : others + width * (long) (j - L->n);
    double *on_i = out + width * (long) i, *on_j = j < L->n ? out + width * (long) j : NULL;
    double approach = 0.0, w[6];
    for (int e = 0; e < 3; e++) approach += d[e] * (vi[e] - vj[e]);
    if (strains) strain_of(d, w);
    for (int e = 0; e < strains; e++) approach += w[e] * (vi[3 + e] + vj[3 + e]);
    approach *= A->tie->springs.c[k];
    for (int e = 0; e < 3; e++) on_i[e] += approach * d[e];
    for (int e = 0; e < strains; e++) on_i[3 + e] += approach * w[e];
    if (!on_j) continue;
    for (int e = 0; e < 3; e++) on_j[e] -= approach * d[e];
    for (int e = 0; e < strains; e++) on_j[3 + e] += approach * w[e];
  }
}

/* What springs do, behind what they see */
static double *pushed_of(const sd_bodies *A)
{
  return A->tie->springs.seen + numbers_seen(A) * (long) A->spheres.n;
}

void sd_tie_approach_see(const sd_bodies *A, const double *r)
{
  const int n = A->spheres.n;
  double *v = A->tie->springs.seen;
  if (r && A->faces) sd_faces_read(A->faces, n, r, v);
  else if (r) memcpy(v, r, sizeof(double) * 6 * (size_t) n);
  else memset(v, 0, sizeof(double) * (size_t) numbers_seen(A) * (size_t) n);
}

/* Forces of the springs on bodies; on_spheres: scratch [6 spheres] */
static void push_bodies(const sd_bodies *A, double *on_spheres, double *f)
{
  const int n = A->spheres.n, width = numbers_seen(A);
  const double *pushed = pushed_of(A);
  memset(on_spheres, 0, sizeof(double) * 6 * (size_t) n);
  for (long i = 0; i < n; i++) memcpy(on_spheres + 6 * i, pushed + width * i, 3 * sizeof(double));
  sd_rigid_collect(&A->spheres, on_spheres, sd_bodies_count(A), f);
}

sd_status sd_tie_approach_push(const sd_bodies *A, const double *V, double *on_spheres, double *f)
{
  const sd_tie *t = A->tie;
  const sd_world *world = &t->L->world;
  const int n = A->spheres.n, width = numbers_seen(A);
  double *v = t->springs.seen, *pushed = pushed_of(A);
  const double *moved = V ? sd_rigid_moved(&A->spheres, V, on_spheres) : NULL;
  for (long i = 0; V && i < n; i++)
    for (int d = 0; d < 3; d++) v[width * i + d] += moved[6 * i + d];
  if (world->refresh && world->ranks > 1) {
    const sd_status status = world->refresh(world->ctx, v, t->springs.there, width);
    if (status != SD_OK) return status;
  }
  memset(pushed, 0, sizeof(double) * (size_t) width * (size_t) n);
  add_springs(A, width, v, t->springs.there, pushed);
  if (f) push_bodies(A, on_spheres, f);
  return SD_OK;
}

void sd_tie_approach_add(const sd_bodies *A, double *l)
{
  const double *pushed = pushed_of(A);
  if (A->faces) sd_faces_push(A->faces, A->spheres.n, pushed, l);
  else
    for (long j = 0; j < sd_bodies_unknowns(A); j++) l[j] += pushed[j];
}
