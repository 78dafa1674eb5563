/* Who is near whom: the pairs that have a film. */
#include <math.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_lubrication_internal.h"
#include "sd_room.h"

static sd_status reserve_pairs(sd_lubrication *L, long count)
{
  struct sd_lubrication_work *w = L->work;
  if (count < w->most_pairs) return SD_OK;
  const size_t room = (size_t) (count + count / 4 + 64);
  if (!sd_grow(&L->pair, sizeof(*L->pair), room) || !sd_grow(&w->close, sizeof(*w->close), room) ||
      !sd_grow(&L->link, sizeof(*L->link), room) ||
      !sd_grow(&L->model, sizeof(double), room))
    return SD_ENOMEMORY;
  w->most_pairs = (long) room;
  return SD_OK;
}

static sd_status identify(sd_lubrication *L, const sd_lubrication_scene *s)
{
  identity *who = L->work->identity;
  for (int i = 0; i < s->n; i++)
    who[i] = (identity){s->world.me, i, s->body ? s->body[i] : 0};
  if (!s->world.refresh) return SD_OK;
  return s->world.refresh(s->world.ctx, &who->rank, &who[s->n].rank, sizeof(identity) / sizeof(double));
}

/* The row of the sphere that stands at j: of this rank, or j itself */
static int row_at(const sd_lubrication *L, int j)
{
  const identity *who = L->work->identity + j;
  return j < L->n || who->rank != L->world.me ? j : (int) who->row;
}

static int one_body(const sd_lubrication *L, int i, int j)
{
  const identity *who = L->work->identity;
  return who[i].body != 0 && who[i].body == who[j].body;
}

/* What there is to know of a pair where it stands; d from sphere i to j */
static closeness film_look(const sd_lubrication_scene *s, int i, int j, double d[3])
{
  const sd_spheres *p = &s->spheres;
  sd_minus(p->x + 3 * (long) j, p->x + 3 * (long) i, d);
  const double R = sqrt(sd_dot(d, d));
  if (R > 0.0)
    for (int e = 0; e < 3; e++) d[e] /= R;
  else
    d[2] = 1.0; /* spheres at one point: any direction */
  return (closeness){R, j};
}

/* The pair of i and `at`, and of j that stands there, if they feel each other */
static void keep_pair(sd_lubrication *L, const sd_lubrication_scene *s, long *count, int i, int j,
                      int at)
{
  if (one_body(L, i, at)) return;
  const closeness close = film_look(s, i, at, L->link[*count].d);
  if (!(weight_of_film(s, i, &close) > 0.0)) return;
  L->pair[*count][0] = i;
  L->pair[*count][1] = j;
  L->work->close[(*count)++] = close;
}

/* Behind all others: of spheres of two other ranks, if both have pairs with this one's; neighbours of `rows` are
 * known */
static void keep_beyond(sd_lubrication *L, const sd_lubrication_scene *s, int rows)
{
  const struct sd_lubrication_work *w = L->work;
  const sd_neighbors *near = &w->near.list;
  double *met = w->neighbours;
  long last = L->count;
  memset(met, 0, sizeof(double) * (size_t) s->n_all);
  for (long k = 0; k < L->count; k++) met[L->pair[k][1]] = 1.0;
  for (int i = s->n; i < rows; i++)
    for (long k = near->first[i]; met[i] != 0.0 && k < near->first[i + 1]; k++) {
      const int j = near->neighbor[k];
      if (met[j] != 0.0 && w->identity[i].rank != w->identity[j].rank) keep_pair(L, s, &last, i, j, j);
    }
  L->beyond = last - L->count;
}

/* Pairs of a sphere with its own images are there as often as these are, since the other way round
 * is the same force on the same sphere. All others are there once, from the lower row. */
sd_status sd_lubrication_find_pairs(sd_lubrication *L, const sd_lubrication_scene *s)
{
  struct sd_lubrication_work *w = L->work;
  const int rows = s->world.ranks > 2 ? s->n_all : s->n;
  sd_status status = identify(L, s);
  if (status == SD_OK) status = sd_near_keep(&w->near, &s->spheres, rows, s->n_all, 2.0 + s->range);
  const sd_neighbors *near = &w->near.list;
  if (status == SD_OK) status = reserve_pairs(L, near->first[rows]);
  if (status != SD_OK) return status;
  L->count = 0;
  for (int i = 0; i < s->n; i++)
    for (long k = near->first[i]; k < near->first[i + 1]; k++) {
      const int at = near->neighbor[k], j = row_at(L, at);
      if (j >= i) keep_pair(L, s, &L->count, i, j, at);
    }
  keep_beyond(L, s, rows);
  return SD_OK;
}
