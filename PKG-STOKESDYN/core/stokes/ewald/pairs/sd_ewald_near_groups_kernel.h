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
  for (int k = 0; k < 8 * SD_GROUP_POINTS; k += LANES) __builtin_prefetch(rows + 8 * row + k);
  for (int k = 0; k < 4 * SD_GROUP_POINTS; k += LANES) __builtin_prefetch(sums + 4 * row + k, 1);
}

/* The group itself: what its other points do to each */
INLINE void near_within(int equal, int degree, const near_constants *all_pairs, const near_first *first,
                        int points, const vec at[8], vec u[SD_GROUP_POINTS][3])
{
  for (int q = 0; q < points; q++) {
    const yes_no itself = load_any(row_of_lane) == all((real) q);
    vec f, h, d[3], F[3];
    near_radial(equal, 1, degree, all_pairs, first + q, at, d, &f, &h);
    for (int c = 0; c < 3; c++) F[c] = where(itself, all(0.0), at[4 + c]);
    near_add(f, h, d, F, u[q]);
  }
}

/* Another group: v is what it feels of the points that are near it. */
INLINE void near_between(int equal, int degree, const near_constants *all_pairs, const near_first *first,
                         unsigned near, const vec at[8], vec u[SD_GROUP_POINTS][3], vec v[3])
{
  for (; near; near &= near - 1) {
    const int q = __builtin_ctz(near);
    vec f, h, d[3], G[3];
    near_radial(equal, 1, degree, all_pairs, first + q, at, d, &f, &h);
    near_add(f, h, d, at + 4, u[q]);
    near_all_forces(first + q, G);
    near_add(f, h, d, G, v);
  }
}

INLINE void near_group_forces(int equal, int degree, const sd_near_part *p, const sd_near_groups *g)
{
  const real *rows = p->row;
  near_polynomials shared;
  near_polynomials_of(p, &shared);
  const near_constants all_pairs = near_constants_of(p);
  for (int k = 0; k < g->groups; k++) {
    const int begin = g->first[k], points = g->first[k + 1] - begin;
    near_first first[SD_GROUP_POINTS];
    real mine[SD_GROUP_POINTS][4 * SD_RADIAL_TERMS];
    vec u[SD_GROUP_POINTS][3];
    if (g->begin[k] == g->begin[k + 1]) continue;
    for (int q = 0; q < points; q++) {
      const real *own = rows + 8 * (long) (begin + q);
      if (!equal) polynomials_of_target(p, ((double) own[3] * own[3] - p->ref2) / 6.0, degree, mine[q]);
      first[q] = near_first_of(own, equal ? shared.of[0] : mine[q]);
      u[q][0] = u[q][1] = u[q][2] = all(0.0);
    }
    for (long e = g->begin[k]; e < g->begin[k + 1]; e++) {
      const int other = g->near[e].other;
      const long row = g->first[other];
      vec at[8], v[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
      const yes_no there = load_group(rows + 8 * row, g->first[other + 1] - (int) row, at);
      if (e + 1 < g->begin[k + 1]) fetch_group(rows, p->u, g->first[g->near[e + 1].other]);
      if (other == k) {
        near_within(equal, degree, &all_pairs, first, points, at, u);
        continue;
      }
      near_between(equal, degree, &all_pairs, first, g->near[e].points, at, u, v);
      for (int c = 0; c < 3; c++) v[c] = where(there, v[c], all(0.0));
      add_to_rows_of_four((real *) p->u + 4 * row, v);
    }
    for (int q = 0; q < points; q++)
      for (int c = 0; c < 3; c++) ((real *) p->u)[4 * (long) (begin + q) + c] += total(u[q][c]);
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
