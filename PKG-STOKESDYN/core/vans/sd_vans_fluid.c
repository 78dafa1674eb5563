#include "sd_vans.h"
#include "sd_vans_wall.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static double height_of(const sd_vans_mesh *mesh, int n)
{
  return mesh->dz > 0.0 ? mesh->dz : mesh->edge[n + 1] - mesh->edge[n];
}

void sd_vans_exchange(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, double dt,
                      const double *U, const double *phi, const double *vx, const double *drag,
                      const double *class_phi, const double *class_drag, double *b)
{
  const int N = mesh->ncell, yade = fluid->rules == SD_VANS_YADE;
  const double cap = 0.1 / dt;
  for (int n = 0; n < N; n++) {
    double density = 0.0; /* n<f>, force per volume of mixture */
    if (class_phi)
      for (int c = 0; c < fluid->nclass; c++) {
        const double a = fluid->class_radius[c];
        density += class_phi[(long) c * N + n] / (4.0 / 3.0 * PI * a * a * a) *
            class_drag[(long) c * N + n];
      }
    else
      density = phi[n] / (4.0 / 3.0 * PI * fluid->radius * fluid->radius * fluid->radius) * drag[n];
    const double slip = U[n + 1] - vx[n], size = fmax(fabs(slip), 1e-5);
    const double value = density / (yade ? size : copysign(size, slip)) / fluid->rho;
    b[n] = !(value > 0.0) ? 0.0 : value > cap ? cap : value;
  }
  if (yade) b[0] = 0.0;
}

int64_t sd_vans_steps(sd_vans_rules rules, double T, double *dt)
{
  if (rules == SD_VANS_YADE) {
    int64_t n = 0;
    for (double t = 0.0; t < T; t += *dt) n++;
    return n;
  }
  int64_t n = (int64_t) ceil(T / *dt * (1.0 - 1e-9));
  if (n < 1) n = 1;
  *dt = T / (double) n;
  return n;
}

/* ---- momentum -------------------------------------------------------------------------------------------------------------- */

/* Per node j: A_j viscous conductance nu/h, T_j = eN nut/h. Per slice j the row
 *   -(cl + T_j) x_(j-1) + (cd + T_j + T_(j+1)) x_j - (cu + T_(j+1)) x_(j+1) = ce U_j + cr,   x_j = U'_(j+1)      (times dz)  */
struct sd_vans_solver {
  int ncell;
  double *cl, *cu, *cd, *ce, *cr; /* constant in a solve */
  double *mix, *gap;              /* node: l^2/h, eN/h */
  double *nut, *T, *wall, *c, *g; /* of a step */
  double *wall_scale, *wall_cd,
      *wall_cr; /* e dz/width coef/8; cd and cr with the side walls of the step */
  double *sum;  /* over steps: U' */
  double *memory;
  sd_vans_wall_segment *table[2]; /* of either rules, made when first needed */
};

sd_vans_solver *sd_vans_solver_create(int ncell)
{
  sd_vans_solver *s = malloc(sizeof *s);
  const size_t n = (size_t) ncell + 1;
  double *m = calloc(16 * n, sizeof(double));
  if (!s || !m) {
    free(s);
    free(m);
    return 0;
  }
  s->ncell = ncell;
  s->memory = m;
  s->table[0] = s->table[1] = 0;
  double **arrays[] = {&s->cl,         &s->cu,      &s->cd,      &s->ce,   &s->cr, &s->mix,
                       &s->gap,        &s->nut,     &s->T,       &s->wall, &s->c,  &s->g,
                       &s->wall_scale, &s->wall_cd, &s->wall_cr, &s->sum};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) *arrays[k] = m + k * n;
  return s;
}

void sd_vans_solver_free(sd_vans_solver *solver)
{
  if (!solver) return;
  free(solver->memory);
  free(solver->table[0]);
  free(solver->table[1]);
  free(solver);
}

/* Distance between the velocities on both sides of node j. */
static double gap_of(const sd_vans_mesh *mesh, int j)
{
  const int M = mesh->ncell - 1;
  if (j == 0) return 0.5 * height_of(mesh, 0);
  if (j == M) return 0.5 * height_of(mesh, M - 1);
  return 0.5 * (height_of(mesh, j - 1) + height_of(mesh, j));
}

/* The value at node j of something known in the slices, linear between their middles. */
static double at_node(const sd_vans_mesh *mesh, const double *value, int j)
{
  const double below = height_of(mesh, j - 1), above = height_of(mesh, j);
  return (value[j - 1] * above + value[j] * below) / (above + below);
}

static double porosity_at_node(const sd_vans_mesh *mesh, const double *phi, int j)
{
  const int M = mesh->ncell - 1;
  return 1.0 - (j == 0 ? phi[0] : j == M ? phi[M - 1] : at_node(mesh, phi, j));
}

static double viscosity_at_node(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                                const double *phi, int j)
{
  return sd_vans_effective_viscosity(fluid, j == 0 ? phi[0] : at_node(mesh, phi, j), j == 0);
}

/* Weight of |dU| in the eddy viscosity at node j. */
static double mixing_at_node(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                             const double *length, int j)
{
  if (fluid->turbulence == SD_VANS_LAMINAR) return 0.0;
  if (fluid->sublayer) {
    const double nu = fluid->eta / fluid->rho, H = mesh->edge[mesh->ncell - 1];
    const double drive = fluid->rules == SD_VANS_YADE ? fluid->gx
                                                      : fluid->gx - fluid->dpdx / fluid->rho;
    if (mesh->edge[j] * sqrt(fabs(drive) * H) / nu < 11.3) return 0.0;
  }
  return length[j] * length[j] / gap_of(mesh, j);
}

/* Viscous flux through node j without its conductance: e_j x_j - e_(j-1) x_(j-1) + J_j, x from U (or a sum of U over steps). */
static double viscous_jump(int M, const double *phi, const double *vx, const double *U, int driven,
                           double u_top, double steps, int j)
{
  const double below = j == 0 ? 0.0 : (1.0 - phi[j - 1]) * U[j - 1];
  const double x = j < M ? U[j] : driven ? u_top * steps : U[M - 1];
  const double J = j == 0 ? 0.0 : phi[j] * vx[j] - phi[j - 1] * vx[j - 1];
  return (1.0 - phi[j]) * x - below + J * steps;
}

/* Rows from both ends to the middle, then back: two independent chains of divisions run at once. U[1..M] out. */
static void solve_rows(sd_vans_solver *s, int M, const double *cd, const double *cr, double *U)
{
  const double *T = s->T, *cl = s->cl, *cu = s->cu, *ce = s->ce;
  double *c = s->c, *g = s->g, *x = U + 1;
  const int half = M / 2;
  double c_low = 0.0, g_low = 0.0, c_top = 0.0, g_top = 0.0;
  int k = 0;
  for (; k < half; k++) {
    const int i = k, t = M - 1 - k;
    const double Li = cl[i] + T[i], Ui = cu[i] + T[i + 1], Lt = cl[t] + T[t], Ut = cu[t] + T[t + 1];
    const double wi = 1.0 / (cd[i] + T[i] + T[i + 1] - Li * c_low),
                 wt = 1.0 / (cd[t] + T[t] + T[t + 1] - Ut * c_top);
    g[i] = g_low = (ce[i] * x[i] + cr[i] + Li * g_low) * wi;
    g[t] = g_top = (ce[t] * x[t] + cr[t] + Ut * g_top) * wt;
    c[i] = c_low = Ui * wi;
    c[t] = c_top = Lt * wt;
  }
  if (M - 1 - k >= half) { /* M odd: one more row from the top */
    const int t = M - 1 - k;
    const double Lt = cl[t] + T[t], Ut = cu[t] + T[t + 1],
                 wt = 1.0 / (cd[t] + T[t] + T[t + 1] - Ut * c_top);
    g[t] = g_top = (ce[t] * x[t] + cr[t] + Ut * g_top) * wt;
    c[t] = c_top = Lt * wt;
  }
  double up = (g_top + c_top * g_low) / (1.0 - c_top * c_low), down = g_low + c_low * up;
  x[half] = up;
  if (half > 0) x[half - 1] = down;
  int t = half + 1, i = half - 2;
  for (; i >= 0; i--, t++) {
    x[t] = up = g[t] + c[t] * up;
    x[i] = down = g[i] + c[i] * down;
  }
  for (; t < M; t++) x[t] = up = g[t] + c[t] * up;
}

/* Side walls: half of the friction on U', half on U. Inlined for either rules. */
static inline void wall_rows(sd_vans_solver *s, int M, const sd_vans_wall_segment *table,
                             sd_vans_rules rules, double Re_factor, const double *U)
{
  const double *cd = s->cd, *cr = s->cr, *scale = s->wall_scale;
  double *wall = s->wall, *wall_cd = s->wall_cd, *wall_cr = s->wall_cr;
  for (int j = 0; j < M; j++) {
    const double u = U[j + 1], speed = fabs(u),
                 f = sd_vans_wall_lookup(table, rules, speed * Re_factor);
    const double K = scale[j] * f * (rules == SD_VANS_YADE ? speed * speed : speed);
    wall[j] = K;
    wall_cd[j] = cd[j] + K;
    wall_cr[j] = cr[j] - (rules == SD_VANS_YADE ? K : K * u);
  }
}

sd_status sd_vans_solve(sd_vans_solver *s, const sd_vans_mesh *mesh, const sd_vans_fluid *fluid,
                        int64_t nsteps, double dt, const double *phi, const double *vx,
                        const double *b, const double *length, const double *source, double *U,
                        double *nut, double *stress, double *moved, double *shear,
                        sd_vans_impulse *impulse)
{
  const int N = mesh->ncell, M = N - 1, yade = fluid->rules == SD_VANS_YADE;
  const double nu0 = fluid->eta / fluid->rho,
               drive = (yade ? fabs(fluid->gx) : fluid->gx) - fluid->dpdx / fluid->rho;

  for (int j = 0; j < N; j++) {
    s->mix[j] = mixing_at_node(mesh, fluid, length, j);
    s->gap[j] = porosity_at_node(mesh, phi, j) / gap_of(mesh, j);
  }
  double A = viscosity_at_node(mesh, fluid, phi, 0) / gap_of(mesh, 0);
  for (int j = 0; j < M; j++) {
    const double above = viscosity_at_node(mesh, fluid, phi, j + 1) / gap_of(mesh, j + 1),
                 dz = height_of(mesh, j);
    const double e = 1.0 - phi[j], e_above = 1.0 - phi[j + 1],
                 e_below = j > 0 ? 1.0 - phi[j - 1] : e;
    const double J = j > 0 ? phi[j] * vx[j] - phi[j - 1] * vx[j - 1] : 0.0,
                 J_above = phi[j + 1] * vx[j + 1] - phi[j] * vx[j];
    s->cl[j] = e * A * e_below;
    s->cu[j] = e * above * e_above;
    s->ce[j] = e * dz / dt;
    s->cd[j] = s->ce[j] + e * e * (A + above) + dz * b[j];
    s->cr[j] = e * (above * J_above - A * J) +
        dz * (b[j] * vx[j] + e * drive + (source ? source[j] : 0.0));
    A = above;
  }
  s->cl[0] = 0.0; /* U = 0 on the bottom */
  /* The surface is eliminated from the last row: its eddy viscosity T_M stays in the row only if the surface is driven. */
  const double cu_top = s->cu[M - 1], cd_top = s->cd[M - 1], cr_top = s->cr[M - 1];
  s->cu[M - 1] = 0.0;
  if (!fluid->driven) s->cd[M - 1] = cd_top - cu_top;

  const double *cd = s->cd, *cr = s->cr;
  const double wall_factor = fluid->width > 0.0 ? dt / fluid->width * fluid->wall_coef / 8.0 : 0.0,
               Re_factor = fluid->width / nu0;
  const sd_vans_wall_segment *table = 0;
  if (wall_factor != 0.0) {
    sd_vans_wall_segment **slot = &s->table[fluid->rules];
    if (!*slot) {
      *slot = malloc(SD_VANS_WALL_TABLE * sizeof **slot);
      if (!*slot) return SD_ENOMEMORY;
      sd_vans_wall_table(fluid->rules, *slot);
    }
    table = *slot;
    for (int j = 0; j < M; j++) s->wall_scale[j] = s->ce[j] * wall_factor;
    cd = s->wall_cd;
    cr = s->wall_cr;
  }
  double T_bottom = 0.0, T_surface = 0.0, wall_sum = 0.0;
  if (moved) memset(s->sum, 0, M * sizeof(double));

  for (int64_t step = 0; step < nsteps; step++) {
    for (int j = 0; j < N; j++) {
      s->nut[j] = s->mix[j] * fabs(U[j + 1] - U[j]);
      s->T[j] = s->gap[j] * s->nut[j];
    }
    const double T_top = s->T[M], T_low = s->T[0];
    if (fluid->driven)
      s->cr[M - 1] = cr_top + (cu_top + T_top) * fluid->u_top;
    else
      s->T[M] = 0.0;
    if (table) {
      if (yade)
        wall_rows(s, M, table, SD_VANS_YADE, Re_factor, U);
      else
        wall_rows(s, M, table, SD_VANS_CONSISTENT, Re_factor, U);
      if (moved)
        for (int j = 0; j < M; j++) wall_sum += s->wall[j] * (yade ? 1.0 : U[j + 1]);
    }

    solve_rows(s, M, cd, cr, U);
    U[N] = fluid->driven ? fluid->u_top : U[M];

    if (moved) {
      for (int j = 0; j < M; j++) s->sum[j] += U[j + 1];
      T_bottom += T_low * U[1];
      if (fluid->driven) T_surface += T_top * (fluid->u_top - U[M]);
      if (table)
        for (int j = 0; j < M; j++) wall_sum += s->wall[j] * U[j + 1];
    }
  }

  double check = 0.0;
  for (int j = 0; j < N; j++) {
    nut[j] = s->nut[j];
    stress[j] = fluid->rho * s->gap[j] * s->nut[j] * (U[j + 1] - U[j]);
    check += U[j + 1];
  }
  if (moved) {
    const double steps = (double) nsteps, rho_dt = fluid->rho * dt;
    double flux = viscosity_at_node(mesh, fluid, phi, 0) / gap_of(mesh, 0) *
        viscous_jump(M, phi, vx, s->sum, fluid->driven, fluid->u_top, steps, 0);
    impulse->driving = 0.0;
    impulse->bottom = -rho_dt * (flux + T_bottom);
    impulse->walls = -rho_dt * wall_sum;
    for (int j = 0; j < M; j++) {
      const double above = viscosity_at_node(mesh, fluid, phi, j + 1) / gap_of(mesh, j + 1) *
          viscous_jump(M, phi, vx, s->sum, fluid->driven, fluid->u_top, steps, j + 1);
      shear[j] = rho_dt * phi[j] * (above - flux);
      moved[j] = rho_dt * height_of(mesh, j) * b[j] * (s->sum[j] - vx[j] * steps) + shear[j];
      impulse->driving += rho_dt * steps * height_of(mesh, j) * (1.0 - phi[j]) * drive;
      flux = above;
    }
    moved[M] = shear[M] = 0.0;
    impulse->surface = rho_dt * (flux + T_surface);
  }
  return isfinite(check) ? SD_OK : SD_ENOTFINITE;
}

void sd_vans_stress(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *phi,
                    const double *length, const double *U, double *nut, double *stress)
{
  for (int j = 0; j < mesh->ncell; j++) {
    const double jump = U[j + 1] - U[j];
    nut[j] = mixing_at_node(mesh, fluid, length, j) * fabs(jump);
    stress[j] = fluid->rho * porosity_at_node(mesh, phi, j) * nut[j] * jump / gap_of(mesh, j);
  }
}

double sd_vans_momentum(const sd_vans_mesh *mesh, double rho, const double *phi, const double *U)
{
  double sum = 0.0;
  for (int n = 0; n < mesh->ncell - 1; n++) sum += (1.0 - phi[n]) * U[n + 1] * height_of(mesh, n);
  return rho * sum;
}

/* In the coordinate "volume of water below" the old and the new slices are two cuts of one column, in which U stays. */
double sd_vans_displace(const sd_vans_mesh *mesh, double rho, const double *phi_old,
                        const double *phi_new, double *U, double *scratch)
{
  const int M = mesh->ncell - 1;
  double *below = scratch, *old = scratch + M + 1;
  const double surface = U[M + 1];
  below[0] = 0.0;
  for (int n = 0; n < M; n++) {
    below[n + 1] = below[n] + (1.0 - phi_old[n]) * height_of(mesh, n);
    old[n] = U[n + 1];
  }
  int source = 0;
  double lo = 0.0, through = 0.0;
  for (int n = 0; n < M; n++) {
    const double content = (1.0 - phi_new[n]) * height_of(mesh, n), hi = lo + content;
    double at = lo, momentum = 0.0;
    while (source < M && below[source + 1] < hi) {
      momentum += old[source] * (below[source + 1] - at);
      at = below[++source];
    }
    const double rest = hi - at, u = source < M ? old[source] : surface;
    momentum += u * rest;
    if (source == M) through += u * rest; /* water from above the surface */
    if (content > 0.0) U[n + 1] = momentum / content;
    lo = hi;
  }
  /* What no slice has taken has left through the surface. */
  for (; source < M; source++) {
    const double from = below[source] > lo ? below[source] : lo;
    through -= old[source] * (below[source + 1] - from);
  }
  return rho * through;
}
