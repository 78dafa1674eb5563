#include "deforming_box.h"

#include "deform_settings.h"
#include "fixes.h"
#include "lattice.h"

#include "sd_flow.h"

#include "domain.h"
#include "input.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double TWO_PI = 6.283185307179586477;

Fix *deform_of(LAMMPS *lmp)
{
  return fix_like(lmp, "^deform");
}

namespace {
  /* A length or a tilt, and its rate. */
  struct Edge {
    double now, rate;
  };

  /* The clock of fix deform, or one so many steps ahead: since the run began, and how much of the run that
   * is; and by how long it is ahead of what variables know */
  struct Clock {
    double time, part, length, ahead;
    Clock(const Update *update, double later) : ahead(later * update->dt)
    {
      const double steps = update->ntimestep - update->beginstep + later,
                   all = update->endstep - update->beginstep;
      time = steps * update->dt;
      part = all > 0.0 ? steps / all : 0.0;
      length = all * update->dt;
    }
  };
}    // namespace

/* What fix deform makes of start and stop by its style; start: at the begin of the run. The rates of
 * erate and vel are known in a run of no steps as well. */
template <class Set>
static Edge edge_of(LAMMPS *lmp, const Set &set, double start, double stop, double length,
                    const Clock &clock)
{
  const double now = start + clock.part * (stop - start);
  switch (set.style) {
    case DeformSettings::ERATE:
      return {now, set.rate * length};
    case DeformSettings::VEL:
      return {now, set.vel};
    case DeformSettings::TRATE: {
      const double grown = start * exp(set.rate * clock.time);
      return {grown, set.rate * grown};
    }
    case DeformSettings::WIGGLE: {
      const double turns = TWO_PI / set.tperiod;
      return {start + set.amplitude * sin(turns * clock.time),
              set.amplitude * turns * cos(turns * clock.time)};
    }
    case DeformSettings::VARIABLE: {
      Variable *variable = lmp->input->variable;
      const double rate = variable->compute_equal(set.hratevar);
      return {start + variable->compute_equal(set.hvar) + clock.ahead * rate, rate};
    }
    default:
      return {now, clock.length > 0.0 ? (stop - start) / clock.length : 0.0};
  }
}

/* The lower end of an edge along an axis: most styles keep its middle. */
template <class Set> static Edge corner_of(const Set &set, const Edge &edge, const Clock &clock)
{
  if (set.style == DeformSettings::FINAL || set.style == DeformSettings::DELTA || set.style == DeformSettings::SCALE) {
    const double rate = clock.length > 0.0 ? (set.lo_stop - set.lo_start) / clock.length : 0.0;
    return {set.lo_start + rate * clock.time, rate};
  }
  return {0.5 * (set.lo_start + set.hi_start) - 0.5 * edge.now, -0.5 * edge.rate};
}

/* A length that keeps the volume, or with another one shares what is due: it follows from those that
 * do not. */
template <class Set> static Edge volume_edge(const Set &set, int d, const Edge *edge)
{
  const auto start = [&](int e) { return set[e].hi_start - set[e].lo_start; };
  const int one = set[d].dynamic1, two = set[d].dynamic2;
  double shrunk = start(one) / edge[one].now, rate = -edge[one].rate / edge[one].now;
  if (set[d].substyle == DeformSettings::ONE_FROM_TWO) {
    shrunk *= start(two) / edge[two].now;
    rate -= edge[two].rate / edge[two].now;
  } else if (set[d].substyle == DeformSettings::TWO_FROM_ONE) {
    shrunk = sqrt(shrunk);
    rate *= 0.5;
  }
  const double now = start(d) * shrunk;
  return {now, rate * now};
}

BoxMotion motion_of_box(const Voice &voice, double later)
{
  BoxMotion motion;
  LAMMPS *lmp = voice.lmp;
  Fix *deform = deform_of(lmp);
  if (!deform) return motion;
  motion.deforms = true;
  if (lmp->update->setupflag) DeformSettings::check(lmp, deform);
  const Domain *domain = lmp->domain;
  const auto set = DeformSettings::of(deform);
  const Clock clock(lmp->update, later);
  Edge edge[6];
  for (int d = 0; d < 6; d++) {
    edge[d] = {d < 3 || domain->triclinic ? domain->h[d] : 0.0, 0.0};
    if (set[d].style == DeformSettings::NONE || set[d].style == DeformSettings::VOLUME) continue;
    // by what length an erate is one: its own, or for a tilt that of the edge that it leans over
    const auto &of = set[d < 3 ? d : d == 5 ? 1 : 2];
    const double length = of.hi_start - of.lo_start;
    edge[d] = d < 3 ? edge_of(lmp, set[d], length, set[d].hi_stop - set[d].lo_stop, length, clock)
                    : edge_of(lmp, set[d], set[d].tilt_start, set[d].tilt_stop, length, clock);
  }
  for (int d = 0; d < 3; d++)
    if (set[d].style == DeformSettings::VOLUME) edge[d] = volume_edge(set, d, edge);
  double h[6], rate[6];
  for (int d = 0; d < 6; d++) {
    h[d] = edge[d].now;
    rate[d] = edge[d].rate;
  }
  sd_flow_of_cell(h, rate, motion.flow.gradient);
  for (int d = 0; d < 3; d++) {
    const Edge corner = corner_of(set[d], edge[d], clock);
    motion.flow.corner[d] = set[d].style == DeformSettings::NONE ? domain->boxlo[d] : corner.now;
    motion.flow.corner_velocity[d] = corner.rate;
  }
  return motion;
}

void bring_box_to_this_step(LAMMPS *lmp)
{
  Fix *deform = deform_of(lmp);
  if (!deform || lmp->update->ntimestep % deform->nevery != 0) return;
  // A flip that is due in this step, where LAMMPS has yet to re-neighbour, would be put off to the next.
  const bigint due = deform->next_reneighbor;
  deform->end_of_step();
  if (due == lmp->update->ntimestep) deform->next_reneighbor = due;
}

sd_box box_of(const Domain *domain)
{
  const Lattice lattice = Lattice::of(domain);
  sd_box box;
  std::copy_n(lattice.origin, 3, box.lo);
  std::copy_n(lattice.h, 6, box.h);
  return box;
}

void put_box(Domain *domain, const sd_box &box)
{
  for (int d = 0; d < 3; d++) {
    domain->boxlo[d] = box.lo[d];
    domain->boxhi[d] = box.lo[d] + box.h[d];
  }
  if (domain->triclinic) {
    domain->yz = box.h[3];
    domain->xz = box.h[4];
    domain->xy = box.h[5];
  }
  domain->set_global_box();
  domain->set_local_box();
}

}    // namespace StokesDyn
