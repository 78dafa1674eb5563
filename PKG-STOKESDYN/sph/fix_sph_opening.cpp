#include "fix_sph_opening.h"

#include "keywords.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_sph_opening.h"
#include "sph.h"

#include "atom.h"
#include "domain.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphOpening::FixSphOpening(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg)
{
  scalar_flag = 1;
  global_freq = 1;
  extscalar = 1;
  restart_global = 1;
}

Keywords FixSphOpening::parse_place(int narg, char **arg)
{
  Keywords in = keywords(narg, arg);
  const size_t face = in.positional("FACE").choice({"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"});
  axis = (int) face / 2;
  side = face % 2 ? 1 : -1;
  plane = in.positional("POSITION").number();
  width = in.positional("WIDTH").positive();
  return in;
}

/* The layers have the velocity of this step before their ghosts and the force see it, as at the
 * beginning of a run. */
int FixSphOpening::setmask()
{
  return FixConst::PRE_EXCHANGE | FixConst::POST_INTEGRATE;
}

/* New particles must find room in the box, and old ones must not be lost before they are deleted. */
void FixSphOpening::init()
{
  pair = PairSph::of(voice);
  if (domain->triclinic) voice.fail("the box must not be triclinic");
  const double end = plane + side * width, edge = side > 0 ? domain->boxhi[axis] : domain->boxlo[axis];
  if (domain->boundary[axis][side > 0] != 1)
    voice.fail("the box must have boundary f beyond the layer, along " +
               std::string(1, (char) ('x' + axis)));
  if (plane < domain->boxlo[axis] || plane > domain->boxhi[axis])
    voice.fail("POSITION " + text(plane) + " is outside of the box, which goes from " +
               text(domain->boxlo[axis]) + " to " + text(domain->boxhi[axis]) +
               ": is it in other units?");
  if (side * (end - edge) > 1e-9 * width)
    voice.fail("the layer from " + text(plane) + " to " + text(end) +
               " does not fit into the box, which ends at " + text(edge));
  pressure.init(lmp);
}

void FixSphOpening::setup_pre_exchange()
{
  check_width();
  check_side();
}

/* Fluid at the plane sees 2 h into the layer; new particles are made up to half of the skin late, and
 * the last row stands a spacing before the end. Spacing and half of the skin are less than h. */
void FixSphOpening::check_width()
{
  double mine = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) mine = std::max(mine, pair->smoothing_length(atom->type[i]));
  const double h = largest_of_all(world, mine);
  const double needed = 2.0 * h + std::max(h, neighbor->skin);
  if (width < needed * (1.0 - 1e-9))    // 0.6 is not less than 2 * 0.2 + 0.2
    voice.fail("the width " + text(width) +
               " of the layer is too small: particles of the flow would see its end; it must be " +
               text(needed) + " or more");
}

void FixSphOpening::check_side() const
{
  bigint mine[2] = {0, 0}, all[2];    // all, and those behind the layer
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    mine[0]++;
    mine[1] += beyond(atom->x[i]) > width;
  }
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all[0] > 0 && all[1] == all[0])
    voice.fail("all particles of its group stand behind the layer, which reaches from " + text(plane) +
               " to " + text(plane + side * width) + ": FACE " + std::string(1, (char) ('x' + axis)) +
               (side > 0 ? "hi" : "lo") + " is the end of the flow at which the layer stands, and " +
               "POSITION must lie between them and it");
}

void FixSphOpening::find_pressures()
{
  pressures.resize(atom->nlocal + 1);
  pressure.evaluate(lmp, igroup, pressures.data(), 1);
}

std::array<double, 2> FixSphOpening::across(const double *x) const
{
  const int d0 = axis == 0 ? 1 : 0, d1 = axis == 2 ? 1 : 2;
  return {x[d0], x[d1]};
}

double FixSphOpening::largest_h() const
{
  double h = 0.0;
  for (int type = 1; type <= atom->ntypes; type++)
    if (pair->takes(type)) h = std::max(h, pair->smoothing_length(type));
  return h;
}

void FixSphOpening::look_at_flow()
{
  const double support = 2.0 * largest_h();
  flow = over_section([this, support](int i) -> const double * {
    const double before = -beyond(atom->x[i]);
    return before >= 0.0 && before < support ? atom->x[i] : nullptr;
  });
}

/* Nodes are about h/2 apart, a spacing or less: twice as far, they blunted the profile of a channel so much that the
 * pressure gradient before the outlet was 4 % too small. */
std::vector<double> FixSphOpening::over_section(const std::function<const double *(int)> &place)
{
  const auto lo = across(domain->boxlo), hi = across(domain->boxhi);
  for (int d = 0; d < 2; d++) {
    const bool flat = d == 1 && domain->dimension == 2;
    section.n[d] = flat ? 1 : 1 + std::max(1, (int) (2.0 * (hi[d] - lo[d]) / largest_h()));
    section.lo[d] = lo[d];
    section.step[d] = flat ? 1.0 : (hi[d] - lo[d]) / (section.n[d] - 1);
  }
  std::vector<double> mine(2 * (size_t) section.n[0] * section.n[1], 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (const double *x = place(i))
      sd_sph_section_add(&section, across(x).data(), Sph::mass(lmp, i), side * atom->v[i][axis], mine.data());
  }
  std::vector<double> all(mine.size());
  MPI_Allreduce(mine.data(), all.data(), (int) mine.size(), MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* A ghost across the box stands where its particle does. */
double FixSphOpening::mass_over(const std::vector<double> &sums, const double *x) const
{
  double inside[3];
  std::copy_n(x, 3, inside);
  domain->remap(inside);
  return sd_sph_section_mass(&section, across(inside).data(), sums.data());
}

double FixSphOpening::speed_before(const double *x, double otherwise) const
{
  return sd_sph_section_speed(&section, across(x).data(), flow.data(), otherwise);
}

double FixSphOpening::whole_flow() const
{
  double all = 0.0;
  for (size_t k = 1; k < flow.size(); k += 2) all += flow[k];
  return all;
}

/* Once. */
void FixSphOpening::tell_of_backflow(const std::string &what)
{
  if (told) return;
  told = true;
  voice.at_step().warn(what);
}

double FixSphOpening::compute_scalar()
{
  return sum_of_all(world, passed);
}
