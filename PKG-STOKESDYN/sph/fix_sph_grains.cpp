#include "fix_sph_grains.h"

#include "fixes.h"
#include "keywords.h"
#include "lammps_compat.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Of grains in a volume: spheres at random have 0.64, and close packing is 0.74. Beside a wall,
 * and in a shock, the mean over a kernel is a little more than the packing. */
static constexpr double MOST = 0.65, CLOSE = 0.74;

FixSphGrains::FixSphGrains(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg), rows(1), shown(4)
{
  if (!atom->radius_flag || !atom->rmass_flag)
    voice.fail("atoms have no radius and no mass of their own: use atom_style hybrid sph sphere");
  if (domain->dimension != 3)
    voice.fail("needs dimension 3, since grains are spheres; a thin periodic slice stands for two "
               "dimensions");
  law.drag.law = SD_DRAG_BROWN_LAWLER;
  law.drag.hindrance = SD_HINDRANCE_RICHARDSON_ZAKI;
  Keywords in = keywords(narg, arg);
  in.parse({
      {"viscosity",
       [&] {
         viscosity = in.positive();
       }},
      {"drag",
       [&] {
         law.drag.law = in.option<sd_drag_of_one>({"yade", "schiller_naumann", "brown_lawler",
                                                   "ferguson_church", "ergun", "gidaspow",
                                                   "beetstra", "koch_hill"});
       }},
      {"hindrance",
       [&] {
         parse_hindrance(in);
       }},
      {"fall_diameter",
       [&] {
         law.drag.fall = in.positive();
       }},
      {"displace",
       [&] {
         fills = in.yes_no();
       }},
      {"own_flow",
       [&] {
         own_flow = in.yes_no();
       }},
  });
  if (sd_drag_of_bed(law.drag.law)) {
    in.require(!in.given("hindrance"),
               "keyword hindrance: ergun, gidaspow, beetstra and koch_hill have the neighbours of "
               "a grain in them: "
               "leave hindrance out");
    law.drag.hindrance = SD_HINDRANCE_OWN;
  }
  keep({&rows, &shown}, &shown, true);
  restart_global = 1;
  dynamic_group_allow = 1;
  vector_flag = 1;
  size_vector = 4;
  global_freq = 1;
  extvector = 0;
  comm_forward = comm_reverse = 3;
}

FixSphGrains::~FixSphGrains()
{
  sd_cells_free(&cells);
}

void FixSphGrains::parse_hindrance(Keywords &in)
{
  if (in.take("richardson_zaki"))
    law.drag.hindrance = SD_HINDRANCE_RICHARDSON_ZAKI;
  else if (in.take("di_felice"))
    law.drag.hindrance = SD_HINDRANCE_DI_FELICE;
  else {
    law.drag.hindrance = SD_HINDRANCE_POWER;
    law.exponent = in.not_negative();
  }
}

int FixSphGrains::setmask()
{
  return FixConst::POST_FORCE;
}

// --- at the beginning of a run -------------------------------------------------------------------

void FixSphGrains::init()
{
  SphFix::init();
  if (pair->dimension() != 3)
    voice.fail("the kernel of pair_style sph/artVisc/tensCorr is that of two dimensions; write its "
               "name without 2d");
  if (!pair->is_newtonian())
    voice.fail("the drag laws are those of grains in a Newtonian fluid, and keyword rheology of "
               "pair_style sph/artVisc/tensCorr gives the water another law: leave one of them out");
  check_order();
  find_held();
  check_scene();
  law.kernel = pair->kernel();
  law.wake = nullptr;
  if (!own_flow) return;
  sd_sph_wake_make(law.kernel, pair->has_laplacian(), &wake);
  law.wake = &wake;
}

/* Drag is implicit: what else moves a grain must be known before. */
void FixSphGrains::check_order() const
{
  bool behind = false;
  for (int k = 0; k < modify->nfix; k++) {
    const Fix *fix = modify->fix[k];
    if (behind && strcmp(fix->style, "gravity") == 0)
      voice.fail(std::string("fix ") + fix->id +
                 " of style gravity stands behind it in the input, and drag is implicit, "
                 "so that it must know all other forces: define gravity before it");
    behind = behind || fix == this;
  }
}

/* Forces move those of integrators alone, but for rigid bodies, whose grains do not know the mass
 * that they are moved with: these count as held within a step. */
void FixSphGrains::find_held()
{
  free_bits = Sph::groups(Sph::integrators(lmp));
  held_bits = 0;
  for (const char *style : {"freeze", "setforce", "move"})
    held_bits |= Sph::groups(fixes_of(lmp, style));
}

/* One h and one viscosity of all water, and grains that are small beside h. */
void FixSphGrains::check_scene()
{
  const tagint both = first_atom(lmp, [this](int i) {
    return (atom->mask[i] & groupbit) && pair->is_particle(i);
  });
  if (both)
    voice.fail("atom " + std::to_string(both) +
               " of its group has a type of pair_style sph/artVisc/tensCorr, which "
               "computes it as water: give grains a type of their own, without pair_coeff ... "
               "sph/artVisc/tensCorr");
  double least = HUGE_VAL, most = 0.0, mu = 0.0, diameter = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (pair->is_particle(i)) {
      const double h = pair->smoothing_length(atom->type[i]);
      least = std::min(least, h);
      most = std::max(most, h);
      if (!pair->is_of_wall(i)) mu = std::max(mu, pair->viscosity(i));
    } else if (atom->mask[i] & groupbit)
      diameter = std::max(diameter, 2.0 * atom->radius[i]);
  }
  least = smallest_of_all(world, least);
  most = largest_of_all(world, most);
  diameter = largest_of_all(world, diameter);
  law.eta = viscosity > 0.0 ? viscosity : largest_of_all(world, mu);
  if (most == 0.0) voice.fail("there is no particle of pair_style sph/artVisc/tensCorr");
  if (!(law.eta > 0.0))
    voice.fail("keyword viscosity is required: drag needs the dynamic viscosity of the water, and "
               "pair_style "
               "sph/artVisc/tensCorr has none (its keyword viscosity)");
  if (most > least * (1.0 + 1e-9))
    voice.fail("types of pair_style sph/artVisc/tensCorr have smoothing lengths from " +
               text(least) + " to " + text(most) + ": it needs one h for all of them");
  if (least < 2.0 * diameter * (1.0 - 1e-9))
    voice.fail("the smoothing length h = " + text(least) +
               " is below 2 diameters of the largest grain, " + text(diameter) +
               ": water is averaged over many grains; use a larger h and spacing of the water, or "
               "smaller grains (larger bodies: particles of a wall and fix rigid)");
  law.h = least;
}

// --- the volume fraction -------------------------------------------------------------------------

/* phi as the last step has left it. */
void FixSphGrains::recall()
{
  const int n = atom->nlocal + atom->nghost;
  phi.assign(n + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) phi[i] = rows[i][0];
  forward(phi.data(), 1);
}

/* Those of the pair style around each grain: a list that lasts as long as LAMMPS's. */
void FixSphGrains::list_particles()
{
  points.clear();
  grains.clear();
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    if (pair->is_particle(i))
      points.push_back(i);
    else if (i < atom->nlocal && (atom->mask[i] & groupbit))
      grains.push_back(i);
  look_at_places();
  sd_cells_free(&cells);
  cells = {};
  const double reach = 2.0 * law.h + neighbor->skin;
  if (sd_cells_fill(&cells, places.data(), (int) points.size(), 0.5 * reach) != SD_OK)
    throw std::bad_alloc();
  first.resize(grains.size() + 1);
  const auto look = [&](int *into) {
    sd_sph_look_around(&cells, places.data(), (int) grains.size(), grain_places.data(), reach,
                       first.data(), into);
  };
  look(nullptr);
  particle.resize(first.back() + 1);
  look(particle.data());
  walls.resize(points.size());
  for (size_t p = 0; p < points.size(); p++) walls[p] = pair->is_of_wall(points[p]);
  list_of = neighbor->lastcall;
}

void FixSphGrains::look_at_places()
{
  places.resize(3 * points.size() + 1);
  grain_places.resize(3 * grains.size() + 1);
  for (size_t p = 0; p < points.size(); p++) std::copy_n(atom->x[points[p]], 3, &places[3 * p]);
  for (size_t j = 0; j < grains.size(); j++)
    std::copy_n(atom->x[grains[j]], 3, &grain_places[3 * j]);
}

void FixSphGrains::find_fractions()
{
  recall();
  if (neighbor->ago == 0 || update->setupflag || list_of != neighbor->lastcall)
    list_particles();
  else
    look_at_places();
  const size_t n = grains.size(), m = points.size();
  a.resize(n + 1);
  V.resize(n + 1);
  M.resize(n + 1);
  for (size_t j = 0; j < n; j++) {
    a[j] = atom->radius[grains[j]];
    V[j] = sd_sph_sphere(a[j]);
    M[j] = atom->mask[grains[j]] & free_bits & ~held_bits ? atom->rmass[grains[j]] : HUGE_VAL;
  }
  volume.resize(m + 1);
  for (size_t p = 0; p < m; p++) {
    const int i = points[p];
    volume[p] = atom->rmass[i] / (atom->rho[i] * (1.0 - phi[i]));
  }
  const sd_sph_around list = around();
  weight.resize(particle.size() + 1);
  wet.resize(n + 1);
  own.resize(n + 1);
  std::vector<double> found(m + 1, 0.0);
  sd_sph_grain_weights(law.kernel, law.h, &list, grain_places.data(), places.data(), volume.data(),
                       walls.data(), weight.data(), wet.data());
  sd_sph_grain_fractions(&list, V.data(), volume.data(), weight.data(), wet.data(), found.data());
  sd_sph_grain_shares(&list, V.data(), volume.data(), weight.data(), wet.data(), own.data());

  std::vector<double> all = at_atoms(found, 1);
  reverse(all.data(), 1);
  for (int i = 0; i < atom->nlocal; i++)
    if (all[i] != 0.0 || rows.has(i)) *rows.give(i) = all[i];
  recall();
  mean_phi = mean_of(phi, 1);
  check_fractions();
  if (update->setupflag) displace();
}

void FixSphGrains::check_fractions()
{
  largest = 0.0;
  const auto beside_wall = [this](size_t j) {
    return std::any_of(&particle[first[j]], &particle[first[j + 1]], [this](int p) {
      return walls[p];
    });
  };
  for (size_t j = 0; j < grains.size(); j++) {
    largest = std::max(largest, mean_phi[j]);
    const double most = update->setupflag && !beside_wall(j) ? MOST : CLOSE;
    if (mean_phi[j] > most)
      voice.at_step().fail_one("the volume fraction of grains around atom " +
                               std::to_string(atom->tag[grains[j]]) + " is " + text(mean_phi[j]) +
                               "; above " + text(most) +
                               " no drag law holds, and spheres "
                               "would overlap: use stiffer contacts, or fewer or smaller grains");
  }
  for (size_t p = 0; p < points.size(); p++)
    if (phi[points[p]] > 0.9)
      voice.at_step().fail_one(
          "grains fill " + text(phi[points[p]]) + " of the water at atom " +
          std::to_string(atom->tag[points[p]]) +
          ": they overlap, or the spacing of the water is too wide "
          "for its h: use stiffer contacts, fewer or smaller grains, or a larger h");
}

/* The volume of the particles stays, and so all that has been found with it. */
void FixSphGrains::displace()
{
  for (const int i : points)
    if (fills && filled == 0.0) atom->rmass[i] *= 1.0 - phi[i];
  filled = 1.0;
}

const double *FixSphGrains::mixture(const double *v)
{
  std::vector<double> of_grains(3 * grains.size() + 1), there(3 * points.size() + 1, 0.0);
  for (size_t j = 0; j < grains.size(); j++) std::copy_n(atom->v[grains[j]], 3, &of_grains[3 * j]);
  const sd_sph_around list = around();
  sd_sph_grain_flux(&list, V.data(), volume.data(), weight.data(), wet.data(), of_grains.data(),
                    there.data());
  moved = at_atoms(there, 3);
  reverse(moved.data(), 3);
  forward(moved.data(), 3);
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    for (size_t k = 3 * (size_t) i; k < 3 * (size_t) i + 3; k++) moved[k] += (1.0 - phi[i]) * v[k];
  return moved.data();
}

void FixSphGrains::divide_rates(const double *order, int columns, bool shifts, double *rate)
{
  sd_sph_grain_rates(atom->nlocal, phi.data(), order, columns, shifts, rate);
}

// --- a step --------------------------------------------------------------------------------------

void FixSphGrains::post_force(int /*vflag*/)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (pair->is_particle(i)) shown.give(i)[0] = phi[i];
  std::vector<double> F(3 * grains.size() + 1, 0.0), D = F;
  stresses(F);
  drags(F, D);
  std::fill_n(total, 3, 0.0);
  for (size_t j = 0; j < grains.size(); j++)
    for (int d = 0; d < 3; d++) {
      const double both = F[3 * j + d] + D[3 * j + d];
      shown.give(grains[j])[1 + d] = both;
      atom->f[grains[j]][d] += both;
      total[d] += both;
    }
}

/* Of the force of SPH, by volume: water keeps 1 - phi of it. */
void FixSphGrains::stresses(std::vector<double> &F)
{
  const double *sph = pair->own_forces();
  std::vector<double> forces(3 * (size_t) (atom->nlocal + atom->nghost) + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_particle(i)) continue;
    for (int d = 0; d < 3; d++) {
      forces[3 * (size_t) i + d] = sph[4 * (size_t) i + d];
      const double given = phi[i] * sph[4 * (size_t) i + d];
      shown.give(i)[1 + d] = -given;
      atom->f[i][d] -= given;
    }
  }
  forward(forces.data(), 3);
  std::vector<double> per_volume = at_points(forces, 3), mean(3 * grains.size() + 1);
  for (size_t k = 0; k < 3 * points.size(); k++) per_volume[k] /= volume[k / 3];
  const sd_sph_around list = around();
  sd_sph_grain_vector_means(&list, weight.data(), per_volume.data(), mean.data());
  sd_sph_grain_stresses((int) grains.size(), mean.data(), wet.data(), V.data(), F.data());
}

/* The law at the slip of now, and its drag D at the velocities of the end of the step, which all
 * forces but drag make: those of atoms, and the stresses F of grains. */
void FixSphGrains::drags(const std::vector<double> &F, std::vector<double> &D)
{
  const int nlocal = atom->nlocal, n = (int) grains.size();
  const double dt = update->dt;    // at a setup as well: that force begins the first step
  const size_t all = nlocal + atom->nghost;
  std::vector<double> now(3 * all + 1, 0.0), next(now), total_drag(points.size() + 1, 0.0),
      v(3 * grains.size() + 1), v_next(v), k(grains.size() + 1), at_grains(grains.size() + 1);
  for (int i = 0; i < nlocal; i++)
    if (pair->is_particle(i))
      for (int d = 0; d < 3; d++)
        next[3 * (size_t) i + d] = atom->v[i][d] + dt * atom->f[i][d] / atom->rmass[i];
  forward(next.data(), 3);
  for (size_t i = 0; i < all; i++) std::copy_n(atom->v[i], 3, &now[3 * i]);
  for (int j = 0; j < n; j++)
    for (int d = 0; d < 3; d++) {
      v[3 * j + d] = atom->v[grains[j]][d];
      v_next[3 * j + d] = v[3 * j + d] + dt * (atom->f[grains[j]][d] + F[3 * j + d]) / M[j];
    }

  const std::vector<double> u = mean_of(now, 3), u_next = mean_of(next, 3),
                            rho = mean_of(std::vector<double>(atom->rho, atom->rho + all), 1);
  sd_sph_grain_phi(n, mean_phi.data(), own.data(), at_grains.data());
  sd_sph_grain_drag(&law, n, a.data(), u.data(), v.data(), rho.data(), at_grains.data(), wet.data(),
                    k.data());
  for (int j = 0; j < n; j++) shown.give(grains[j])[0] = at_grains[j];

  const sd_sph_around list = around();
  sd_sph_grain_load(&list, weight.data(), k.data(), total_drag.data());
  std::vector<double> slowed = at_atoms(total_drag, 1);
  reverse(slowed.data(), 1);
  for (int i = 0; i < nlocal; i++)
    if (slowed[i] != 0.0) slowed[i] /= atom->rmass[i];
  forward(slowed.data(), 1);
  const std::vector<double> slowed_points = at_points(slowed, 1);
  sd_sph_grain_drags(&list, dt, weight.data(), u_next.data(), v_next.data(), M.data(), k.data(),
                     slowed_points.data(), D.data());
  give_back(D);
}

/* Drag on grains slows the water of all ranks. */
void FixSphGrains::give_back(const std::vector<double> &D)
{
  const sd_sph_around list = around();
  std::vector<double> mine(3 * points.size() + 1, 0.0);
  sd_sph_grain_reactions(&list, weight.data(), D.data(), mine.data());
  std::vector<double> all = at_atoms(mine, 3);
  reverse(all.data(), 3);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_particle(i)) continue;
    for (int d = 0; d < 3; d++) {
      shown.give(i)[1 + d] += all[3 * (size_t) i + d];
      atom->f[i][d] += all[3 * (size_t) i + d];
    }
  }
}

// --- rows of atoms, of points and of grains ------------------------------------------------------

std::vector<double> FixSphGrains::at_points(const std::vector<double> &of_atoms, int columns) const
{
  std::vector<double> out(columns * points.size() + 1, 0.0);
  for (size_t p = 0; p < points.size(); p++)
    std::copy_n(&of_atoms[columns * (size_t) points[p]], columns, &out[columns * p]);
  return out;
}

std::vector<double> FixSphGrains::at_atoms(const std::vector<double> &of_points, int columns) const
{
  std::vector<double> out(columns * (size_t) (atom->nlocal + atom->nghost) + 1, 0.0);
  for (size_t p = 0; p < points.size(); p++)
    std::copy_n(&of_points[columns * p], columns, &out[columns * (size_t) points[p]]);
  return out;
}

std::vector<double> FixSphGrains::mean_of(const std::vector<double> &of_atoms, int columns) const
{
  const sd_sph_around list = around();
  const std::vector<double> there = at_points(of_atoms, columns);
  std::vector<double> mean(columns * grains.size() + 1);
  (columns == 3 ? sd_sph_grain_vector_means : sd_sph_grain_means)(&list, weight.data(), there.data(), mean.data());
  return mean;
}

double FixSphGrains::compute_vector(int k)
{
  return k < 3 ? sum_of_all(world, total[k]) : largest_of_all(world, largest);
}

// --- communication -------------------------------------------------------------------------------

void FixSphGrains::forward(double *array, int columns)
{
  comm_array = array;
  comm_columns = columns;
  Compat::forward_comm(comm, this);
}

void FixSphGrains::reverse(double *array, int columns)
{
  comm_array = array;
  comm_columns = columns;
  Compat::reverse_comm(comm, this);
}

int FixSphGrains::pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/)
{
  for (int k = 0; k < n; k++)
    buf = std::copy_n(comm_array + (size_t) list[k] * comm_columns, comm_columns, buf);
  return n * comm_columns;
}

void FixSphGrains::unpack_forward_comm(int n, int first_atom, double *buf)
{
  std::copy_n(buf, (size_t) n * comm_columns, comm_array + (size_t) first_atom * comm_columns);
}

int FixSphGrains::pack_reverse_comm(int n, int first_atom, double *buf)
{
  std::copy_n(comm_array + (size_t) first_atom * comm_columns, (size_t) n * comm_columns, buf);
  return n * comm_columns;
}

void FixSphGrains::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int k = 0; k < n; k++)
    for (int c = 0; c < comm_columns; c++)
      comm_array[(size_t) list[k] * comm_columns + c] += *buf++;
}
