#include "sd_sph_class.h"
#include "sd_linear.h"

int sd_sph_of_fluids(const sd_sph_model *model)
{
  return model->scheme == SD_SPH_VOLUME || model->scheme == SD_SPH_VOLUME_SHIFT ||
      model->scheme == SD_SPH_VOLUME_CORRECTION;
}

int sd_sph_shifts(const sd_sph_model *model)
{
  return model->scheme == SD_SPH_SHIFT || model->scheme == SD_SPH_SHIFT_PLIANT ||
      model->scheme == SD_SPH_VOLUME_SHIFT || sd_sph_corrects(model);
}

int sd_sph_corrects(const sd_sph_model *model)
{
  return model->scheme == SD_SPH_CORRECTION || model->scheme == SD_SPH_VOLUME_CORRECTION;
}

/* Everything about a pair of types that does not change from pair to pair. What no term of the
 * model uses stays 0, so that types that differ in nothing that matters are found to be alike. */
sd_sph_coefficients sd_sph_coefficients_of(const sd_sph_model *model, const sd_sph_parameters *p)
{
  const int dimension = model->dimension;
  const double h = p->h, volume = dimension == 3 ? h * h * h : h * h;
  const double N = sd_sph_norm(model->kernel, dimension);
  sd_sph_coefficients c = {.inv_h = 1.0 / h,
                           .grad = N / (volume * h * h),
                           .weight = N / volume,
                           .support = 2.0 * h};
  /* Pi has (-alpha c h + ...) 2 / (rho_a + rho_b) and s = h v.d / (r^2 + eta): factors that do not
   * depend on the pair are multiplied here, once a step. */
  if (model->artvisc) {
    c.a1 = 2.0 * p->alpha * p->c * h;
    c.b1 = 2.0 * p->beta * h * h;
  }
  /* f = W(r) / W(dp) = K(r/h) / K(dp/h): the norm cancels. Shifting takes f, too. */
  const int shifts = sd_sph_shifts(model);
  if (model->tenscorr || shifts) {
    const double K = sd_sph_K(model->kernel, p->deltap / h);
    c.tens = K > 0.0 ? 1.0 / K : 0.0;
  }
  /* Averaged over all directions, the part of v along d makes 1 / (D + 2) of the Laplacian. */
  if (model->friction)
    c.visc = 2.0 * p->mu * (model->friction == SD_SPH_CENTRAL ? dimension + 2 : 1);
  if (model->delta > 0.0) c.diffusion = model->delta * p->c * h;
  return c;
}

/* Far enough that every kernel is 0, near enough that the square of the distance is finite. */
static const double FAR = 1e100;

void sd_sph_pack_x(int n, const double *x, const double *v, const double *du, double shift,
                   double *x4)
{
  for (int i = 0; i < n; i++) {
    double *row = x4 + 4 * (size_t) i;
    for (int d = 0; d < 3; d++) row[d] = x[3 * (size_t) i + d];
    if (v)
      for (int d = 0; d < 3; d++) row[d] += shift * v[3 * (size_t) i + d];
    if (du)
      for (int d = 0; d < 3; d++) row[d] += shift * du[3 * (size_t) i + d];
  }
  for (int d = 0; d < 3; d++) x4[4 * (size_t) n + d] = FAR;
  x4[4 * (size_t) n + 3] = 0.0;
}

/* The far-away particle rests and has density 1, so that nothing is divided by 0. */
void sd_sph_pack_v(int n, const double *v, const double *rho, double *v4)
{
  for (int i = 0; i < n; i++) {
    for (int d = 0; d < 3; d++) v4[4 * (size_t) i + d] = v[3 * (size_t) i + d];
    v4[4 * (size_t) i + 3] = rho[i];
  }
  for (int d = 0; d < 3; d++) v4[4 * (size_t) n + d] = 0.0;
  v4[4 * (size_t) n + 3] = 1.0;
}

double sd_sph_reference(const sd_sph_model *model, double P0)
{
  return sd_sph_shifts(model) ? P0 : 0.0;
}

void sd_sph_pack_pressures(const sd_sph_model *model, int n, const double *P, double P0,
                           const double *rho, double *x4)
{
  /* Correction takes differences of P, volume weighs P with the other density; the plain force has
   * A. */
  const int as_is = sd_sph_corrects(model) || sd_sph_of_fluids(model);
  const double reference = sd_sph_reference(model, P0);
  for (int i = 0; i < n; i++) {
    const double acts = P[i] - reference;
    x4[4 * (size_t) i + 3] = as_is ? acts : acts / (rho[i] * rho[i]);
  }
}

void sd_sph_each_pair(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      sd_sph_meet *meet, double *out)
{
  for (int k = 0; k < list->n; k++) {
    const int i = list->first[k];
    for (int m = 0; m < list->count[i]; m++) {
      sd_sph_two two = {.i = i, .j = list->neighbor[i][m] & list->mask};
      sd_minus(p->x4 + 4 * (size_t) i, p->x4 + 4 * (size_t) two.j, two.d);
      two.r2 = sd_dot(two.d, two.d);
      two.pair = sd_sph_of_pair(model, p, i, two.j);
      if (two.r2 < two.pair->support * two.pair->support) meet(model, p, &two, out);
    }
  }
}
