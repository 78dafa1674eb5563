/* How the resistance of a clump is computed (sd_clump.h), and what that would need. */
#ifndef SD_CLUMP_OPTIONS_H
#define SD_CLUMP_OPTIONS_H

#include <stddef.h>

/* What a solve would need; nothing is allocated for it. Exposed points are not known yet: an upper
 * bound. */
typedef struct {
  long points;
  /* bytes */
  double dense, iterative;
} sd_clump_need;

typedef struct {
  /* 1, or the wanted number of points a sphere; see sd_shell_size */
  int shell;
  /* for shell 1: torques and angular velocities of spheres take part */
  int rotation;
  /* bytes that a solve may use: dense if it fits, else iterative, else SD_ENOMEMORY before anything
   * is allocated */
  double memory;
  /* of iterative solves */
  double tolerance;
  int max_iter;
  /* before every product of an iterative solve: which solve, of how many (twelve for each
   * orientation), products so far; NULL: none */
  void (*progress)(void *ctx, int solve, int solves, int products);
  void *progress_ctx;
} sd_clump_options;
#define SD_CLUMP_OPTIONS              \
  {                                   \
    1, 0, 2e9, 1e-8, 2000, NULL, NULL \
  } /* shell, rotation, memory, tolerance, max_iter */

#endif
