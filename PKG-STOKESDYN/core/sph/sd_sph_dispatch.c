/* The sums over pairs in the widest vectors that this processor has. */
#include "sd_sph_sums.h"

/* Asked of the processor at each call: one test of a word that the compiler keeps. */
static const sd_sph_loops *loops(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return &sd_sph_loops_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &sd_sph_loops_avx2;
#endif
  return &sd_sph_loops_any;
}

double sd_sph_forces(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     int rates, double *f4, double *each)
{
  return loops()->forces(model, list, p, rates, f4, each);
}

double sd_sph_corrected_forces(const sd_sph_model *model, const sd_sph_both *list,
                               const sd_sph_particles *p, double *f4, double *each)
{
  return loops()->slopes(model, list, p, f4, each);
}

void sd_sph_rates(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  double *rate, const sd_sph_near *near)
{
  loops()->rates(model, list, p, rate, near);
}

void sd_sph_middle(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                   double *sums, const sd_sph_near *near)
{
  loops()->middle(model, list, p, sums, near);
}

void sd_sph_diffusion(const sd_sph_model *model, const sd_sph_both *list, const sd_sph_particles *p,
                      double *rate)
{
  loops()->diffusion(model, list, p, rate);
}

void sd_sph_weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  int fours, int walls, const double *q, double *sums)
{
  loops()->weigh(model, list, p, fours, walls, q, sums);
}
