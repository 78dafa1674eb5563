#include "sd_vans_yade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int64_t sd_vans_steps(sd_vans_rules rules, double T, double *dt)
{
  if (rules == SD_VANS_YADE) return sd_vans_yade_steps(T, *dt);
  int64_t n = (int64_t) ceil(T / *dt * (1.0 - 1e-9));
  if (n < 1) n = 1;
  *dt = T / (double) n;
  return n;
}

double sd_vans_drive(const sd_vans_fluid *fluid)
{
  const double gx = fluid->rules == SD_VANS_YADE ? fabs(fluid->gx) : fluid->gx;
  return gx - fluid->dpdx / fluid->rho;
}

/* ---- momentum -------------------------------------------------------------------------------- */

/* Per node j: A_j viscous conductance nu/h, T_j = eN nut/h. Per slice j the row (times dz), x_j =
 * U'_(j+1),
 *   -(cl + T_j) x_(j-1) + (cd + T_j + T_(j+1)) x_j - (cu + T_(j+1)) x_(j+1) = ce U_j + cr
 * with, e = 1 - phi and J_j = phi_j v_j - phi_(j-1) v_(j-1),
 *   cl = e_j A_j e_(j-1)    cu = e_j A_(j+1) e_(j+1)    ce = e_j dz/dt    cd = ce + e_j^2 (A_j +
 *                           A_(j+1)) + dz b_j
 *   cr = e_j (A_(j+1) J_(j+1) - A_j J_j) + dz (b_j v_j + e_j drive + source_j) */
/* Side walls, if any */
typedef struct {
  int on;
  double Re_factor, least_speed;
  /* e dz/width coef/8; of a step: friction, cd and cr with it */
  double *scale, *K, *cd, *cr;
  sd_vans_friction *friction;
  /* friction over steps */
  double sum;
} side_walls;

/* Over steps: U', the fluxes through the turbulent bottom and surface, and the drive */
typedef struct {
  double *U, bottom, surface, drive;
} sums;

struct sd_vans_solver {
  const sd_vans_mesh *mesh;
  /* constant in a solve */
  double *cl, *cu, *cd, *ce, *cr;
  double drive, cu_top, cr_top;
  /* with the discharge held: dz e, what a unit of drive does to U' in a step */
  double *content, *response;
  /* node: l^2/h, eN/h */
  double *mix, *gap;
  /* of a step */
  double *nut, *T, *c, *g;
  side_walls wall;
  sums over;
  double *memory;
};

sd_vans_solver *sd_vans_solver_create(const sd_vans_mesh *mesh)
{
  sd_vans_solver *s = malloc(sizeof *s);
  const size_t n = (size_t) mesh->ncell + 1;
  double *m = calloc(18 * n, sizeof(double));
  sd_vans_friction *friction = calloc(n, sizeof *friction);
  if (!s || !m || !friction) {
    free(s);
    free(m);
    free(friction);
    return 0;
  }
  s->mesh = mesh;
  s->memory = m;
  s->wall.friction = friction;
  double **arrays[] = {&s->cl,  &s->cu,     &s->cd,      &s->ce,      &s->cr,     &s->mix,
                       &s->gap, &s->nut,    &s->T,       &s->c,       &s->g,      &s->over.U,
                       &s->wall.cd,         &s->wall.cr, &s->wall.K,  &s->wall.scale,
                       &s->content,         &s->response};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) *arrays[k] = m + k * n;
  return s;
}

void sd_vans_solver_free(sd_vans_solver *solver)
{
  if (!solver) return;
  free(solver->memory);
  free(solver->wall.friction);
  free(solver);
}

/* Distance between the velocities on both sides of node j. */
static double gap_of(const sd_vans_mesh *mesh, int j)
{
  const int M = mesh->ncell - 1;
  if (j == 0) return 0.5 * sd_vans_height(mesh, 0);
  if (j == M) return 0.5 * sd_vans_height(mesh, M - 1);
  return 0.5 * (sd_vans_height(mesh, j - 1) + sd_vans_height(mesh, j));
}

/* The value at node j of something known in the slices, linear between their middles. */
static double at_node(const sd_vans_mesh *mesh, const double *value, int j)
{
  const double below = sd_vans_height(mesh, j - 1), above = sd_vans_height(mesh, j);
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
  /* z u_star/nu below which the law of the wall is linear, u_star of the whole depth; below a lid of half of it,
   * from either wall */
  if (fluid->sublayer) {
    const int yade = fluid->rules == SD_VANS_YADE, lid = !yade && fluid->driven && fluid->turbulence == SD_VANS_PIPE;
    const double nu = fluid->eta / fluid->rho, H = mesh->edge[mesh->ncell - 1], z = mesh->edge[j];
    const double drive = yade ? fluid->gx : sd_vans_drive(fluid);
    if ((lid ? fmin(z, H - z) : z) * sqrt(fabs(drive) * (lid ? 0.5 * H : H)) / nu < 11.3) return 0.0;
  }
  return length[j] * length[j] / gap_of(mesh, j);
}

/* Gauss's elimination for the tridiagonal rows, from both ends to the middle, then back: two
 * independent chains of divisions run at once. Upwards row i becomes
 *   x_i = g_i + c_i x_(i+1),  c_i = U_i w,  g_i = (r_i + L_i g_(i-1)) w,  1/w = D_i - L_i c_(i-1)
 * and the mirror of it downwards. No pivot is needed: the implicit step makes the diagonal the
 * largest. U[1..M] out. */
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
  /* where they meet: x_(half-1) = g_low + c_low x_half, x_half = g_top + c_top x_(half-1) */
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

/* Side walls: half of the friction on U', half on U, both with the f and |U| of U. That is
 * stable however strong it is. Yade: U^2 in both halves, in that on U without its sign. */
static void wall_rows(sd_vans_solver *s, sd_vans_rules rules, int M, const double *U)
{
  const int yade = rules == SD_VANS_YADE;
  const double *cd = s->cd, *cr = s->cr, *scale = s->wall.scale;
  double *wall = s->wall.K, *wall_cd = s->wall.cd, *wall_cr = s->wall.cr;
  for (int j = 0; j < M; j++) {
    const double u = U[j + 1], size = fabs(u),
                 speed = size > s->wall.least_speed ? size : s->wall.least_speed,
                 f = sd_vans_wall_friction(rules, speed * s->wall.Re_factor, &s->wall.friction[j]);
    const double K = scale[j] * f * (yade ? speed * speed : speed);
    wall[j] = K;
    wall_cd[j] = cd[j] + K;
    wall_cr[j] = cr[j] - (yade ? K : K * u);
  }
}

static void prepare_walls(sd_vans_solver *s, const sd_vans_fluid *fluid, double dt)
{
  const int M = s->mesh->ncell - 1;
  side_walls *w = &s->wall;
  const double factor = fluid->width > 0.0 ? dt / fluid->width * fluid->wall_coef / 8.0 : 0.0;
  w->on = factor != 0.0;
  w->Re_factor = sd_vans_wall_length(fluid) * fluid->rho / fluid->eta;
  w->least_speed = w->on ? SD_VANS_LEAST_RE / w->Re_factor : 0.0;
  const double roughness = w->on ? fluid->wall_roughness / sd_vans_wall_length(fluid) : 0.0;
  for (int j = 0; j < M; j++) w->friction[j].roughness = roughness;
  for (int j = 0; j < M; j++) w->scale[j] = s->ce[j] * factor;
  w->sum = 0.0;
}

/* The rows as far as they stay in a solve: all but the eddy viscosity and the walls. The viscous
 * part acts on the mixture e U + phi v, so that its jumps J of phi v are known and go to the right;
 * the eddies on U alone. */
static void prepare(sd_vans_solver *s, const sd_vans_fluid *fluid, const sd_vans_column *column,
                    double dt)
{
  const sd_vans_mesh *mesh = s->mesh;
  const double *phi = column->phi, *vx = column->vx, *b = column->b;
  const int N = mesh->ncell, M = N - 1;
  s->drive = fluid->held ? 0.0 : sd_vans_drive(fluid);
  s->over.drive = 0.0;
  for (int j = 0; j < N; j++) {
    s->mix[j] = mixing_at_node(mesh, fluid, column->length, j);
    s->gap[j] = porosity_at_node(mesh, phi, j) / gap_of(mesh, j);
  }
  double A = viscosity_at_node(mesh, fluid, phi, 0) / gap_of(mesh, 0);
  for (int j = 0; j < M; j++) {
    const double above = viscosity_at_node(mesh, fluid, phi, j + 1) / gap_of(mesh, j + 1),
                 dz = sd_vans_height(mesh, j);
    const double e = 1.0 - phi[j], e_above = 1.0 - phi[j + 1],
                 e_below = j > 0 ? 1.0 - phi[j - 1] : e;
    const double J = j > 0 ? phi[j] * vx[j] - phi[j - 1] * vx[j - 1] : 0.0,
                 J_above = phi[j + 1] * vx[j + 1] - phi[j] * vx[j];
    s->cl[j] = e * A * e_below;
    s->cu[j] = e * above * e_above;
    s->ce[j] = e * dz / dt;
    s->content[j] = e * dz;
    s->cd[j] = s->ce[j] + e * e * (A + above) + dz * b[j];
    s->cr[j] = e * (above * J_above - A * J) +
        dz * (b[j] * vx[j] + e * s->drive + (column->source ? column->source[j] : 0.0));
    A = above;
  }
  s->cl[0] = 0.0; /* U = 0 on the bottom */
  /* The surface is eliminated from the last row: its eddy viscosity T_M stays in the row only if the
   * surface is driven. */
  s->cu_top = s->cu[M - 1];
  s->cr_top = s->cr[M - 1];
  s->cu[M - 1] = 0.0;
  if (!fluid->driven) s->cd[M - 1] -= s->cu_top;
  prepare_walls(s, fluid, dt);
  memset(s->over.U, 0, M * sizeof(double));
  s->over.bottom = s->over.surface = 0.0;
}

/* The drive for which the discharge is what it should be, added to U'. */
static void hold_discharge(sd_vans_solver *s, const double *cd, double discharge, double *U)
{
  const int M = s->mesh->ncell - 1;
  double *R = s->response, passes = 0.0, more = 0.0;
  memset(R, 0, (M + 1) * sizeof(double));
  solve_rows(s, M, cd, s->content, R);
  for (int j = 0; j < M; j++) {
    passes += s->content[j] * U[j + 1];
    more += s->content[j] * R[j + 1];
  }
  s->drive = (discharge - passes) / more;
  for (int j = 0; j < M; j++) U[j + 1] += s->drive * R[j + 1];
}

/* One step: U becomes U'. With keep the sums for the books go on. */
static void step(sd_vans_solver *s, const sd_vans_fluid *fluid, double *U, int keep)
{
  const int N = s->mesh->ncell, M = N - 1;
  for (int j = 0; j < N; j++) {
    s->nut[j] = s->mix[j] * fabs(U[j + 1] - U[j]);
    s->T[j] = s->gap[j] * s->nut[j];
  }
  const double T_top = s->T[M], T_low = s->T[0];
  if (fluid->driven)
    s->cr[M - 1] = s->cr_top + (s->cu_top + T_top) * fluid->u_top;
  else
    s->T[M] = 0.0;
  if (s->wall.on) wall_rows(s, fluid->rules, M, U);
  for (int j = 0; s->wall.on && keep && j < M; j++)
    s->wall.sum += s->wall.K[j] * (fluid->rules == SD_VANS_YADE ? 1.0 : U[j + 1]);

  const double *cd = s->wall.on ? s->wall.cd : s->cd;
  solve_rows(s, M, cd, s->wall.on ? s->wall.cr : s->cr, U);
  if (fluid->held) hold_discharge(s, cd, fluid->discharge, U);
  s->over.drive += s->drive;
  U[N] = fluid->driven ? fluid->u_top : U[M];

  if (!keep) return;
  for (int j = 0; j < M; j++) s->over.U[j] += U[j + 1];
  s->over.bottom += T_low * U[1];
  if (fluid->driven) s->over.surface += T_top * (fluid->u_top - U[M]);
  if (s->wall.on)
    for (int j = 0; j < M; j++) s->wall.sum += s->wall.K[j] * U[j + 1];
}

/* Viscous flux through node j, summed over the steps: A_j (e_j x_j - e_(j-1) x_(j-1) + J_j), x the
 * sum of U'. */
static double viscous_flux(const sd_vans_solver *s, const sd_vans_fluid *fluid,
                           const sd_vans_column *column, double steps, int j)
{
  const double *phi = column->phi, *vx = column->vx, *U = s->over.U;
  const int M = s->mesh->ncell - 1;
  /* no mixture moves on the bottom; the surface has the velocity of the highest slice or u_top */
  const double below = j == 0 ? 0.0 : (1.0 - phi[j - 1]) * U[j - 1];
  const double x = j < M ? U[j] : fluid->driven ? fluid->u_top * steps : U[M - 1];
  const double J = j == 0 ? 0.0 : phi[j] * vx[j] - phi[j - 1] * vx[j - 1];
  return viscosity_at_node(s->mesh, fluid, phi, j) / gap_of(s->mesh, j) *
      ((1.0 - phi[j]) * x - below + J * steps);
}

/* The fluxes that the rows had, from the sum of U' over the steps: every row is linear in U' but
 * for eddies and walls, which were summed step by step. A slice passes to its neighbours what it
 * does not keep, so that inner fluxes cancel and what is left came from outside or went to
 * grains: of the viscous force on the mixture, e of it acts on the water and phi on the grains. */
static void close_books(const sd_vans_solver *s, const sd_vans_fluid *fluid,
                        const sd_vans_column *column, double steps, double dt,
                        sd_vans_books *books)
{
  const double *phi = column->phi, rho_dt = fluid->rho * dt;
  const int M = s->mesh->ncell - 1;
  double flux = viscous_flux(s, fluid, column, steps, 0);
  books->driving = 0.0;
  books->drive = s->drive;
  books->bottom = -rho_dt * (flux + s->over.bottom);
  books->walls = -rho_dt * s->wall.sum;
  for (int j = 0; j < M; j++) {
    const double above = viscous_flux(s, fluid, column, steps, j + 1),
                 dz = sd_vans_height(s->mesh, j);
    books->shear[j] = rho_dt * phi[j] * (above - flux);
    books->moved[j] =
        rho_dt * dz * column->b[j] * (s->over.U[j] - column->vx[j] * steps) + books->shear[j];
    books->driving += rho_dt * dz * (1.0 - phi[j]) * s->over.drive;
    flux = above;
  }
  books->moved[M] = books->shear[M] = 0.0;
  books->surface = rho_dt * (flux + s->over.surface);
}

sd_status sd_vans_solve(sd_vans_solver *s, const sd_vans_fluid *fluid,
                        const sd_vans_column *column, int64_t nsteps, double dt,
                        const sd_vans_flow *flow, sd_vans_books *books)
{
  double *U = flow->U, check = 0.0;
  prepare(s, fluid, column, dt);
  for (int64_t k = 0; k < nsteps; k++) step(s, fluid, U, books != 0);
  for (int j = 0; j < s->mesh->ncell; j++) {
    flow->nut[j] = s->nut[j];
    flow->stress[j] = fluid->rho * s->gap[j] * s->nut[j] * (U[j + 1] - U[j]);
    check += U[j + 1];
  }
  if (books) close_books(s, fluid, column, (double) nsteps, dt, books);
  return isfinite(check) ? SD_OK : SD_ENOTFINITE;
}

void sd_vans_stress(const sd_vans_mesh *mesh, const sd_vans_fluid *fluid, const double *phi,
                    const double *length, const sd_vans_flow *flow)
{
  for (int j = 0; j < mesh->ncell; j++) {
    const double jump = flow->U[j + 1] - flow->U[j];
    flow->nut[j] = mixing_at_node(mesh, fluid, length, j) * fabs(jump);
    flow->stress[j] =
        fluid->rho * porosity_at_node(mesh, phi, j) * flow->nut[j] * jump / gap_of(mesh, j);
  }
}
