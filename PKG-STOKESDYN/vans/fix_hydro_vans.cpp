#include "fix_hydro_vans.h"

#include "lammps_compat.h"
#include "ranks.h"
#include "sd_hash.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = VansSettings::COMMAND;
static constexpr size_t MAX_CLASSES = 32;

FixHydroVans::FixHydroVans(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), resume(lmp, false)
{
  const auto args = words(narg, arg);
  const bool digits =
      narg > 3 && args[3].find_first_not_of("0123456789") == std::string::npos;
  const double every = digits ? atof(arg[3]) : 0.0;
  if (every < 1 || every > 1e9)
    fail(lmp,
         COMMAND + ": the number of steps N after the style must be an integer >= 1" +
             (narg < 4 ? "" : ", not '" + args[3] + "'"));
  nevery = (int) every;
  set.parse(lmp, args, 4);
  if (has_grains() && !atom->radius_flag)
    fail(lmp, COMMAND + ": an atom style with radius is needed (sphere), unless couple fluid");
  check_box();

  columns = LEFT + resume.columns();
  const auto add = [this](int &column, int width) {
    column = columns;
    columns += width;
  };
  if (set.conserve) add(account_column, ACCOUNT_COLUMNS);
  if (set.overlap_once) add(weight_column, 1);
  if (set.fluctuation != VansSettings::NO_FLUCTUATION) add(eddy_column, EDDY_COLUMNS);

  stream.reset(new VansStream(lmp, set));
  // Yade's least slip is 1e-5 m/s; a velocity of 1 is 1 m/s in units si, micro and nano.
  stream->fluid.least_slip = strcmp(update->unit_style, "cgs") == 0 ? 1e-3 : 1e-5;

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

void FixHydroVans::check_box() const
{
  if (force->ftm2v != 1.0)
    fail(lmp,
         COMMAND + ": units " + update->unit_style +
             ": use lj, si, cgs, micro or nano, in which force is mass times acceleration");
  if (domain->dimension != 3)
    fail(lmp, COMMAND + ": dimension 2: the stream needs three dimensions, z up");
  for (int d = 0; d < 2; d++)
    if (set.averages() && set.area == 0.0 &&
        (domain->boundary[d][0] >= 2 || domain->boundary[d][1] >= 2))
      fail(lmp,
           COMMAND + ": keyword area: the box is shrink-wrapped along " + "xy"[d] +
               ", so that its area follows the grains: give the area of the stream");
}

/* One class for each radius, in the order of the lowest atom ID that has it. */
void FixHydroVans::find_classes()
{
  if (has_grains() && set.class_radii.empty() && (set.classes || set.wants_pores())) {
    struct First {
      double radius;
      tagint tag;
    };
    const int found = group->find(set.average.c_str()),
              bit = found < 0 ? 1 : group->bitmask[found];
    std::map<double, tagint> first;
    const auto meet = [&first](double radius, tagint tag) {
      const auto at = first.emplace(radius, tag).first;
      at->second = std::min(at->second, tag);
    };
    for (int i = 0; i < atom->nlocal && first.size() <= MAX_CLASSES; i++)
      if ((atom->mask[i] & bit) && atom->radius[i] > 0.0) meet(atom->radius[i], atom->tag[i]);
    std::vector<First> mine;
    for (const auto &entry : first) mine.push_back({entry.first, entry.second});
    for (const First &entry : from_all(world, mine)) meet(entry.radius, entry.tag);
    if (first.size() > MAX_CLASSES && set.classes)
      fail(lmp,
           COMMAND + ": keyword classes: the grains have more than " + std::to_string(MAX_CLASSES) +
               " different radii; a class is one radius exactly");
    if (first.size() > MAX_CLASSES) first.clear();    // pores: one class of the mean radius
    std::vector<std::pair<tagint, double>> order;
    for (const auto &entry : first) order.emplace_back(entry.second, entry.first);
    std::sort(order.begin(), order.end());
    std::vector<double> radii;
    for (const auto &entry : order) radii.push_back(entry.second);
    if (!radii.empty()) stream->set_classes(radii);
  }
  const int nclass = (int) stream->class_radii.size();
  if (set.classes) size_array_cols = ARRAY_COLUMNS + SD_VANS_ROWS * nclass;
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

  const double *drag = stream->row(SD_VANS_DRAG);
  if (set.couple == VansSettings::FLUID && set.radius == 0.0 && !set.classes &&
      std::any_of(drag, drag + stream->ncell(), [](double f) { return f != 0.0; }))
    fail(lmp,
         COMMAND + ": keyword radius: couple fluid with a drag needs the radius of the grains");
  if (set.solves()) tell_steps();
  check_others();
}

/* Atoms that two fixes of this style push. */
void FixHydroVans::check_others() const
{
  for (int k = 0; k < modify->nfix && has_grains(); k++) {
    const Fix *other = modify->fix[k];
    if (strcmp(other->style, style) != 0) continue;
    if (other == this) break;    // every pair once
    bigint mine = 0, all;
    for (int i = 0; i < atom->nlocal; i++)
      mine += (atom->mask[i] & groupbit) && (atom->mask[i] & other->groupbit);
    MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    if (all > 0 && comm->me == 0)
      error->warning(FLERR,
                     COMMAND + ": " + std::to_string(all) + " atoms are in the groups of fix " +
                         other->id + " and of fix " + id + ": they feel drag and buoyancy twice");
  }
}

/* What a coupling does, where it is not what the keywords seem to say, or takes seconds. */
void FixHydroVans::tell_steps()
{
  const double T = set.period > 0.0 ? set.period : nevery * update->dt,
               wanted = set.period > 0.0 ? set.dt : 0.1 * T, N = set.ncell();
  double dt = wanted;
  const auto steps = sd_vans_steps(set.rules, T, &dt);
  if (comm->me != 0) return;
  const std::string as_made = std::to_string(steps) + " steps of " + text(dt) + " are used";
  if (std::fabs(dt - wanted) > 1e-9 * wanted)
    utils::logmesg(lmp,
                   COMMAND + ": the step " + text(wanted) + " of keyword solve is no fraction of " +
                       text(T) + ": " + as_made + "\n");
  else if (std::fabs(steps * dt - T) > 1e-9 * T)
    utils::logmesg(lmp, COMMAND + ": rules yade: " + as_made + " for the period " + text(T) + "\n");
  if (set.couple == VansSettings::TWO && std::fabs(T / (nevery * update->dt) - 1.0) > 1e-9)
    utils::logmesg(lmp,
                   COMMAND + ": the water moves on by " + text(T) +
                       " while the grains move on by " + text(nevery * update->dt) + "\n");
  if (steps * N > 1e9 && !told_work) {
    told_work = true;
    error->warning(FLERR,
                   COMMAND + ": keyword solve: " + text((double) steps) + " steps of " + text(N) +
                       " slices in every coupling, about " + text(5e-9 * steps * N) +
                       " seconds each");
  }
}

/* ---- which atoms ----------------------------------------------------------------------------- */

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

/* The atoms of this rank, those that `take` says. */
sd_vans_grains FixHydroVans::grains()
{
  const int n = atom->nlocal;
  sd_vans_grains all = {n, n ? atom->x[0] : nullptr, n ? atom->v[0] : nullptr, atom->radius,
                        nullptr, nullptr, take.data()};
  if (eddy_column >= 0) {
    u.resize(3 * (size_t) n + 3);
    for (int i = 0; i < n; i++) memcpy(&u[3 * (size_t) i], array_atom[i] + 3, 3 * sizeof(double));
    all.fluctuation = u.data();
  }
  if (weight_column >= 0) {
    weight.resize(n + 1);
    for (int i = 0; i < n; i++) weight[i] = memo[i][weight_column];
    all.weight = weight.data();
  }
  return all;
}

/* Of those atoms into F and drag_x; how many are outside the mesh. */
int FixHydroVans::forces(const sd_vans_grains &grains)
{
  F.resize(3 * (size_t) grains.n + 3);
  drag_x.resize(grains.n + 1);
  return sd_vans_forces(&stream->mesh, &stream->law, stream->U.data(), stream->hindrance.data(),
                        &grains, F.data(), drag_x.data());
}

/* Tells one set of members of clumps from another, in any order and on any ranks: IDs, molecules,
 * radii. */
uint64_t FixHydroVans::members() const
{
  uint64_t mine = 1, all = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & average_bit) || atom->molecule[i] == 0) continue;
    uint64_t radius;
    memcpy(&radius, &atom->radius[i], sizeof(radius));
    mine += sd_hash_mix(sd_hash_mix(sd_hash_mix((uint64_t) atom->tag[i] + SD_HASH_STEP) ^
                                    (uint64_t) atom->molecule[i]) ^ radius);
  }
  for (uint64_t part : from_all(world, std::vector<uint64_t>(1, mine))) all += part;
  return all;
}

/* The share of each member of a clump in the volume of the union. Once for every set of members:
 * clumps are rigid. Seen from each member the others stand at their nearest image: what overlaps it
 * is near. */
void FixHydroVans::count_overlaps()
{
  const uint64_t now = members();
  if (now == members_counted) return;
  members_counted = now;
  struct Member {
    tagint molecule, tag;
    double x[3], a;
  };
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    memo[i][weight_column] = 1.0;
    const double *x = atom->x[i];
    if (atom->molecule[i] != 0 && (atom->mask[i] & average_bit) && atom->radius[i] > 0.0)
      mine.push_back({atom->molecule[i], atom->tag[i], {x[0], x[1], x[2]}, atom->radius[i]});
  }
  auto all = from_all(world, mine);
  std::sort(all.begin(), all.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  std::map<tagint, double> share;
  std::vector<double> x, a;
  for (size_t begin = 0, end; begin < all.size(); begin = end) {
    for (end = begin; end < all.size() && all[end].molecule == all[begin].molecule; end++) {}
    const size_t n = end - begin;
    x.resize(3 * n);
    a.resize(n);
    for (size_t k = 0; k < n; k++) {
      for (size_t j = 0; j < n; j++) {
        for (int d = 0; d < 3; d++) x[3 * j + d] = all[begin + j].x[d] - all[begin + k].x[d];
        Compat::minimum_image(domain, &x[3 * j]);
        a[j] = all[begin + j].a;
      }
      share[all[begin + k].tag] = sd_vans_union_share((int) n, x.data(), a.data(), (int) k);
    }
  }
  for (int i = 0; i < atom->nlocal; i++) {
    const auto at = share.find(atom->tag[i]);
    if (at != share.end()) memo[i][weight_column] = at->second;
  }
}
