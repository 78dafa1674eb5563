/* Resistance of clumps of the tables, of rows and of any spheres, for the core tests. */
#ifndef CLUMPS_H
#define CLUMPS_H

#include "table.h"

#include "sd_clump.h"
#include "sd_linear.h"
#include "sd_tensor.h"

static const char *const clusters[] = {"doublet",     "trimer_line", "triangle",  "square",
                                       "tetrahedron", "star4",       "tetrapod5", "octahedron",
                                       "hexagon7",    "cube8",       "fcc13",     "helix4_chiral"};
enum { N_CLUSTERS = 12, MOST = 64 };

static sd_shells shells; /* one cache for all tests */

static inline int free_shells(void **state)
{
  (void) state;
  sd_shells_free(&shells);
  return 0;
}

static inline sd_clump solve(int n, const double *x, const double *a, int shell, int rotation)
{
  sd_shape shape;
  sd_clump clump;
  sd_clump_options o = SD_CLUMP_OPTIONS;
  o.shell = shell;
  o.rotation = rotation;
  assert_int_equal(sd_shape_create(n, x, a, &shape), SD_OK);
  const sd_status status = sd_clump_create(&shape, &o, &shells, &clump, NULL);
  if (status != SD_OK) fail_msg("shell %d, %d spheres: %s", shell, n, sd_status_string(status));
  sd_shape_free(&shape);
  return clump;
}

static inline sd_clump solve_cluster(const char *name, int shell, int rotation)
{
  double x[3 * MOST], a[MOST];
  const int n = table_cluster(name, x, a);
  return solve(n, x, a, shell, rotation);
}

/* n spheres along z, spacing s */
static inline sd_clump solve_row(int n, double s, int shell, int rotation)
{
  double x[3 * MOST] = {0}, a[MOST];
  for (int k = 0; k < n; k++) {
    x[3 * k + 2] = s * k;
    a[k] = 1.0;
  }
  return solve(n, x, a, shell, rotation);
}

/* Eigenvalues of a diagonal block, smallest first, over unit */
static inline void eigenvalues(const double R[36], int block, double unit, double w[3])
{
  double A[9], V[9], v[3];
  for (int p = 0; p < 9; p++) A[p] = R[6 * (3 * block + p / 3) + 3 * block + p % 3] / unit;
  sd_eigen(3, A, v, V);
  for (int p = 0; p < 3; p++) w[p] = v[2 - p];
}

#endif
