#include "sd_sph_sums.h"

#include <string.h>

#include "sd_sph_internal.h"

/* Diffusion needs the gradient of the density, and M for it; shift also the disorder; where B acts,
 * also the gradient of the velocity, and of several fluids M of them all. */
sd_sph_level sd_sph_level_of(const sd_sph_model *model)
{
  if (sd_sph_corrects(model))
    return sd_sph_of_fluids(model) ? SD_SPH_MIXTURE : SD_SPH_VELOCITY;
  if (model->scheme == SD_SPH_SHIFT_PLIANT) return SD_SPH_VELOCITY;
  if (sd_sph_shifts(model)) return SD_SPH_DISORDER;
  return model->delta > 0.0 ? SD_SPH_GRADIENT : SD_SPH_RATE;
}

int sd_sph_sum_columns(sd_sph_level level)
{
  static const int columns[] = {1, 12, 16, 24, 32};
  return columns[level];
}

static int filled_up(int count)
{
  return (count + SD_SPH_LANES - 1) / SD_SPH_LANES * SD_SPH_LANES;
}

/* Each entry of the half list is there twice at most. */
size_t sd_sph_both_size(const sd_sph_list *half, int n)
{
  size_t size = SD_SPH_LANES * (size_t) (n + 1);
  for (int k = 0; k < half->n; k++) size += 2 * (size_t) half->count[half->first[k]];
  return size;
}

/* Counts what each particle gets, then hands it out, as one sorts by counting. */
void sd_sph_both_ways(const sd_sph_list *half, int filler, int *pool, sd_sph_both *out)
{
  const int n = out->n;
  memset(out->own, 0, sizeof(int) * (size_t) n);
  memset(out->count, 0, sizeof(int) * (size_t) n);
  for (int k = 0; k < half->n; k++) {
    const int i = half->first[k];
    out->own[i] = half->count[i];
    for (int m = 0; m < half->count[i]; m++) {
      const int j = half->neighbor[i][m] & half->mask;
      if (j < n) out->count[j]++;
    }
  }
  for (int i = 0; i < n; i++) {
    const int own = out->own[i], all = filled_up(own + out->count[i]);
    out->neighbor[i] = pool;
    for (int m = 0; m < own; m++) pool[m] = half->neighbor[i][m] & half->mask;
    for (int m = own + out->count[i]; m < all; m++) pool[m] = filler;
    out->count[i] = own;    // the next free place of the second part
    pool += all;
  }
  for (int k = 0; k < half->n; k++) {
    const int i = half->first[k];
    for (int m = 0; m < half->count[i]; m++) {
      const int j = half->neighbor[i][m] & half->mask;
      if (j < n) out->neighbor[j][out->count[j]++] = i;
    }
  }
  for (int i = 0; i < n; i++) out->count[i] = filled_up(out->count[i]);
}

void sd_sph_pairs_of_flow(const sd_sph_particles *p, const sd_sph_list *half, const sd_sph_near *in,
                          int fill, const sd_sph_near *out)
{
  int *last = out->pool;
  for (int k = 0; k < half->n; k++) {
    const int i = half->first[k], *from = in->neighbor[i], own = in->own[i],
              count = fill ? in->count[i] : own;
    int *to = out->neighbor[i] = last;
    for (int m = 0; m < count; m++) {
      if (m == own) out->own[i] = (int) (last - to);
      if (from[m] < p->n && !(p->phase[i] < 0 && p->phase[from[m]] < 0)) *last++ = from[m];
    }
    if (count == own) out->own[i] = (int) (last - to);
    while (fill && (last - to) % SD_SPH_LANES) *last++ = p->n;
    out->count[i] = (int) (last - to);
  }
}

/* --- the sums, in the widest vectors that this processor has -------------------------------------- */

static const sd_sph_loops *loops(void)
{
  return SD_KERNELS_OF(sd_sph_loops, baseline, sd_isa_of(SD_ISA_BEST));
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

void sd_sph_velocity_gradients(const sd_sph_model *model, const sd_sph_list *list,
                               const sd_sph_particles *p, double *sums)
{
  loops()->gradients(model, list, p, sums);
}

void sd_sph_weigh(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                  const double *q, double *sums)
{
  loops()->weigh(model, list, p, q, sums);
}

void sd_sph_before_walls(const sd_sph_model *model, const sd_sph_list *list,
                         const sd_sph_particles *p, const double *q, const double *spins,
                         double *sums)
{
  loops()->before_walls(model, list, p, q, spins, sums);
}
