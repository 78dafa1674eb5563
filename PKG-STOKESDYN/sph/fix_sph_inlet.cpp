#include "fix_sph_inlet.h"

#include "keywords.h"
#include "lammps_compat.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_sph_opening.h"
#include "sph.h"
#include "table_file.h"

#include "atom.h"
#include "domain.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <tuple>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphInlet::FixSphInlet(LAMMPS *lmp, int narg, char **arg) :
    FixSphOpening(lmp, narg, arg), marks(COLUMNS)
{
  Keywords in = parse_place(narg, arg);
  in.parse({
      {"velocity",
       [&] {
         velocity = Field::parse(in);
       }},
      {"flow_rate",
       [&] {
         drive = FLOW_RATE;
         if (in.take("file"))
           read_hydrograph(in.word());
         else
           flow_rate = Field::parse(in, Field::ONE_FOR_ALL);
       }},
      {"pressure",
       [&] {
         drive = PRESSURE;
         pressure = Field::parse(in);
       }},
      {"gravity",
       [&] {
         gravity.parse(in);
       }},
  });
  const int drives = in.given("velocity") + in.given("flow_rate") + in.given("pressure");
  in.require(drives == 1, "one of the keywords velocity, flow_rate and pressure is required: what drives "
                          "the fluid in");
  in.require(drive != PRESSURE || !in.given("gravity"),
             "keyword gravity does not go with pressure, which may be a variable of the height");
  keep({&marks}, nullptr, true);
}

/* Rows of a time and a discharge. */
void FixSphInlet::read_hydrograph(const std::string &file)
{
  const Voice what = voice.of("keyword flow_rate: file '" + file + "'");
  for (const auto &row : read_rows(voice.of("keyword flow_rate"), file)) {
    if (row.size() != 2)
      what.fail("row " + std::to_string(times.size() + 1) + " must have two numbers, a time and a discharge");
    if (!times.empty() && !(row[0] > times.back()))
      what.fail("the time " + text(row[0]) + " does not lie after " + text(times.back()));
    times.push_back(row[0]);
    rates.push_back(row[1]);
  }
  if (times.empty()) what.fail("no rows of a time and a discharge");
}

void FixSphInlet::init()
{
  FixSphOpening::init();
  velocity.init(lmp);
  flow_rate.init(lmp);
  gravity.init(lmp);
}

double FixSphInlet::time() const
{
  return time_before + update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

std::vector<SavedNumbers> FixSphInlet::saved()
{
  std::vector<SavedNumbers> all = FixSphOpening::saved();
  all.push_back({"time", &time_then});
  return all;
}

void FixSphInlet::write_state(NamedState &)
{
  if (!resumed) time_then = time();
}

double FixSphInlet::discharge()
{
  if (times.empty()) return flow_rate.evaluate(lmp);
  return sd_sph_hydrograph((int) times.size(), times.data(), rates.data(), time());
}

/* Of the whole layer: from the volume that its particles have at rest, which is the same while they come
 * and go. */
double FixSphInlet::common_speed()
{
  double volume = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & groupbit) && marks[i][STATE] != REPLACED)
      volume += Sph::mass(lmp, i) / pair->rest_density(i);
  return discharge() * width / sum_of_all(world, volume);
}

/* As far as about a spacing beside its particles. A particle itself finds a quarter of its mass at least around it. */
bool FixSphInlet::reaches(const double *x) const
{
  constexpr double LEAST = 0.1;
  return !strayed || mass_over(layer, x) > LEAST * full;
}

void FixSphInlet::look_at_strays()
{
  int mine = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (is_beyond(i) && marks[i][STATE] == REPLACED) mine = 1;
  strayed = largest_of_all(world, mine) > 0;
  if (!strayed) return;
  layer = over_section([this](int i) -> const double * {
    const double *mark = marks[i];
    return mark[STATE] == IN_LAYER ? atom->x[i] : mark[STATE] == DUE ? mark + PLACE : nullptr;
  });
  full = 0.0;
  for (size_t k = 0; k < layer.size(); k += 2) full = std::max(full, layer[k]);
}

/* As the fluid before each particle flows, but not backwards. At the beginning of a run, as it is. */
void FixSphInlet::follow_flow()
{
  if (!update->setupflag) look_at_flow();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const bool due = marks[i][STATE] == DUE;
    const double now = due ? marks[i][SPEED] : -side * atom->v[i][axis];
    speeds[i] = update->setupflag ? now : std::max(0.0, -speed_before(due ? marks[i] + PLACE : atom->x[i], -now));
  }
  if (!update->setupflag && whole_flow() > 0.0)
    tell_of_backflow("the flow turns back at this inlet, which lets nothing out and holds it there");
}

/* Of all in the layer, and of those that are due, where they are due: a variable may depend on place
 * and time. */
void FixSphInlet::find_speeds()
{
  speeds.resize(atom->nlocal + 1);
  if (drive != VELOCITY) {
    if (drive == PRESSURE)
      follow_flow();
    else
      std::fill(speeds.begin(), speeds.end(), common_speed());
    for (int i = 0; i < atom->nlocal; i++)
      if ((atom->mask[i] & groupbit) && marks[i][STATE] == DUE) marks.writable(i)[SPEED] = speeds[i];
    return;
  }
  const auto stand_in = [this] {
    for (int i = 0; i < atom->nlocal; i++)
      if ((atom->mask[i] & groupbit) && marks[i][STATE] == DUE)
        std::swap_ranges(atom->x[i], atom->x[i] + 3, marks.writable(i) + PLACE);
  };
  stand_in();
  velocity.evaluate(lmp, igroup, speeds.data(), 1);
  stand_in();
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & groupbit) && marks[i][STATE] == DUE) marks.writable(i)[SPEED] = speeds[i];
}

/* What comes back over the plane is held where the layer is. Elsewhere, it is spray over the layer of a river or
 * beside that of a tap, it bounces off the plane. */
void FixSphInlet::move_layer()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_beyond(i)) continue;
    double *v = atom->v[i];
    if (is_held(i))
      for (int d = 0; d < 3; d++) v[d] = d == axis ? -side * speeds[i] : 0.0;
    else
      v[axis] = -side * std::fabs(v[axis]);
  }
}

/* Particles that it has not met before are its own if they stand in the layer. */
void FixSphInlet::setup_pre_exchange()
{
  if (resumed) time_before += time_then - time();    // LAMMPS sets its own when a run begins
  resumed = false;
  FixSphOpening::setup_pre_exchange();
  int mine = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    mine += is_beyond(i);
    if (!marks.has(i)) marks.writable(i)[STATE] = is_beyond(i) ? IN_LAYER : REPLACED;
  }
  if (largest_of_all(world, mine) == 0)
    voice.fail("its layer is empty: fill it with particles of its group (create_atoms)");
  look_at_strays();
  find_speeds();
  move_layer();
}

/* A particle that has left is the width of the layer ahead of the one that takes its place. That one
 * moves on with the speed of the layer until there is a new list of neighbours, and it can be made. */
void FixSphInlet::post_integrate()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *mark = marks.writable(i);
    if (mark[STATE] == DUE)
      mark[PLACE + axis] -= side * update->dt * mark[SPEED];
    else if (mark[STATE] == IN_LAYER && !is_beyond(i)) {
      mark[STATE] = DUE;
      std::copy_n(atom->x[i], 3, mark + PLACE);
      mark[PLACE + axis] += side * width;
      mark[LEFT] = (double) update->ntimestep;
      passed += Sph::mass(lmp, i);
    }
  }
  look_at_strays();
  find_speeds();
  move_layer();
}

/* All that are due on any rank, in an order that does not depend on ranks. */
std::vector<FixSphInlet::Newcomer> FixSphInlet::newcomers()
{
  std::vector<Newcomer> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit) || marks[i][STATE] != DUE) continue;
    double *mark = marks.writable(i);
    Newcomer next = {mark[LEFT], (double) atom->tag[i], {mark[PLACE], mark[PLACE + 1], mark[PLACE + 2]},
                     mark[SPEED], atom->rho[i], atom->rmass ? atom->rmass[i] : 0.0,
                     atom->radius ? atom->radius[i] : 0.0, atom->type[i], atom->mask[i]};
    mine.push_back(next);
    mark[STATE] = REPLACED;
  }
  std::vector<Newcomer> all = from_all(world, mine);
  std::sort(all.begin(), all.end(), [](const Newcomer &a, const Newcomer &b) {
    return std::tie(a.left, a.parent) < std::tie(b.left, b.parent);
  });
  return all;
}

bool FixSphInlet::is_here(double *place) const
{
  domain->remap(place);
  bool here = true;
  for (int d = 0; d < domain->dimension; d++)
    here = here && place[d] >= domain->sublo[d] && place[d] < domain->subhi[d];
  return here;
}

/* On the rank that has its place, which returns 1 */
int FixSphInlet::create(const Newcomer &like, tagint tag)
{
  double place[3];
  std::copy_n(like.place, 3, place);
  if (!is_here(place)) return 0;
  atom->avec->create_atom(like.type, place);
  const int i = atom->nlocal - 1;
  atom->tag[i] = tag;
  atom->mask[i] = like.mask;
  atom->v[i][axis] = atom->vest[i][axis] = -side * like.speed;
  modify->create_attribute(i);
  atom->rho[i] = like.rho;
  if (atom->rmass) atom->rmass[i] = like.mass;
  if (atom->radius) atom->radius[i] = like.radius;
  marks.writable(i)[STATE] = IN_LAYER;
  return 1;
}

/* LAMMPS may be told to go on without atoms that it has lost: natoms has them still. */
void FixSphInlet::pre_exchange()
{
  const std::vector<Newcomer> all = newcomers();
  if (all.empty()) return;
  tagint last = 0;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, atom->tag[i]);
  last = largest_of_all(world, last);
  if ((bigint) last > (bigint) MAXTAGINT - (bigint) all.size())
    voice.at_step().fail("there is no atom ID left for " + std::to_string(all.size()) +
                         " new particles: the largest is " + std::to_string(last) +
                         "; 'reset_atom_ids' (in newer LAMMPS 'reset_atoms id') between two runs "
                         "numbers the atoms anew");

  // new particles stand where ghosts were
  if (atom->map_style != Atom::MAP_NONE) atom->map_clear();
  atom->nghost = 0;
  int made = 0;
  for (const Newcomer &next : all) made += create(next, ++last);
  if (sum_of_all(world, made) != (int) all.size())
    voice.at_step().fail("a new particle would stand outside of the box: where the flow turns back, "
                         "the box must be longer than the layer");
  atom->natoms += (bigint) all.size();
  if (atom->map_style != Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }
}
