/* The kernel of the near part where points stand in groups, each of which fits into a vector: what a point
 * of one group does to all points of another, and they to it, at once. No list says which of these pairs
 * are within the range. Included by sd_ewald_kernels.c. */

#if LANES >= 16

/* The columns of a group's rows, without force in the lanes beyond its end; yes where it has points */
INLINE yes_no load_group(const real *rows, int points, vec at[8])
{
  const yes_no there = load_any(row_of_lane) < all((real) points);
  load_rows_of_eight(rows, at);
  for (int c = 4; c < 7; c++) at[c] = where(there, at[c], all(0.0));
  return there;
}

/* Groups may be anywhere in memory: the rows of one are fetched while those before it are at work. */
INLINE void fetch_group(const real *rows, const real *sums, long row)
{
  for (int k = 0; k < 8 * SD_GROUP_POINTS; k += LANES) sd_fetch(rows + 8 * row + k);
  for (int k = 0; k < 4 * SD_GROUP_POINTS; k += LANES) sd_fetch(sums + 4 * row + k);
}

/* The group itself: what its other points do to each */
INLINE void near_within(int equal, int degree, const near_constants *all_pairs, const vec at[8],
                        near_bunch *b)
{
  for (int q = 0; q < b->rows; q++) {
    const yes_no itself = load_any(row_of_lane) == all((real) q);
    const near_pairs m = near_radial(equal, 1, degree, all_pairs, b->row + q, at);
    vec F[3];
    for (int c = 0; c < 3; c++) F[c] = where(itself, all(0.0), at[4 + c]);
    near_add(&m, F, b->u[q]);
  }
}

/* Another group: v is what it feels of the points that are near it. */
INLINE void near_between(int equal, int degree, const near_constants *all_pairs, unsigned near,
                         const vec at[8], near_bunch *b, vec v[3])
{
  for (; near; near &= near - 1) {
    const int q = __builtin_ctz(near);
    const near_pairs m = near_radial(equal, 1, degree, all_pairs, b->row + q, at);
    near_add(&m, at + 4, b->u[q]);
    near_add_of(b->row + q, &m, v);
  }
}

INLINE void near_group_forces(int equal, int degree, const sd_near_part *p, const sd_near_groups *g)
{
  const real *rows = p->row;
  near_polynomials shared;
  near_polynomials_of(p, &shared);
  const near_constants all_pairs = near_constants_of(p);
  for (int k = 0; k < g->groups; k++) {
    near_bunch b;
    if (g->begin[k] == g->begin[k + 1]) continue;
    near_bunch_begin(equal, degree, p, &shared, g->first[k], g->first[k + 1] - g->first[k], &b);
    for (long e = g->begin[k]; e < g->begin[k + 1]; e++) {
      const int other = g->near[e].other;
      const long row = g->first[other];
      vec at[8], v[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
      const yes_no there = load_group(rows + 8 * row, g->first[other + 1] - (int) row, at);
      if (e + 1 < g->begin[k + 1]) fetch_group(rows, p->u, g->first[g->near[e + 1].other]);
      if (other == k) {
        near_within(equal, degree, &all_pairs, at, &b);
        continue;
      }
      near_between(equal, degree, &all_pairs, g->near[e].points, at, &b, v);
      for (int c = 0; c < 3; c++) v[c] = where(there, v[c], all(0.0));
      add_to_rows_of_four((real *) p->u + 4 * row, v);
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
SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE

static void near_groups(const sd_near_part *p, const sd_near_groups *g)
{
#define OF_DEGREE(d)                                              \
  if (p->degree == (d)) {                                         \
    (p->equal ? groups_equal_##d : groups_any_##d)(p, g);         \
    return;                                                       \
  }
  SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}

#define NEAR_GROUPS near_groups
#else
#define NEAR_GROUPS NULL
#endif
