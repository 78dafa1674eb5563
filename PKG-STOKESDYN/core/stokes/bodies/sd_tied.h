/* What the files of a tie share (sd_tie.h): its arrays, and who is tied. */
#ifndef SD_TIED_H
#define SD_TIED_H

#include "sd_block_cholesky.h"
#include "sd_body.h"
#include "sd_lubrication.h"

SD_BEGIN_C

/* Scratch that the caller lends, so many numbers of each body and each sphere; nothing is kept there. */
enum { SD_TIE_OF_BODY = 36, SD_TIE_OF_SPHERE = 12 };
typedef struct {
  double *bodies, *spheres;
} sd_tie_room;

/* Zero-initialise, set L, whose rows are the spheres; sd_tie_free in the end. */
typedef struct sd_tie {
  sd_lubrication *L;
  /* products with L since sd_tie_make */
  long products;
  /* of the bodies of this rank and of `others`, those of other ranks that are near */
  sd_block_cholesky factor;
  int others;
  /* does a stiff pair chain bodies together that more than two ranks share? The same on all of them */
  int severed;
  /* [6 (bodies + others)] 1 over the roots of the diagonal of H_0; 0: nobody is near to this body,
   * or this of its velocity is given */
  double *scale;
  /* [bodies] W of sd_tie_factor.h; [shares] bodies of this rank that others have too, where W is not 1, and
   * [edges] their spheres */
  double *weight;
  int *shared, *edge, shares, edges;
  /* [others] the copy, among the n_all - n of L, that stands for it */
  int *copy;
  /* X by pairs of L and those beyond, c; by spheres, X_ii of translations, xx yy zz xy xz yz; what springs
   * see of spheres and do to them [2 9 spheres], [9 others], 6 where rows are spheres */
  double *spring, *stiff, *face, *faces_there;
  /* scratch: by bodies and others, by copies */
  double *all, *copies;
  size_t most_scales, most_weights, most_shared, most_edges, most_copies, most_springs, most_stiff, most_all,
      most_rows_there, most_faces, most_faces_there;
} sd_tie;

/* Is there an X? */
static inline int sd_tie_has_springs(const sd_bodies *A)
{
  return A->tie->L->model && (!A->points.whole || A->faces);
}
/* Is V of body b that of sd_tie_solve? */
static inline int sd_tie_binds(const sd_bodies *A, int b)
{
  const double *scale = A->tie->scale + 6 * (long) b; /* of a pinned one that of W alone is not 0 */
  return scale[0] != 0.0 || scale[3] != 0.0;
}

SD_END_C
#endif
