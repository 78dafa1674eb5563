/* What a solve begins from: the answer of the last one, or the line through the last two. Which of them was
 * nearer to an answer decides for the next guess. And forces as a guess, where velocities are given. */
#ifndef SD_GUESS_LINE_H
#define SD_GUESS_LINE_H

#include <stddef.h>

#include "sd_extern_c.h"

SD_BEGIN_C

/* On the line (1), or as the last answer was (0). What had none before, 0, is on no line. */
static inline double sd_guess_at(double line, double last, double before)
{
  return before != 0.0 ? last + line * (last - before) : last;
}

/* The answers of one solve, as they come, and by how much the two guesses missed them: sums of squares, each
 * over its unit, 0 at first. again: it is the solve of the last step once more, as a run begins with it; then
 * the line is good if the last answer is nearer to this one than to the one before, which stays. */
typedef struct {
  int again;
  double off_last, off_line;
} sd_guess_answers;

/* x: a number of this answer; that of the last one and of the one before in and out */
static inline void sd_guess_take(sd_guess_answers *all, double x, double unit, double *last, double *before)
{
  const double change = (x - *last) / unit, along = (sd_guess_at(1.0, *last, *before) - *last) / unit;
  all->off_last += all->again ? along * along : change * change;
  all->off_line += all->again ? change * change : (change - along) * (change - along);
  if (!all->again) *before = *last;
  *last = x;
}

/* Where velocities are given, what is kept of forces is v' = F/D - s, what others add to the drag D [n] in
 * the slip s [n]: with the slip of now it makes a guess that is exact for spheres that nobody disturbs, at
 * any tolerance. Of forces on the fluid, exerted = -F [n]: */
void sd_guess_perturbation(size_t n, const double *D, const double *s, const double *exerted, double *v);
/* v: v' in, exerted out */
void sd_guess_exerted(size_t n, const double *D, const double *s, double *v);

SD_END_C
#endif
