#include "sd_sph_density.h"

#include "sd_sph_visit.h"

void sd_sph_sums(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                 const double *rho, double *sums)
{
  sd_sph_visitor v;
  SD_SPH_VISIT(model, list, p, v)
  {
    const double W = v.k->weight * sd_sph_K(model->kernel, v.q);
    const double mi = sd_sph_mass(model, p, v.i), mj = sd_sph_mass(model, p, v.j);
    sums[2 * (size_t) v.i] += mj * W;
    sums[2 * (size_t) v.j] += mi * W;
    if (rho) {
      sums[2 * (size_t) v.i + 1] += mj / rho[v.j] * W;
      sums[2 * (size_t) v.j + 1] += mi / rho[v.i] * W;
    }
  }
}

/* What a particle adds to its own sum: m W(0, h). */
static double self(const sd_sph_model *model, const sd_sph_particles *p, int i)
{
  return sd_sph_mass(model, p, i) * model->pair[sd_sph_class_pair(model, p, i, i)].weight *
      sd_sph_K(model->kernel, 0.0);
}

void sd_sph_summation(const sd_sph_model *model, const sd_sph_particles *p, const double *sums,
                      int n, const int *mask, int bit, double *rho)
{
  for (int i = 0; i < n; i++)
    if (mask[i] & bit) rho[i] = sums[2 * (size_t) i] + self(model, p, i);
}

void sd_sph_shepard(const sd_sph_model *model, const sd_sph_particles *p, const double *sums, int n,
                    const int *mask, int bit, double *rho)
{
  for (int i = 0; i < n; i++) {
    if (!(mask[i] & bit)) continue;
    const double own = self(model, p, i), *s = sums + 2 * (size_t) i;
    rho[i] = (s[0] + own) / (s[1] + own / rho[i]);
  }
}

void sd_sph_gradient_sums(const sd_sph_model *model, const sd_sph_list *list,
                          const sd_sph_particles *p, const double *rho, double *sums)
{
  sd_sph_visitor v;
  SD_SPH_VISIT(model, list, p, v)
  {
    /* grad_i W = g d, d_ji = -d: both sums are even in d, so they differ between i and j by the
     * volumes only. */
    const double g = v.k->grad * sd_sph_G(model->kernel, v.q);
    const double *d = v.d, jump = (rho[v.j] - rho[v.i]) * g;
    const double even[9] = {-g * d[0] * d[0], -g * d[1] * d[1], -g * d[2] * d[2],
                            -g * d[0] * d[1], -g * d[0] * d[2], -g * d[1] * d[2],
                            jump * d[0],      jump * d[1],      jump * d[2]};
    const double Vi = sd_sph_mass(model, p, v.i) / rho[v.i],
                 Vj = sd_sph_mass(model, p, v.j) / rho[v.j];
    for (int c = 0; c < 9; c++) {
      sums[9 * (size_t) v.i + c] += Vj * even[c];
      sums[9 * (size_t) v.j + c] += Vi * even[c];
    }
  }
}

void sd_sph_gradient(int dimension, const double s[9], double g[3])
{
  const double xx = s[0], yy = s[1], zz = dimension == 2 ? 1.0 : s[2], xy = s[3];
  const double xz = dimension == 2 ? 0.0 : s[4], yz = dimension == 2 ? 0.0 : s[5];
  const double bx = s[6], by = s[7], bz = dimension == 2 ? 0.0 : s[8];
  const double cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - xz * yy;
  const double cyy = xx * zz - xz * xz, cyz = xy * xz - xx * yz, czz = xx * yy - xy * xy;
  const double det = xx * cxx + xy * cxy + xz * cxz;
  /* L is the unit matrix where the support is full, about half of it at a plane surface, and a
   * quarter in two directions along an edge: det > 1/64. Below 1e-3, a tenth in each of three
   * directions, neighbours are so few that the inverse would raise their noise tenfold. */
  if (!(det > 1e-3)) {
    g[0] = g[1] = g[2] = 0.0;
    return;
  }
  g[0] = (cxx * bx + cxy * by + cxz * bz) / det;
  g[1] = (cxy * bx + cyy * by + cyz * bz) / det;
  g[2] = (cxz * bx + cyz * by + czz * bz) / det;
}

void sd_sph_diffusion(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const double *rho, const double *gradient, double delta, double *rate)
{
  sd_sph_visitor v;
  SD_SPH_VISIT(model, list, p, v)
  {
    const double g = v.k->grad * sd_sph_G(model->kernel, v.q);
    const double *gi = gradient + 3 * (size_t) v.i, *gj = gradient + 3 * (size_t) v.j;
    double along = 0.0;
    for (int c = 0; c < 3; c++) along += (gi[c] + gj[c]) * v.d[c];
    /* psi . grad W = -g (2 (rho_j - rho_i) + (grad rho_i + grad rho_j) . d), odd under exchange of
     * i and j */
    const double flux = -delta * v.k->ch * g * (2.0 * (rho[v.j] - rho[v.i]) + along);
    rate[v.i] += sd_sph_mass(model, p, v.j) / rho[v.j] * flux;
    rate[v.j] -= sd_sph_mass(model, p, v.i) / rho[v.i] * flux;
  }
}
