#include "body_steps.h"

#include "copy.h"
#include "halo.h"

#include "sd_linear.h"
#include "sd_pose.h"

#include "atom.h"
#include "domain.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

void BodySteps::note(int i, const double *step)
{
  displaced = std::max(displaced, sd_dot(step, step) / (atom->radius[i] * atom->radius[i]));
}

// --- a body --------------------------------------------------------------------------------------------------

/* A sphere that is in no clump goes and turns by move [6]. beyond_box [3]: its displacement in a whole step, but
 * for what it goes with the box; nullptr: this is part of a step */
void BodySteps::step_lone(int i, const double *move, const double *beyond_box)
{
  for (int d = 0; d < 3; d++) atom->x[i][d] += move[d];
  if (drives.is_held(i)) return;
  directions.turn(i, move + 3, 1.0);
  if (beyond_box) note(i, beyond_box);
}

BodySteps::Clumps BodySteps::clumps_now(const Hydrodynamics &hydro)
{
  const WholeClumps &whole = hydro.scene.whole;
  return {hydro.poses().clumps(), whole.x, whole.edges, whole.h};
}

/* What becomes of the spheres of clump c of this rank. Positions are those of images side by side: an atom moves
 * as its image does, less what the edges of the box between them have moved since, box [6]. x [3 spheres]: room */
template <class Give>
void BodySteps::step_clump(const ClumpPoses &poses, const Clumps &from, size_t c, const ClumpStep &goes,
                           const double *box, std::vector<double> &x, const Give &give) const
{
  const ClumpPoses::Clump &clump = poses.clumps()[c];
  const RigidClumps::OwnClump &body = poses.own_clump(clump);
  double row[COLUMNS], pose[12];
  copy<12>(from.all[c].pose, pose);
  x.resize(3 * (size_t) body.n);
  sd_pose_step(pose, goes.centre, goes.move, body.n, body.shape->shape.x, row + TURN, x.data());
  if (goes.place) copy<3>(pose + 9, goes.place);
  copy<4>(turned[body.atom], row + TURNED);
  sd_turn_quaternion(row + TURN, row + TURNED);
  for (int k = 0; k < body.n; k++) {
    const size_t m = poses.member_of(clump, k);
    double *there = &x[3 * (size_t) k];
    sd_minus(there, &from.x[3 * m], there);
    sd_add_edges(box, &from.edges[3 * m], there);
  }
  // Not at once: a processor waits when it reads in pairs what it has just written one by one.
  for (int k = 0; k < body.n; k++) {
    copy<3>(&x[3 * (size_t) k], row + STEP);
    give(poses.member_of(clump, k), row);
  }
}

void BodySteps::step_clumps(Hydrodynamics &hydro, const Clumps &from, const Step &step, Extent extent)
{
  const Lattice now = Lattice::of(domain);
  const bool directed = directions.on(), flat = domain->dimension == 2;
  std::vector<double> x;
  double box[6];
  for (int d = 0; d < 6; d++) box[d] = from.h[d] - now.h[d];
  const auto all = [&](const auto &give) {
    for (size_t c = 0; c < from.all.size(); c++)
      if (from.all[c].known != SD_BODY_HELD)
        step_clump(hydro.poses(), from, c, step(c), box, x, give);
  };
  hydro.scene.whole.scatter(COLUMNS, all, [&](int i, const double *row) {
    double *x_of = atom_row(atom->x, i);
    for (int d = 0; d < (flat ? 2 : 3); d++) x_of[d] += row[STEP + d];
    if (directed) directions.turn(i, row + TURN);
    if (extent == PART) return;
    note(i, row + STEP);
    hydro.turn(i, row + TURN);
    copy<4>(row + TURNED, turned.writable(i));
  });
}

// --- from where they stand -----------------------------------------------------------------------------------

void BodySteps::go(Hydrodynamics &hydro, const Step &of_clump)
{
  step_clumps(hydro, clumps_now(hydro), of_clump, WHOLE);
}

void BodySteps::follow_moved(const Hydrodynamics &hydro)
{
  if (!drives.moves_any() || !atom->omega_flag) return;
  for (int i : hydro.ambient.who()) {
    if (!drives.is_moved(i)) continue;
    directions.turn_moved(i, atom->omega[i], update->dt);
    if (!hydro.settings.rigid.on || atom->molecule[i] == 0) continue;
    double w[3], R[9];
    for (int d = 0; d < 3; d++) w[d] = update->dt * atom->omega[i][d];
    sd_rotation(w, R);
    sd_turn_quaternion(R, turned.writable(i));
  }
}

// --- from where they stood -----------------------------------------------------------------------------------

Places BodySteps::places(const Hydrodynamics &hydro) const
{
  Places x;
  x.atoms.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (int i : hydro.ambient.who()) std::copy_n(atom->x[i], 3, &x.atoms[3 * (size_t) i]);
  for (const ClumpPoses::Clump &clump : hydro.poses().clumps())
    x.clumps.insert(x.clumps.end(), clump.pose + 9, clump.pose + 12);
  return x;
}

void BodySteps::begin(const Hydrodynamics &hydro)
{
  const Ambient &ambient = hydro.ambient;
  began = {ambient.who(),        hydro.poses().lone(), places(hydro), box_of(domain),
           ambient.box_motion(), ambient.jumps() != nullptr};
  const Clumps now = clumps_now(hydro);
  kept = {now.all, now.x, now.edges, {}};
  std::copy_n(now.h, 6, kept.h);
  mu = directions.all();
}

void BodySteps::begin_where_put()
{
  found_at.atoms.resize(began.x.atoms.size());
  for (int i : began.who) {
    if (drives.is_moved(i)) continue;
    for (size_t d = 0; d < 3; d++) {
      double &from = began.x.atoms[3 * (size_t) i + d];
      found_at.atoms[3 * (size_t) i + d] += atom->x[i][d] - from;
      from = atom->x[i][d];
    }
  }
  mu = directions.all();
}

void BodySteps::return_to_start()
{
  for (int i : began.who) std::copy_n(&began.x.atoms[3 * (size_t) i], 3, atom->x[i]);
  directions.restore(mu);
}

void BodySteps::go(Hydrodynamics &hydro, const sd_step_in_box &in_box, const Places &there, const Moves &V,
                   Extent extent)
{
  static const double CENTROID[3] = {0.0, 0.0, 0.0};
  const auto moved = [&](bool stays, const double *v, const double *at, const double *from, double move[6]) {
    for (int d = 0; d < 6; d++) move[d] = in_box.t * v[d];
    if (!stays) sd_step_in_box_of(&in_box, v, at, from, move);
    keep_in_plane(move);
  };
  return_to_start();
  for (size_t i : began.lone) {
    const double *v = &V.atoms[6 * i], t = in_box.t, beyond_box[3] = {t * v[0], t * v[1], t * v[2]};
    double move[6];
    moved(drives.stays((int) i), v, &there.atoms[3 * i], &began.x.atoms[3 * i], move);
    step_lone((int) i, move, extent == WHOLE ? beyond_box : nullptr);
  }
  if (!hydro.settings.rigid.on) return;
  const auto step = [&](size_t c) {
    const ClumpPoses::Clump &clump = kept.all[c];
    ClumpStep s = {CENTROID, {}, nullptr};
    moved(clump.known == SD_BODY_PINNED, &V.clumps[6 * c], &there.clumps[3 * c], clump.pose + 9, s.move);
    return s;
  };
  step_clumps(hydro, kept.clumps(), step, extent);
}

void BodySteps::displace(Hydrodynamics &hydro, const Moves &W, double sign)
{
  sd_step_in_box jump = {};
  jump.t = sign;
  go(hydro, jump, began.x, W, PART);
}

void BodySteps::half_step(Hydrodynamics &hydro, const Moves &V)
{
  const double t = 0.5 * update->dt;
  half_way = sd_box_later(&began.box_motion.flow, &began.box, t);
  if (began.box_motion.deforms) put_box(domain, half_way);
  go(hydro, {t, began.carried, began.box, began.box, half_way, began.box_motion.flow}, began.x, V, PART);
}

void BodySteps::end_half_steps(const Hydrodynamics &hydro)
{
  found_at = places(hydro);
  if (began.box_motion.deforms) put_box(domain, began.box);
}

void BodySteps::whole_step(Hydrodynamics &hydro, const Moves &V)
{
  const Ambient &ambient = hydro.ambient;
  bring_box_to_this_step(lmp);
  const sd_step_in_box all = {update->dt,     ambient.jumps() != nullptr, began.box, half_way,
                              box_of(domain), ambient.box_motion().flow};
  go(hydro, all, found_at, V, WHOLE);
}

}    // namespace StokesDyn
