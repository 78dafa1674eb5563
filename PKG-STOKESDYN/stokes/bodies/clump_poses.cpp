#include "clump_poses.h"

#include "ambient.h"
#include "copy.h"
#include "keywords.h"

#include "sd_linear.h"

#include "atom.h"

#include <algorithm>
#include <iterator>

using namespace LAMMPS_NS;

namespace StokesDyn {

ClumpPoses::ClumpPoses(LAMMPS *lmp, const WholeClumps &whole, const Epochs &epochs, const Ambient &ambient,
                       RigidClumps &rigid, const Given &given) :
    Pointers(lmp), rigid(rigid), given(given), whole(whole), epochs(epochs), ambient(ambient)
{
}

/* What clumps must know of their spheres; velocities are those of the images side by side. */
template <int WIDTH> void ClumpPoses::gather(const std::vector<RigidClumps::OwnClump> &all)
{
  const double *gradients = ambient.gradients(), *jumps = ambient.jumps();
  const bool moving = given.velocities, turns = rigid.settings.rotation;
  const size_t n = rigid.members().size(), flows = WIDTH == COLUMNS ? 3 * n : 0;
  for (auto *numbers : {&spheres.eta, &spheres.radius}) numbers->resize(n + 1);
  spheres.x.resize(3 * n + 3);
  for (auto *vectors : {&spheres.v, &spheres.omega}) vectors->resize(moving ? 3 * n + 3 : 0);
  loads.assign(moving ? 0 : 6 * all.size(), 0.0);
  spheres.flow.resize(flows);
  spheres.gradient.resize(3 * flows);
  const auto row = [&](int i, double *out) {
    out[ETA] = ambient.active()[i] ? ambient.viscosity(i) : 0.0;
    out[RADIUS] = atom->radius[i];
    if (!moving)
      given.load(i, out + LOAD);
    else {
      copy<3>(atom->v[i], out + VELOCITY);
      if (turns) copy<3>(atom->omega[i], out + OMEGA);
    }
    if (WIDTH < COLUMNS) return;
    copy<3>(ambient.velocity(i), out + FLOW);
    copy<9>(gradients + 9 * (size_t) i, out + GRADIENT);
  };
  size_t b = 0;    // whose member m is: bodies are in the order of their members
  const auto add_load = [&](const double *x, const double *FT) {
    double arm[3];
    sd_minus(x, &whole.x[3 * (size_t) rigid.members()[all[b].begin]], arm);
    sd_clump_add_load(arm, FT, &loads[6 * b]);
  };
  const auto take = [&](size_t m, const double *of) {
    const int k = rigid.places()[m], *edges = &whole.edges[3 * m];
    if (k < 0) return;
    while (k >= all[b].begin + all[b].n) b++;
    spheres.eta[k] = of[ETA];
    spheres.radius[k] = of[RADIUS];
    copy<3>(&whole.x[3 * m], &spheres.x[3 * (size_t) k]);
    if (!moving)
      add_load(&whole.x[3 * m], of + LOAD);
    else {
      copy<3>(of + VELOCITY, &spheres.v[3 * (size_t) k]);
      copy<3>(of + OMEGA, &spheres.omega[3 * (size_t) k]);
      if (jumps) sd_add_edges(jumps, edges, &spheres.v[3 * (size_t) k]);
    }
    if (WIDTH < COLUMNS) return;
    copy<3>(of + FLOW, &spheres.flow[3 * (size_t) k]);
    copy<9>(of + GRADIENT, &spheres.gradient[9 * (size_t) k]);
    if (jumps) sd_add_edges(jumps, edges, &spheres.flow[3 * (size_t) k]);
  };
  whole.gather<WIDTH>(row, take);
}

void ClumpPoses::find()
{
  found.set(epochs.lists);
  all_clumps.clear();
  find_lone();
  if (!rigid.settings.on) return;
  const auto &all = rigid.find();
  ambient.gradients() ? gather<COLUMNS>(all) : gather<FLOW>(all);
  int64_t split = RigidClumps::NOBODY;
  std::vector<int64_t> bent;
  for (size_t b = 0; b < all.size(); b++) {
    const RigidClumps::OwnClump &body = all[b];
    Clump clump = {(int) b, {}, 0.0, {}, SD_BODY_FREE};
    int taking_part = 0;
    for (int k = 0; k < body.n; k++) {
      const double eta_k = spheres.eta[body.begin + k];
      taking_part += eta_k > 0.0;
      clump.eta += eta_k;
    }
    clump.eta /= body.n;
    if (taking_part == 0) continue;
    if (taking_part < body.n) split = std::min(split, body.molecule);
    if (!rigid.fits(body, &spheres.radius[body.begin], &spheres.x[3 * (size_t) body.begin], clump.pose))
      bent.push_back(body.molecule);
    all_clumps.push_back(clump);
  }
  if (rigid.loosen(split, bent)) return find();
  find_held();
}

void ClumpPoses::find_lone()
{
  if (!lone_found.first_in(epochs.selection)) return;
  all_lone.clear();
  const auto free = [this](int i) {
    return !rigid.settings.on || atom->molecule[i] == 0;
  };
  if (!given.velocities)    // nobody asks for them
    std::copy_if(ambient.who().begin(), ambient.who().end(), std::back_inserter(all_lone), free);
}

/* Clumps whose velocity is given: by that of their first sphere, on its image. */
void ClumpPoses::find_held()
{
  for (Clump &clump : all_clumps) clump.known = SD_BODY_FREE;
  if (!given.known || !rigid.settings.on) return;
  const std::vector<double> of_member = whole.gather(7, [this](int i, double *out) {
    out[0] = given.known(i, out + 1);
  });
  int64_t split[2] = {RigidClumps::NOBODY, RigidClumps::NOBODY};    // by held, by pin
  for (Clump &clump : all_clumps) {
    const double *first = &of_member[7 * member_of(clump, 0)];
    clump.known = (sd_body_known) first[0];
    for (int k = 1; k < own_clump(clump).n; k++) {
      const double known = of_member[7 * member_of(clump, k)];
      int64_t &least = split[known == SD_BODY_PINNED || clump.known == SD_BODY_PINNED];
      if (known != first[0]) least = std::min(least, own_clump(clump).molecule);
    }
    if (clump.known != SD_BODY_HELD) continue;
    double arm[3];
    std::copy_n(first + 1, 6, clump.V);
    if (ambient.jumps())
      sd_add_edges(ambient.jumps(), &whole.edges[3 * member_of(clump, 0)], clump.V);
    sd_minus(clump.pose + 9, &spheres.x[3 * (size_t) own_clump(clump).begin], arm);
    sd_clump_shift_velocity(arm, clump.V);
  }
  for (int pin = 0; pin < 2; pin++) {
    const int64_t molecule = smallest_of_all(world, split[pin]);
    if (molecule == RigidClumps::NOBODY) continue;
    Voice(lmp, "Fix stokes_dynamics/overdamped")
        .fail(std::string("keyword ") + (pin ? "pin" : "held") + ": the clump of molecule " +
              std::to_string(molecule) +
              " is only partly in the group: all of its spheres must be in it, or none");
  }
}

void ClumpPoses::moves(const double *V)
{
  for (size_t c = 0; c < clumps().size(); c++) std::copy_n(V + 6 * c, 6, all_clumps[c].V);
}

// --- each by itself: a closed form, so there is nothing to solve -----------------------------------

/* What the spheres of a clump and the fluid at them do. The angular velocities of spheres that are
 * not on a line say nothing that their velocities do not. */
sd_clump_motion ClumpPoses::look_at(const Clump &clump) const
{
  const bool strains = ambient.gradients(), spins = rigid.settings.rotation;
  const size_t at = 3 * (size_t) own_clump(clump).begin;
  sd_clump_motion m = {};
  m.x = &spheres.x[at];
  m.v = given.velocities ? &spheres.v[at] : nullptr;
  m.omega = given.velocities && spins && shape(clump).shape.rank < 2 ? &spheres.omega[at] : nullptr;
  std::copy_n(ambient.uniform_velocity(), 3, m.u_uniform);
  m.u = strains ? &spheres.flow[at] : nullptr;
  m.gradient = strains ? &spheres.gradient[3 * at] : nullptr;
  return m;
}

void ClumpPoses::velocities(const ToAtom &take)
{
  const int width = rigid.settings.rotation ? 6 : 3;
  double fluid_there[6], V[6], by_fluid[6], load[6], D[6];
  for (int i : lone()) {
    const bool known = given.known && given.known(i, V);
    ambient.fluid(i, fluid_there);
    given.load(i, load);
    for (int d = 0; d < width; d++) D[d] = ambient.resistance(i, d);
    sd_sphere_move_alone(width, D, fluid_there, known ? nullptr : load, V, by_fluid);
    take(i, V, by_fluid);
  }
  if (!rigid.settings.on) return;
  enum { ROW = 12 };    // velocity, angular velocity, force, torque
  std::vector<double> rows;
  double back[6] = {0.0};
  for (int d = 0; d < 6 && ambient.jumps(); d++) back[d] = -ambient.jumps()[d];
  const auto all = [&](const auto &give) {
    for (Clump &clump : all_clumps) {
      const size_t n = own_clump(clump).n, at = 3 * (size_t) own_clump(clump).begin;
      const sd_clump_placed is = placed(clump);
      const sd_clump_motion motion = look_at(clump);
      double arm[3], on_clump[6] = {0.0};
      sd_minus(&spheres.x[at], clump.pose + 9, arm);
      sd_clump_add_load(arm, &loads[6 * (size_t) clump.number], on_clump);
      rows.resize(ROW * n);
      const sd_clump_rows out = {ROW, rows.data(), &rows[6], width == 6 ? &rows[9] : nullptr};
      sd_clump_move_alone(&is, &motion, clump.known == SD_BODY_HELD ? nullptr : on_clump, clump.V, &out);
      for (size_t k = 0; k < n; k++) {
        const size_t m = member_of(clump, (int) k);
        if (ambient.jumps()) sd_add_edges(back, &whole.edges[3 * m], &rows[ROW * k]);
        give(m, &rows[ROW * k]);
      }
    }
  };
  whole.scatter(ROW, all, [&](int i, const double *of) { take(i, of, of + 6); });
}

void ClumpPoses::drag(const Drag &take, std::vector<char> &left_over)
{
  const bool turns = rigid.settings.rotation;
  enum { LOOSE, FORCE, TORQUE = FORCE + 3, ROW = TORQUE + 3 };
  std::vector<double> rows;
  const auto all = [&](const auto &give) {
    for (const Clump &clump : clumps()) {
      const sd_clump_placed is = placed(clump);
      const sd_clump_motion motion = look_at(clump);
      const size_t n = own_clump(clump).n;
      rows.resize(ROW * n);
      const sd_clump_rows out = {ROW, nullptr, &rows[FORCE], turns ? &rows[TORQUE] : nullptr};
      sd_clump_drag(&is, &motion, &out);
      for (size_t k = 0; k < n; k++) give(member_of(clump, (int) k), &rows[ROW * k]);
    }
    const double loose_row[ROW] = {1.0};
    for (size_t m = 0; m < rigid.places().size(); m++)
      if (rigid.places()[m] < 0) give(m, loose_row);
  };
  left_over.assign(atom->nlocal + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) left_over[i] = atom->molecule[i] == 0;
  whole.scatter(ROW, all, [&](int i, const double *of) {
    if (of[LOOSE] == 0.0)
      take(i, of + FORCE);
    else
      left_over[i] = 1;
  });
}

}    // namespace StokesDyn
