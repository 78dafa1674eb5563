/* Between the parts of sd_grid.h: which rank has which pencils and how long messages are
 * (sd_grid_share.c), which boxes of bricks go where (sd_grid_pieces.c), the way of the numbers
 * (sd_grid_fields.c, for doubles and for floats), and the memory of it. */
#ifndef SD_GRID_INTERNAL_H
#define SD_GRID_INTERNAL_H

#include <stddef.h>

#include "sd_grid.h"
#include "sd_isa.h"

/* --- who has what --- */

/* The columns of ranks for a grid whose first direction is d */
int sd_grid_columns(const sd_grid *g, int d);
/* What a rank has of `all` planes: first and end */
void sd_grid_range(int all, sd_grid_part what, int rank, int rows, int columns, int *range);
void sd_grid_range_of(const sd_grid *g, sd_grid_part what, int rank, int *range);
int sd_grid_length(const sd_grid *g, sd_grid_part what, int rank);
/* The length of this rank's */
int sd_grid_own(const sd_grid *g, sd_grid_part what);
/* Rows share the wave numbers of y so that the waves [size y] at them are even: g->first_y */
void sd_grid_share_waves(sd_grid *g, const int *waves);
/* Waves of our z that are left at the y of a rank of our column */
long sd_grid_waves_of(const sd_grid *g, int rank);
/* Of our z those that are left at y */
static inline int sd_grid_depth(const sd_grid *g, int y)
{
  return (int) (g->before[y + 1] - g->before[y]);
}

/* --- messages: sd_grid.counts --- */

enum { PIECES_TO, PIECES_FROM, ROW_TO, ROW_FROM, COLUMN_TO, COLUMN_FROM };

/* So many numbers more to or from a rank, after `all` others of the message, and what fills them up to
 * whole doubles; 0: more than an int counts */
int sd_grid_count(const sd_grid *g, int which, int rank, long numbers, long *all);
/* Of both turns; 0 as above */
int sd_grid_count_turns(const sd_grid *g);
size_t sd_grid_largest_message(const sd_grid *g);

/* --- numbers --- */

/* Of our lines of a plane of points, two are one row of complex numbers: their real and imaginary parts. */
int sd_grid_pairs(const sd_grid *g);

/* Complex numbers of a field of the slab */
long sd_grid_slab_field(const sd_grid *g);

/* Loops in vectors: between the transform of a complex line of n points and the first `waves` of those of its
 * real and of its imaginary part, a and b; join takes the others for 0. And between rows a and b of n points,
 * three numbers each, and lines of three fields whose parts they are: added to these, or taken from them. */
struct sd_grid_kernels {
  void (*part)(const void *both, int n, int waves, void *a, void *b);
  void (*join)(const void *a, const void *b, int n, int waves, void *both);
  void (*add)(const void *a, const void *b, int n, void *const *line);
  void (*take)(void *a, void *b, int n, void *const *line);
};

SD_KERNEL_TABLES(struct sd_grid_kernels, sd_grid);
SD_KERNEL_TABLES(struct sd_grid_kernels, sd_grid_single);

/* Numbers of one precision */
struct sd_grid_fields {
  /* plans of g, from its planes; 0: no memory */
  int (*plan)(sd_grid *g);
  void (*forget)(sd_grid *g);
  sd_status (*convolve)(sd_grid *g, sd_grid_multiply *multiply, void *ctx);
  sd_status (*convolve_values)(sd_grid *g, sd_grid_fill *fill, void *fill_ctx,
                               sd_grid_multiply *multiply, void *ctx);
};

extern const struct sd_grid_fields sd_grid_doubles, sd_grid_floats;

/* --- pieces --- */

/* Of bricks [ranks][6]: outs of ours in the pencils of all ranks, ins of all ranks in ours. out, in
 * NULL: only counted */
void sd_grid_list_pieces(const sd_grid *g, const int *bricks, sd_piece *out, sd_piece *in, int *outs,
                         int *ins);
/* Where each begins in its message, and how long that is; our own need none. 0 as above */
int sd_grid_count_pieces(const sd_grid *g, sd_piece *list, int pieces, int which);

#endif
