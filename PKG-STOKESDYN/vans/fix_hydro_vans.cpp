#include "fix_hydro_vans.h"

#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "group.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = VansSettings::COMMAND;
static constexpr size_t MAX_CLASSES = 32;

FixHydroVans::FixHydroVans(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  const auto args = words(narg, arg);
  double every;
  if (narg < 4 || !is_number(args[3], every) || every != std::floor(every) || every < 1 ||
      every > 1e9)
    fail(lmp,
         COMMAND + ": the number of steps N after the style must be an integer >= 1" +
             (narg < 4 ? "" : ", not '" + args[3] + "'"));
  nevery = (int) every;
  set.parse(lmp, args, 4);
  if (has_grains() && !atom->radius_flag)
    fail(lmp, COMMAND + ": an atom style with radius is needed (sphere), unless couple fluid");

  if (set.conserve) drag_column = columns, columns += MOMENTUM_COLUMNS;
  if (set.overlap_once) weight_column = columns, columns += 1;
  if (set.fluctuation != VansSettings::NO_FLUCTUATION) eddy_column = columns, columns += 2;

  stream.reset(new VansStream(lmp, set));

  peratom_flag = 1;
  size_peratom_cols = OUTPUTS;
  peratom_freq = 1;
  vector_flag = 1;
  size_vector = VECTOR_SIZE;
  array_flag = 1;
  size_array_rows = set.ncell();
  size_array_cols = ARRAY_COLUMNS;
  global_freq = 1;
  extvector = 0;
  extarray = 0;
  restart_global = 1;
  restart_peratom = 1;
  create_attribute = 1;
  dynamic_group_allow = 1;

  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
  find_classes();
}

FixHydroVans::~FixHydroVans()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(array_atom);
  memory->destroy(memo);
}

int FixHydroVans::setmask()
{
  return FixConst::POST_FORCE | FixConst::END_OF_STEP;
}

double FixHydroVans::area() const
{
  return set.area > 0.0 ? set.area : domain->xprd * domain->yprd;
}

/* One class for each radius, in the order of the lowest atom ID that has it. */
void FixHydroVans::find_classes()
{
  if (!has_grains() || !set.class_radii.empty() || !(set.classes || set.wants_pores())) {
    if (set.classes) size_array_cols = ARRAY_COLUMNS + 5 * (int) stream->class_radii.size();
    return;
  }
  const int found = group->find(set.average.c_str()), bit = found < 0 ? 1 : group->bitmask[found];
  std::map<double, double> first;    // radius: lowest ID
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & bit) || !(atom->radius[i] > 0.0)) continue;
    const auto at = first.find(atom->radius[i]);
    if (at == first.end())
      first[atom->radius[i]] = (double) atom->tag[i];
    else
      at->second = std::min(at->second, (double) atom->tag[i]);
    if (first.size() > MAX_CLASSES) break;
  }
  std::vector<double> mine(2 * (MAX_CLASSES + 1), 0.0), all(mine.size() * comm->nprocs);
  size_t k = 0;
  for (const auto &entry : first) {
    mine[k++] = entry.first;
    mine[k++] = entry.second;
  }
  MPI_Allgather(mine.data(), (int) mine.size(), MPI_DOUBLE, all.data(), (int) mine.size(),
                MPI_DOUBLE, world);
  first.clear();
  for (k = 0; k < all.size(); k += 2)
    if (all[k] > 0.0) {
      const auto at = first.find(all[k]);
      if (at == first.end())
        first[all[k]] = all[k + 1];
      else
        at->second = std::min(at->second, all[k + 1]);
    }
  if (first.size() > MAX_CLASSES) {
    if (set.classes)
      fail(lmp,
           COMMAND + ": keyword classes: the grains have more than " + std::to_string(MAX_CLASSES) +
               " different radii; a class is one radius exactly");
    first.clear();    // pores: one class of the mean radius
  }
  std::vector<std::pair<double, double>> order;
  for (const auto &entry : first) order.emplace_back(entry.second, entry.first);
  std::sort(order.begin(), order.end());
  std::vector<double> radii;
  for (const auto &entry : order) radii.push_back(entry.second);
  if (!radii.empty()) stream->set_classes(radii);
  if (set.classes) size_array_cols = ARRAY_COLUMNS + 5 * (int) stream->class_radii.size();
}

void FixHydroVans::init()
{
  if (update->whichflag == 2)
    fail(lmp, COMMAND + ": the force depends on velocities: it is no force for a minimisation");
  if (utils::strmatch(update->integrate_style, "^respa"))
    fail(lmp, COMMAND + ": run_style respa is not supported");
  if (has_grains() && !atom->radius_flag)
    fail(lmp, COMMAND + ": an atom style with radius is needed (sphere), unless couple fluid");
  region = nullptr;
  if (!set.region.empty()) {
    region = Compat::region(domain, set.region);
    if (!region)
      fail(lmp, COMMAND + ": keyword region: region '" + set.region + "' does not exist");
  }
  const int average_group = group->find(set.average.c_str());
  if (average_group < 0)
    fail(lmp, COMMAND + ": keyword average: group '" + set.average + "' does not exist");
  average_bit = group->bitmask[average_group];
  set.dpdx.init(lmp, COMMAND + ": keyword pressure_gradient");
  set.u_top.init(lmp, COMMAND + ": keyword surface");
  if (set.dpdx.is_atom_style())
    fail(lmp, COMMAND + ": keyword pressure_gradient: an equal-style variable is needed");
  if (set.u_top.is_atom_style())
    fail(lmp, COMMAND + ": keyword surface: an equal-style variable is needed");
  if (set.overlap_once && !atom->molecule)
    fail(lmp, COMMAND + ": keyword overlap: molecule IDs are needed to know the clumps");
  find_classes();

  if (set.couple == VansSettings::FLUID && set.radius == 0.0 &&
      std::any_of(stream->drag(), stream->drag() + stream->ncell(),
                  [](double f) {
                    return f != 0.0;
                  }) &&
      !set.classes)
    fail(lmp,
         COMMAND + ": keyword radius: couple fluid with a drag needs the radius of the grains");
  if ((set.couple == VansSettings::TWO || set.couple == VansSettings::FLUID) && comm->me == 0) {
    const double T = set.period > 0.0 ? set.period : nevery * update->dt,
                 wanted = set.period > 0.0 ? set.dt : 0.1 * T;
    double dt = wanted;
    const auto steps = sd_vans_steps(set.rules, T, &dt);
    if (std::fabs(dt - wanted) > 1e-9 * wanted)
      utils::logmesg(lmp,
                     COMMAND + ": the step " + text(wanted) +
                         " of keyword solve is no fraction of " + text(T) + ": " +
                         std::to_string(steps) + " steps of " + text(dt) + " are used\n");
    else if (std::fabs(steps * dt - T) > 1e-9 * T)
      utils::logmesg(lmp,
                     COMMAND + ": rules yade: " + std::to_string(steps) + " steps of " + text(dt) +
                         " are used for the period " + text(T) + "\n");
    if (set.couple == VansSettings::TWO && std::fabs(T / (nevery * update->dt) - 1.0) > 1e-9)
      utils::logmesg(lmp,
                     COMMAND + ": the water moves on by " + text(T) +
                         " while the grains move on by " + text(nevery * update->dt) + "\n");
  }
}

/* ---- which atoms --------------------------------------------------------------------------------------------------------- */

void FixHydroVans::select(int bit, bool not_in_group)
{
  const int n = atom->nlocal;
  take.resize(n);
  if (region) region->prematch();
  for (int i = 0; i < n; i++) {
    take[i] = (atom->mask[i] & bit) && atom->radius[i] > 0.0 &&
        !(not_in_group && (atom->mask[i] & groupbit));
    if (take[i] && region)
      take[i] = region->match(atom->x[i][0], atom->x[i][1], atom->x[i][2]) != 0;
  }
}

const double *FixHydroVans::fluctuations()
{
  if (eddy_column < 0) return nullptr;
  u.resize(3 * (size_t) atom->nlocal + 3);
  for (int i = 0; i < atom->nlocal; i++)
    memcpy(&u[3 * (size_t) i], array_atom[i] + 3, 3 * sizeof(double));
  return u.data();
}

const double *FixHydroVans::weights()
{
  if (weight_column < 0) return nullptr;
  weight.resize(atom->nlocal + 1);
  for (int i = 0; i < atom->nlocal; i++) weight[i] = memo[i][weight_column];
  return weight.data();
}

/* The share of each member of a clump in the volume of the union. Once for every number of atoms: clumps are rigid. */
void FixHydroVans::count_overlaps()
{
  if (weights_of == atom->natoms) return;
  weights_of = atom->natoms;
  struct Member {
    double molecule, tag, x[3], a;
  };
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    memo[i][weight_column] = 1.0;
    if (atom->molecule[i] > 0 && (atom->mask[i] & average_bit) && atom->radius[i] > 0.0)
      mine.push_back({(double) atom->molecule[i],
                      (double) atom->tag[i],
                      {atom->x[i][0], atom->x[i][1], atom->x[i][2]},
                      atom->radius[i]});
  }
  const int doubles = sizeof(Member) / sizeof(double);
  int count = (int) mine.size() * doubles;
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < comm->nprocs; p++) starts[p] = starts[p - 1] + counts[p - 1];
  std::vector<Member> all((starts.back() + counts.back()) / doubles);
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, world);
  std::sort(all.begin(), all.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  std::map<double, double> share;    // by atom ID
  std::vector<double> x, a;
  for (size_t begin = 0, end; begin < all.size(); begin = end) {
    for (end = begin; end < all.size() && all[end].molecule == all[begin].molecule; end++) {}
    const size_t n = end - begin;
    x.resize(3 * n);
    a.resize(n);
    for (size_t k = 0; k < n; k++) {
      double r[3];
      for (int d = 0; d < 3; d++) r[d] = all[begin + k].x[d] - all[begin].x[d];
      Compat::minimum_image(domain, r);
      memcpy(&x[3 * k], r, sizeof(r));
      a[k] = all[begin + k].a;
    }
    for (size_t k = 0; k < n; k++)
      share[all[begin + k].tag] = sd_vans_union_share((int) n, x.data(), a.data(), (int) k);
  }
  for (int i = 0; i < atom->nlocal; i++) {
    const auto at = share.find((double) atom->tag[i]);
    if (at != share.end()) memo[i][weight_column] = at->second;
  }
}

/* ---- time ---------------------------------------------------------------------------------------------------------------- */
