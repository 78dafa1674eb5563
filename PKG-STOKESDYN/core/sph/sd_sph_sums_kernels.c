/* The loops of SPH. What a scene does not ask for is a constant 0 in its copy of a loop, so the
 * compiler drops it. */
#if SD_LANES > 1 /* there are no loops in plain C */
#include "sd_sph_both_loops.h"
#include "sd_sph_forces_loop.h"
#include "sd_sph_half_loops.h"

/* What a scene asks for picks one of many copies. Each is a function of its own, since a compiler
 * takes minutes over one function that has them all. A table lists them in the order in which these
 * macros make them: its index has a bit for each choice, the first one highest. */
#define TWICE(next, ...) next(__VA_ARGS__, 0) next(__VA_ARGS__, 1)
/* All copies of a loop for the two kernels, each for one class and for many. */
#define BY_KERNEL(next, ...)                                           \
  TWICE(next, __VA_ARGS__, SD_SPH_CUBICSPLINE) TWICE(next, __VA_ARGS__, SD_SPH_WENDLAND)
#define BY_ARTVISC(next, ...) BY_KERNEL(next, __VA_ARGS__, 0) BY_KERNEL(next, __VA_ARGS__, 1)
#define BY_TENSCORR(next, ...) BY_ARTVISC(next, __VA_ARGS__, 0) BY_ARTVISC(next, __VA_ARGS__, 1)
#define BY_FRICTION(next, ...) BY_TENSCORR(next, __VA_ARGS__, 0) BY_TENSCORR(next, __VA_ARGS__, 1)
#define BY_RATES(next) BY_FRICTION(next, 0) BY_FRICTION(next, 1)

static int kernel_copy(const sd_sph_model *model)
{
  return 2 * model->kernel + (model->nclasses > 1);
}

#define FORCES(name, ...)                                                                         \
  static double name(const sd_sph_model *model, const sd_sph_list *list,                          \
                     const sd_sph_particles *p, double *f4, double *each)                         \
  {                                                                                               \
    return forces(model, list, p, f4, each, (terms) __VA_ARGS__);                                 \
  }
#define PLAIN_NAME(rates, rubs, tenscorr, artvisc, kernel, many) \
  plain_##rates##rubs##tenscorr##artvisc##kernel##many
#define PLAIN(rates, rubs, tenscorr, artvisc, kernel, many)                                       \
  FORCES(PLAIN_NAME(rates, rubs, tenscorr, artvisc, kernel, many),                                \
         {kernel, many, artvisc, tenscorr, rates, rubs ? model->friction : SD_SPH_INVISCID,       \
          SD_SPH_PLAIN})
#define PLAIN_ENTRY(...) PLAIN_NAME(__VA_ARGS__),
/* The schemes beyond the plain one have no tensCorr and no rates, and look at the model for the
 * terms. */
#define SCHEME(scheme, kernel, many)                                                              \
  FORCES(scheme##kernel##many,                                                                    \
         {kernel, many, model->artvisc, 0, 0, model->friction, scheme})
#define SLOPES(scheme, kernel, many)                                                              \
  static double slopes##scheme##kernel##many(                                                     \
      const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p, double *f4,  \
      double *each)                                                                               \
  {                                                                                               \
    return slopes(model, list, p, f4, each,                                                       \
                  (terms){kernel, many, model->artvisc, 0, 0, model->friction,                    \
                          scheme});                                                               \
  }
#define SLOPES_ENTRY(scheme, kernel, many) slopes##scheme##kernel##many,
#define SCHEME_ENTRY(scheme, kernel, many) scheme##kernel##many,
BY_RATES(PLAIN)
BY_KERNEL(SCHEME, SD_SPH_SHIFT)
BY_KERNEL(SCHEME, SD_SPH_VOLUME)
BY_KERNEL(SCHEME, SD_SPH_VOLUME_SHIFT)
BY_KERNEL(SLOPES, SD_SPH_CORRECTION)
BY_KERNEL(SLOPES, SD_SPH_VOLUME_CORRECTION)

static double all_forces(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, int with_rates, double *f4, double *each)
{
  typedef double copy(const sd_sph_model *, const sd_sph_list *, const sd_sph_particles *, double *,
                      double *);
  static copy *const plain[] = {BY_RATES(PLAIN_ENTRY)};
  static copy *const scheme[][4] = {
      [SD_SPH_SHIFT] = {BY_KERNEL(SCHEME_ENTRY, SD_SPH_SHIFT)},
      [SD_SPH_VOLUME] = {BY_KERNEL(SCHEME_ENTRY, SD_SPH_VOLUME)},
      [SD_SPH_VOLUME_SHIFT] = {BY_KERNEL(SCHEME_ENTRY, SD_SPH_VOLUME_SHIFT)}};
  const int has = 8 * !!with_rates + 4 * !!model->friction + 2 * !!model->tenscorr +
      !!model->artvisc;
  copy *const chosen = model->scheme == SD_SPH_PLAIN
      ? plain[4 * has + kernel_copy(model)]
      : scheme[model->scheme][kernel_copy(model)];
  return chosen(model, list, p, f4, each);
}

#define RATES(ignored, volume, kernel, many)                       \
  case ((volume) << 2) + ((kernel) << 1) + (many):                 \
    rates(model, list, p, rate, near, kernel, many, volume);       \
    break;

static void all_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      double *rate, const sd_sph_near *near)
{
  switch (4 * sd_sph_of_fluids(model) + kernel_copy(model)) {
    BY_KERNEL(RATES, 0, 0)
    BY_KERNEL(RATES, 0, 1)
  }
}

static double all_slopes(const sd_sph_model *model, const sd_sph_both *list,
                         const sd_sph_particles *p, double *f4, double *each)
{
  typedef double copy(const sd_sph_model *, const sd_sph_both *, const sd_sph_particles *, double *,
                      double *);
  static copy *const copies[][4] = {{BY_KERNEL(SLOPES_ENTRY, SD_SPH_CORRECTION)},
                                    {BY_KERNEL(SLOPES_ENTRY, SD_SPH_VOLUME_CORRECTION)}};
  return copies[sd_sph_of_fluids(model)][kernel_copy(model)](model, list, p, f4, each);
}

#define LEVEL(level, volume, kernel, many)                                                        \
  static void level##volume##kernel##many(const sd_sph_model *model, const sd_sph_both *list,     \
                                          const sd_sph_particles *p, double *sums,                \
                                          const sd_sph_near *near)                                \
  {                                                                                               \
    middle(model, list, p, sums, near, kernel, many, level, volume);                              \
  }
#define LEVEL_ENTRY(level, volume, kernel, many) level##volume##kernel##many,
BY_KERNEL(LEVEL, SD_SPH_GRADIENT, 0)
BY_KERNEL(LEVEL, SD_SPH_GRADIENT, 1)
BY_KERNEL(LEVEL, SD_SPH_DISORDER, 0)
BY_KERNEL(LEVEL, SD_SPH_DISORDER, 1)
BY_KERNEL(LEVEL, SD_SPH_VELOCITY, 0)
BY_KERNEL(LEVEL, SD_SPH_MIXTURE, 1)

static void all_middle(const sd_sph_model *model, const sd_sph_both *list,
                       const sd_sph_particles *p, double *sums, const sd_sph_near *near)
{
  typedef void copy(const sd_sph_model *, const sd_sph_both *, const sd_sph_particles *, double *,
                    const sd_sph_near *);
  static copy *const copies[][2][4] = {
      [SD_SPH_GRADIENT] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_GRADIENT, 0)},
                           {BY_KERNEL(LEVEL_ENTRY, SD_SPH_GRADIENT, 1)}},
      [SD_SPH_DISORDER] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_DISORDER, 0)},
                           {BY_KERNEL(LEVEL_ENTRY, SD_SPH_DISORDER, 1)}},
      [SD_SPH_VELOCITY] = {{BY_KERNEL(LEVEL_ENTRY, SD_SPH_VELOCITY, 0)}},
      [SD_SPH_MIXTURE] = {{NULL}, {BY_KERNEL(LEVEL_ENTRY, SD_SPH_MIXTURE, 1)}}};
  const int volume = sd_sph_of_fluids(model);
  copies[sd_sph_level_of(model)][volume][kernel_copy(model)](model, list, p, sums, near);
}

#define DIFFUSION(ignored, kernel, many)                  \
  case ((kernel) << 1) + (many):                          \
    diffusion(model, list, p, rate, kernel, many);        \
    break;

static void all_diffusion(const sd_sph_model *model, const sd_sph_both *list,
                          const sd_sph_particles *p, double *rate)
{
  switch (kernel_copy(model)) {
    BY_KERNEL(DIFFUSION, 0)
  }
}

#define WEIGH(loop, kernel, many)                         \
  case ((kernel) << 1) + (many):                          \
    loop(model, list, p, q, sums, kernel, many);          \
    break;

static void all_weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const double *q, double *sums)
{
  switch (kernel_copy(model)) {
    BY_KERNEL(WEIGH, weigh)
  }
}

static void all_before_walls(const sd_sph_model *model, const sd_sph_list *list,
                             const sd_sph_particles *p, const double *q, double *sums)
{
  switch (kernel_copy(model)) {
    BY_KERNEL(WEIGH, before_walls)
  }
}

const sd_sph_loops SD_KERNELS(sd_sph_loops) = {all_forces, all_slopes,    all_rates,
                                               all_middle, all_diffusion, all_weigh,
                                               all_before_walls};
#endif
