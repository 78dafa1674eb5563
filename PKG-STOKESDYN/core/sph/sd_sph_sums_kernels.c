/* The loops of SPH. What is a constant in a copy of a loop costs nothing there: the compiler drops
 * what it does not need. */
#if SD_LANES > 1 /* there are no loops in plain C */
#include "sd_sph_both_loops.h"
#include "sd_sph_forces_loop.h"
#include "sd_sph_half_loops.h"

/* The copy of a loop for this kernel, and for one class or many: what the innermost lines ask, a
 * tenth of the time where they had to. The terms of the force are branches that all pairs take the
 * same way, which costs nothing but in the scheme that has none of them. */
#define BY_KERNEL(loop, ...)                                                                      \
  (model->kernel == SD_SPH_WENDLAND ? BY_CLASSES(loop, __VA_ARGS__, SD_SPH_WENDLAND)              \
                                    : BY_CLASSES(loop, __VA_ARGS__, SD_SPH_CUBICSPLINE))
#define BY_CLASSES(loop, ...)                                                                     \
  (model->nclasses > 1 ? loop(__VA_ARGS__, 1) : loop(__VA_ARGS__, 0))

static double all_forces(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, int with_rates, double *f4, double *each)
{
#define FORCES(of_scheme)                                                                         \
  case of_scheme:                                                                                 \
    return BY_KERNEL(forces, model, list, p, f4, each,                                            \
                     ((terms){.artvisc = model->artvisc, .tenscorr = model->tenscorr,             \
                              .rates = with_rates, .friction = model->friction, .scheme = of_scheme}))
  const terms none = {.friction = SD_SPH_INVISCID, .scheme = SD_SPH_PLAIN};
  const int bare = model->scheme == SD_SPH_PLAIN && !model->artvisc && !model->tenscorr &&
      !model->friction && !with_rates;
  if (bare) return BY_KERNEL(forces, model, list, p, f4, each, none);
  switch (model->scheme) {
    FORCES(SD_SPH_PLAIN);
    FORCES(SD_SPH_SHIFT);
    FORCES(SD_SPH_SHIFT_PLIANT);
    FORCES(SD_SPH_VOLUME);
    FORCES(SD_SPH_VOLUME_SHIFT);
    default: return 0.0; /* corrected: all_slopes */
  }
}

static double all_slopes(const sd_sph_model *model, const sd_sph_both *list,
                         const sd_sph_particles *p, double *f4, double *each)
{
  terms has = {.artvisc = model->artvisc, .friction = model->friction, .scheme = SD_SPH_CORRECTION};
  if (!sd_sph_of_fluids(model)) return BY_KERNEL(slopes, model, list, p, f4, each, has);
  has.scheme = SD_SPH_VOLUME_CORRECTION;
  return BY_KERNEL(slopes, model, list, p, f4, each, has);
}

static void all_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      double *rate, const sd_sph_near *near)
{
  if (sd_sph_of_fluids(model))
    BY_KERNEL(rates, model, list, p, rate, near, 1);
  else
    BY_KERNEL(rates, model, list, p, rate, near, 0);
}

static void all_middle(const sd_sph_model *model, const sd_sph_both *list,
                       const sd_sph_particles *p, double *sums, const sd_sph_near *near)
{
#define MIDDLE(level)                                                                             \
  case level:                                                                                     \
    BY_KERNEL(middle, model, list, p, sums, near, level);                                         \
    break
  switch (sd_sph_level_of(model)) {
    MIDDLE(SD_SPH_GRADIENT);
    MIDDLE(SD_SPH_DISORDER);
    MIDDLE(SD_SPH_VELOCITY);
    MIDDLE(SD_SPH_MIXTURE);
    default: break; /* the rate alone: all_rates */
  }
}

static void all_diffusion(const sd_sph_model *model, const sd_sph_both *list,
                          const sd_sph_particles *p, double *rate)
{
  BY_KERNEL(diffusion, model, list, p, rate);
}

static void all_gradients(const sd_sph_model *model, const sd_sph_list *list,
                          const sd_sph_particles *p, double *sums)
{
  BY_KERNEL(gradients, model, list, p, sums);
}

static void all_weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const double *q, double *sums)
{
  BY_KERNEL(weigh, model, list, p, q, sums);
}

static void all_before_walls(const sd_sph_model *model, const sd_sph_list *list,
                             const sd_sph_particles *p, const double *q, const double *spins,
                             double *sums)
{
  BY_KERNEL(before_walls, model, list, p, q, spins, sums);
}

const sd_sph_loops SD_KERNELS(sd_sph_loops) = {all_forces,    all_slopes,    all_rates,
                                               all_middle,    all_diffusion, all_gradients,
                                               all_weigh,     all_before_walls};
#endif
