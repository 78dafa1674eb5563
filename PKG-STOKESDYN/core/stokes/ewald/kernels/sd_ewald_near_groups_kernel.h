/* The kernel of the near part where points stand in groups: a group is the bunch, and those points of others
 * that are near it are taken vector by vector, wherever they are. Nobody keeps a list of points: it is made
 * of bits, a group at a time. Included by sd_ewald_kernels.c. */

#if LANES >= 16

/* A vector takes points of two groups or three. */
enum { AHEAD_OF_GROUPS = 3 };

/* The group itself: what its other points do to each */
INLINE void near_within(int equal, int degree, const sd_near_part *p, const near_constants *all_pairs,
                        int nowhere, near_bunch *b)
{
  int j[LANES];
  vec at[8];
  for (int q = 0; q < LANES; q++) j[q] = q < b->rows ? b->begin + q : nowhere;
  gather_eight(p->row, j, at);
  for (int q = 0; q < b->rows; q++) {
    const yes_no itself = (vec) LANEWISE(NUMBER, 0) == all((real) q);
    const near_pairs m = near_radial(equal, 1, degree, all_pairs, b->row + q, at);
    vec F[3];
    for (int c = 0; c < 3; c++) F[c] = where(itself, all(0.0), at[4 + c]);
    near_add(&m, F, b->u[q]);
  }
}

/* The group and so many points of others */
INLINE void near_between(int equal, int degree, const sd_near_part *p, const near_constants *all_pairs,
                         const int *j, near_bunch *b)
{
  vec at[8], v[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
  gather_eight(p->row, j, at);
  near_bunch_add(equal, 0, degree, all_pairs, b, at, v);
  add_to_rows(p->u, 4, j, v);
}

/* Groups may be anywhere in memory: the rows of one are fetched while those before it are at work. */
INLINE void fetch_group(const sd_near_part *p, long row)
{
  const real *rows = p->row, *sums = p->u;
  for (int k = 0; k < 8 * SD_GROUP_POINTS; k += LANES) sd_fetch(rows + 8 * row + k);
  for (int k = 0; k < 4 * SD_GROUP_POINTS; k += LANES) sd_fetch(sums + 4 * row + k);
}

COPIED void near_group_forces(int equal, int degree, const sd_near_part *p, const sd_near_groups *g)
{
  near_polynomials shared;
  near_polynomials_of(p, &shared);
  const near_constants all_pairs = near_constants_of(p);
  const int nowhere = g->first[g->groups];
  for (int k = 0; k < g->groups; k++) {
    near_bunch b;
    int list[3 * LANES], many = 0;
    if (g->begin[k] == g->begin[k + 1]) continue;
    near_bunch_begin(equal, degree, p, &shared, g->first[k], g->first[k + 1] - g->first[k], &b);
    for (long e = g->begin[k]; e < g->begin[k + 1]; e++) {
      const int other = g->near[e].other, row = g->first[other];
      const unsigned points = g->near[e].points;
      if (e + AHEAD_OF_GROUPS < g->begin[k + 1]) fetch_group(p, g->first[g->near[e + AHEAD_OF_GROUPS].other]);
      if (other == k) {
        near_within(equal, degree, p, &all_pairs, nowhere, &b);
        continue;
      }
      many += keep_next(list + many, row, points & 0xff);
      many += keep_next(list + many, row + 8, points >> 8);
      if (many < LANES) continue;
      near_between(equal, degree, p, &all_pairs, list, &b);
      many -= LANES;
      memcpy(list, list + LANES, sizeof(int) * LANES);
    }
    if (many > 0) {
      for (int l = many; l < LANES; l++) list[l] = nowhere;
      near_between(equal, degree, p, &all_pairs, list, &b);
    }
    near_bunch_end(&b, p->u);
  }
}

#define OF_DEGREE(d)                                                               \
  static void groups_equal_##d(const sd_near_part *p, const sd_near_groups *g)     \
  {                                                                                \
    near_group_forces(1, d, p, g);                                                 \
  }                                                                                \
  static void groups_any_##d(const sd_near_part *p, const sd_near_groups *g)       \
  {                                                                                \
    near_group_forces(0, d, p, g);                                                 \
  }
ALL_DEGREES(OF_DEGREE)
#undef OF_DEGREE

static void near_groups(const sd_near_part *p, const sd_near_groups *g)
{
#define OF_DEGREE(d)                                              \
  if (p->degree == (d)) {                                         \
    (p->equal ? groups_equal_##d : groups_any_##d)(p, g);         \
    return;                                                       \
  }
  ALL_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}

/* Points are so far from a middle as rounding of floats leaves open, too: the kernel of pairs looks again. */
static long groups_near(const sd_group_places *g, int k, const int *group, long many, double distance,
                        sd_near_group *near)
{
  const vec most = all((real) (distance * distance * (1.0 + HAIR)));
  long found = 0;
  for (long e = 0; e < many; e++) {
    const long other = group[e], later = group[e + AHEAD_OF_GROUPS < many ? e + AHEAD_OF_GROUPS : e];
    vec square = all(0.0);
    for (long d = 0; d < 3; d++) {
      const double *middle = g->middle + d * g->stride;
      sd_fetch(g->arm + SD_GROUP_LANES * (3 * later + d));
      const vec between = all((real) (middle[other] - middle[k]));
      const vec to = load_any(g->arm + SD_GROUP_LANES * (3 * other + d)) + between;
      square += to * to;
    }
    near[found] = (sd_near_group){(int) other, bits(square <= most)};
    found += near[found].points != 0;
  }
  return found;
}

#define NEAR_GROUPS near_groups
#define GROUPS_NEAR groups_near
#else
#define NEAR_GROUPS NULL
#define GROUPS_NEAR NULL
#endif
