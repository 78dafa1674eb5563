/* The engines that climb the ladder of test_ladder.c: one row each, at the end of this file. A new engine is a function
 * that says with what it is placed, and its row. */
#ifndef ENGINES_H
#define ENGINES_H

#include "on_ranks.h"

#include "ewald/periodic.h"
#include "slab/slab.h"

#include "sd_neighbor.h"

/* Spheres to be placed, each in a fluid of its own viscosity 1/w^2; width 3 or 6 */
typedef struct {
  int n, width;
  double x[3 * RANKS_SPHERES], a[RANKS_SPHERES], w[RANKS_SPHERES];
} cast;

/* What an engine can do beyond the product of forces in a scene of spheres that do not overlap */
enum {
  OVERLAPS = 1, /* the tensor of spheres that overlap is that of Rotne and Prager's model */
  TORQUES = 2,  /* width 6 */
  POSITIVE = 4, /* wherever the spheres stand */
  RANKS = 8,    /* on several ranks as on one */
  DIVIDES = 16, /* draws a part of its noise */
  FAR = 32,     /* what is far is felt */
};

struct climber;

/* An engine with how it is asked: an open box goes along with the spheres. reach: how far ghosts stand around those of
   a rank */
typedef struct {
  const struct climber *row;
  const sd_mobility_engine *engine;
  sd_law law;
  /* from SD_PRODUCT_SINGLE on: sums of all pairs are of floats */
  double harmless;
  double reach;
  sd_ewald_box box;
  sd_ewald first;
  sd_ewald_level second;
  sd_slab slab;
} how;

typedef struct climber {
  const char *name;
  /* fills law, engine, reach and splitting */
  void (*choose)(how *h, const cast *s);
  unsigned can;
  /* of a velocity over that of the pushed sphere alone; and what rounding adds where sums are of floats, else 0, and
   * the splitting must say the same */
  double tolerance, rounding;
  /* periodic box: edge and tilts; 0: none. wall: z = -0.3, the fluid is above; with a box this is periodic along it
   * alone. height: of a second wall above that one; 0: none. no_flux: nothing flows along both */
  double edge, tilt[3];
  int wall;
  double height;
  int no_flux;
  /* cut-off, or range of a taper: no pair beyond it */
  double cut;
  sd_taper taper;
  /* some spheres are so many times larger; 1: none are */
  double ratio;
  /* points of a sphere; 0: it is one itself */
  int shell;
} climber;

static const double wall_at = -0.3;

static inline sd_wall wall_of(const climber *row)
{
  return row->wall ? (sd_wall){2, 1, wall_at} : (sd_wall){0};
}

/* An open box around the spheres, or that of the row */
static inline sd_ewald_box box_of(const climber *row, const cast *s)
{
  if (row->edge > 0.0)
    return (sd_ewald_box){.periodic = 1, .origin = {-1, 2, 0.5}, .edge = {row->edge, row->edge, row->edge},
                          .tilt = {row->tilt[0], row->tilt[1], row->tilt[2]}};
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0.0;
  for (int i = 0; i < s->n; i++) {
    most = fmax(most, s->a[i]);
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * i + d]);
      hi[d] = fmax(hi[d], fmax(s->x[3 * i + d], row->wall && d == 2 ? wall_at + s->a[i] : -INFINITY));
    }
  }
  if (row->wall) lo[2] = fmax(lo[2], wall_at + 0.1 * most);
  sd_ewald_box box = {0};
  sd_ewald_box_around(&box, row->wall ? 2 : -1, lo, hi, most);
  return box;
}

/* Of Ewald sums */
static inline double tolerance_of(const climber *row)
{
  return 0.1 * row->tolerance;
}

/* In a periodic box, and with two levels, sums are split as for so many times as many spheres, so that their ranges are
 * shorter than the box. */
static inline sd_ewald_sizes sizes_of(const climber *row, const cast *s)
{
  sd_ewald_sizes sizes = periodic_sizes(s->a, s->n);
  const double many = row->ratio > 1.0 ? 600.0 : row->edge > 0.0 ? 200.0 : 1.0;
  for (int k = -1; k < SD_EWALD_OCTAVES; k++) {
    sd_ewald_class *c = k < 0 ? &sizes.all : sizes.octave + k;
    c->count *= many;
    c->squares *= many;
    c->fourths *= many;
  }
  return sizes;
}

/* --- with what each is placed --- */

static void choose_all_pairs(how *h, const cast *s)
{
  (void) s;
  h->engine = &sd_mobility_all_pairs;
}

static void choose_floats(how *h, const cast *s)
{
  choose_all_pairs(h, s);
  h->harmless = SD_PRODUCT_SINGLE;
}

static void choose_list(how *h, const cast *s)
{
  (void) s;
  h->engine = &sd_mobility_list;
  h->law.taper = h->row->taper;
  h->law.range = h->reach = h->row->cut;
}

static void choose_one_level(how *h, const cast *s)
{
  const sd_ewald_sizes sizes = sizes_of(h->row, s);
  h->engine = &sd_mobility_ewald;
  h->box = box_of(h->row, s);
  const sd_wall wall = wall_of(h->row);
  if (wall.sign)
    assert_int_equal(sd_ewald_choose_at_wall(&h->box, &wall, &sizes, tolerance_of(h->row), &h->first), SD_OK);
  else
    assert_int_equal(sd_ewald_choose(&h->box, &sizes, s->width, tolerance_of(h->row), &h->first), SD_OK);
  h->reach = h->first.reach;
}

static void choose_positive(how *h, const cast *s)
{
  const sd_ewald_sizes sizes = sizes_of(h->row, s);
  h->engine = &sd_mobility_ewald;
  h->box = box_of(h->row, s);
  assert_int_equal(sd_ewald_choose_positive(&h->box, &sizes, s->width, tolerance_of(h->row), SD_EWALD_POSITIVE,
                                            &h->first),
                   SD_OK);
  h->reach = h->first.reach;
}

static void choose_two_levels(how *h, const cast *s)
{
  const sd_ewald_sizes sizes = sizes_of(h->row, s);
  h->engine = &sd_mobility_levels;
  h->box = box_of(h->row, s);
  assert_int_equal(sd_ewald_levels_best(&h->box, &sizes, s->width, tolerance_of(h->row), &h->first, &h->second), SD_OK);
  h->reach = h->first.reach;
}

/* Ghosts are images along the walls only: the box across them is far larger than any reach. */
static void choose_slab(how *h, const cast *s)
{
  const sd_wall wall = wall_of(h->row);
  const sd_slab_walls walls = h->row->height > 0.0 ? sd_slab_slit(2, wall_at, wall_at + h->row->height, h->row->no_flux)
                                                     : sd_slab_floor(&wall);
  h->engine = &sd_mobility_slab;
  h->box = box_of(h->row, s);
  assert_int_equal(slab_choose(&walls, &h->box, s->x, s->a, s->n, tolerance_of(h->row), &h->slab), SD_OK);
  h->first = h->slab.ewald;
  h->first.box.edge[2] = 1e6;
  h->reach = h->first.reach;
}

/* --- placed --- */

typedef struct {
  how h;
  periodic copies;
  sd_neighbors list;
  double *x, *a, *w;
  sd_mobility m;
} placed;

/* On a rank of those among which the spheres are dealt in turn, the last one without any where there are more than two;
 * or on one alone, ranks 1 */
static inline void place_on(placed *p, const climber *row, const cast *s, rank *r)
{
  const int parts = r->ranks > 2 ? r->ranks - 1 : r->ranks;
  memset(p, 0, sizeof(*p));
  p->h.row = row;
  p->h.law.wall = wall_of(row);
  row->choose(&p->h, s);
  assert_int_equal(p->h.first.single || p->h.harmless > 0.0, row->rounding > 0.0);
  p->copies = (periodic){.n = s->n, .ewald = p->h.first};
  if (p->h.box.periodic) periodic_images(&p->copies, s->x, s->a, s->w);
  const int total = p->h.box.periodic ? p->copies.n_all : s->n;
  const double *x = p->h.box.periodic ? p->copies.x : s->x;
  p->x = malloc(sizeof(double) * 3 * (size_t) total);
  p->a = malloc(sizeof(double) * (size_t) total);
  p->w = malloc(sizeof(double) * (size_t) total);
  r->total = s->n;
  r->number = malloc(sizeof(int) * (size_t) total);
  for (int pass = 0; pass < 2; pass++) {
    for (int k = 0; k < total; k++) {
      if ((k < s->n && k % parts == r->me) != (pass == 0)) continue;
      const int i = k < s->n ? k : p->copies.owner[k];
      memcpy(p->x + 3 * r->n_all, x + 3 * k, 3 * sizeof(double));
      p->a[r->n_all] = s->a[i];
      p->w[r->n_all] = s->w[i];
      r->number[r->n_all++] = i;
    }
    if (pass == 0) r->n = r->n_all;
  }
  sd_mobility_scene scene = {.how = {p->h.law, s->width, &p->h.first, &p->h.second, &p->h.slab, p->h.harmless},
                             .n = r->n, .n_all = r->n_all, .spheres = {p->x, p->a, p->w}, .world = rank_world(r)};
  if (p->h.engine->view == SD_VIEW_ALL) {
    scene.n_all = s->n;
    scene.spheres = (sd_spheres){s->x, s->a, s->w};
  }
  if (p->h.engine->view == SD_VIEW_LIST) {
    assert_int_equal(sd_neighbors_cutoff(&p->list, p->x, r->n, r->n_all, p->h.reach), SD_OK);
    scene.pairs = &p->list.pairs;
  }
  assert_int_equal(sd_mobility_place(&p->m, p->h.engine, &scene), SD_OK);
  for (int k = 0; k < 3 * r->n_all && p->h.engine->reads_places_once; k++) p->x[k] = 0.0;
}

static inline void place_free(placed *p, rank *r)
{
  sd_mobility_free(&p->m);
  sd_neighbors_free(&p->list);
  free(p->copies.x), free(p->copies.a), free(p->copies.w), free(p->copies.owner);
  free(p->x), free(p->a), free(p->w), free(r->number);
}

/* One rank, which meets nobody */
typedef struct {
  placed p;
  rank r;
  shared *all;
} alone;

static inline void place_alone(alone *e, const climber *row, const cast *s)
{
  e->all = calloc(1, sizeof(shared));
  pthread_barrier_init(&e->all->barrier, NULL, 1);
  e->r = (rank){.all = e->all, .ranks = 1};
  place_on(&e->p, row, s, &e->r);
}

static inline void free_alone(alone *e)
{
  place_free(&e->p, &e->r);
  pthread_barrier_destroy(&e->all->barrier);
  free(e->all);
}

/* --- the table --- */

static const climber climbers[] = {
    {.name = "all pairs", .choose = choose_all_pairs, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-13, .ratio = 1},
    {.name = "all pairs, floats", .choose = choose_floats, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-5, .rounding = 1e-6, .ratio = 1},
    {.name = "all pairs, wall", .choose = choose_all_pairs, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-13, .wall = 1, .ratio = 1},
    {.name = "list, cut-off", .choose = choose_list, .can = OVERLAPS | TORQUES | RANKS,
     .tolerance = 1e-13, .cut = 9, .ratio = 1},
    {.name = "list, taper", .choose = choose_list, .can = OVERLAPS | TORQUES | POSITIVE | RANKS,
     .tolerance = 1e-13, .cut = 9, .taper = SD_TAPER_WENDLAND, .ratio = 1},
    {.name = "list, wall", .choose = choose_list, .can = OVERLAPS | TORQUES | RANKS,
     .tolerance = 1e-13, .wall = 1, .cut = 9, .ratio = 1},
    {.name = "Ewald, cube", .choose = choose_one_level, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-5, .edge = 13, .ratio = 1},
    {.name = "Ewald, oblique", .choose = choose_one_level, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-5, .edge = 13, .tilt = {4, -3, 2}, .ratio = 1},
    {.name = "Ewald, noise", .choose = choose_positive, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR | DIVIDES,
     .tolerance = 1e-5, .edge = 13, .ratio = 1},
    {.name = "Ewald, floats", .choose = choose_one_level, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-3, .rounding = 1e-6, .edge = 13, .ratio = 1},
    {.name = "Ewald, open", .choose = choose_one_level, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-3, .rounding = 1e-6, .ratio = 1},
    {.name = "Ewald, wall", .choose = choose_one_level, .can = OVERLAPS | POSITIVE | RANKS | FAR,
     .tolerance = 1e-3, .wall = 1, .ratio = 1},
    {.name = "two levels, cube", .choose = choose_two_levels, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 1e-4, .edge = 60, .ratio = 20},
    {.name = "two levels, open", .choose = choose_two_levels, .can = OVERLAPS | TORQUES | POSITIVE | RANKS | FAR,
     .tolerance = 3e-3, .ratio = 20},
    {.name = "slab, floor", .choose = choose_slab, .can = OVERLAPS | POSITIVE | RANKS | FAR,
     .tolerance = 1e-5, .edge = 13, .wall = 1, .ratio = 1},
    {.name = "slab, slit", .choose = choose_slab, .can = OVERLAPS | POSITIVE | RANKS | FAR,
     .tolerance = 1e-5, .edge = 13, .wall = 1, .height = 16, .ratio = 1},
    {.name = "slab, no flux", .choose = choose_slab, .can = OVERLAPS | POSITIVE | RANKS | FAR,
     .tolerance = 1e-5, .edge = 13, .wall = 1, .height = 16, .no_flux = 1, .ratio = 1},
    {.name = "shells, all pairs", .choose = choose_all_pairs, .can = TORQUES | POSITIVE | FAR,
     .tolerance = 2e-3, .ratio = 1, .shell = 12},
    {.name = "shells, wall", .choose = choose_all_pairs, .can = TORQUES | POSITIVE | FAR,
     .tolerance = 2e-3, .wall = 1, .ratio = 1, .shell = 12},
    {.name = "shells, Ewald, cube", .choose = choose_one_level, .can = TORQUES | POSITIVE | FAR,
     .tolerance = 2e-3, .rounding = 1e-6, .edge = 13, .ratio = 1, .shell = 12},
    {.name = "shells, Ewald, wall", .choose = choose_one_level, .can = TORQUES | POSITIVE | FAR,
     .tolerance = 2e-3, .wall = 1, .ratio = 1, .shell = 12},
    /* near a floor a shell differs from a sphere of one point by its model, and so do all its images */
    {.name = "shells, floor", .choose = choose_slab, .can = POSITIVE | FAR,
     .tolerance = 1e-2, .edge = 13, .wall = 1, .ratio = 1, .shell = 12},
};
enum { CLIMBERS = sizeof(climbers) / sizeof(climbers[0]) };

#endif
