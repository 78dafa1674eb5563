/* How bodies go in a step of fix stokes_dynamics/overdamped: lone spheres, and rigid clumps with all their
 * spheres, from where they stand, or stood when the step began. Directions turn with them. The rank that owns
 * a clump moves it, and its spheres wherever they are (whole_clumps.h). */
#ifndef SD_BODY_STEPS_H
#define SD_BODY_STEPS_H

#include "deforming_box.h"
#include "drives.h"
#include "hydrodynamics.h"
#include "rows_fix.h"

#include "domain.h"

#include <functional>
#include <vector>

namespace StokesDyn {

/* Of atoms, [3 nlocal], and of the centroids of the clumps of this rank, [3 clumps] */
struct Places {
  std::vector<double> atoms, clumps;
};

class BodySteps : protected LAMMPS_NS::Pointers {
 public:
  /* turned [4]: the quaternion by which the clump of a sphere has turned since the fix was given */
  BodySteps(LAMMPS_NS::LAMMPS *lmp, const Drives &drives, Directions &directions, AtomArray &turned) :
      Pointers(lmp), drives(drives), directions(directions), turned(turned)
  {
  }

  /* In two dimensions nobody leaves the plane, or turns but about its normal. V: velocity and angular
   * velocity; or a move. */
  void keep_in_plane(double V[6]) const
  {
    for (int d = 2; d < 5 && domain->dimension == 2; d++) V[d] = 0.0;
  }

  /* Is there anything but clumps that turns? Then what a solve has found of atom i: its angular velocity, and
   * that again, nullptr: it has no direction */
  bool turns() const { return directions.on(); }
  void note_found(int i, const double W[3]) { directions.note_found(i, W); }
  const double *spin(int i) const { return directions.on() ? directions.turning[i] : nullptr; }

  // --- from where they stand

  /* A sphere that is in no clump: a displacement and a turn, move [6] */
  void go(int i, const double move[6]) { step_lone(i, move, move); }
  /* A displacement and a turn, move [6], of a point at centre [3] in the axes of the shape; place [3]:
   * where the centroid is put, for whoever wants that, else nullptr */
  struct ClumpStep {
    const double *centre;
    double move[6], *place;
  };
  using Step = std::function<ClumpStep(size_t c)>;
  void go(Hydrodynamics &, const Step &of_clump);
  /* Those of fix move have gone by now: directions and clumps turn as it says. */
  void follow_moved(const Hydrodynamics &);

  // --- from where they stood when the step began; nobody migrates in between

  /* Who takes part, and who of them are in no clump; places, directions; the box, how it moves, and does the
   * flow take it along? */
  struct Start {
    std::vector<int> who, lone;
    Places x;
    sd_box box;
    BoxMotion box_motion;
    bool carried;
  };
  void begin(const Hydrodynamics &);
  /* Others have moved or turned those who take part since: a barostat, fix recenter, fix set. The step begins
   * where they stand now. */
  void begin_where_put();
  const Start &start() const { return began; }
  /* All but those of fix move stand there again. */
  void return_to_start();
  /* By W times a sign, in the box that stands */
  void displace(Hydrodynamics &, const Moves &W, double sign);
  /* Half the step by velocities V of its start, in the box of its middle, which is LAMMPS's until
   * end_half_steps() */
  void half_step(Hydrodynamics &, const Moves &V);
  /* The velocities of the step are those of where bodies stand now. */
  void end_half_steps(const Hydrodynamics &);
  /* All of it, by these, in the box of its end */
  void whole_step(Hydrodynamics &, const Moves &V);

  /* In whole steps since rest(): the square of the largest displacement over radius, of this rank */
  double farthest() const { return displaced; }
  void rest() { displaced = 0.0; }

 private:
  const Drives &drives;
  Directions &directions;
  AtomArray &turned;
  double displaced = 0.0;

  Start began;
  /* the middle of the step: where velocities are found, and its box */
  Places found_at;
  sd_box half_way = {};
  std::vector<double> mu;
  /* Clumps, their spheres x [3 members] side by side, each so many edges h [6] of the box away from its
   * atom: all as in WholeClumps, where they stand now; or kept, to go from there later */
  struct Clumps {
    const std::vector<ClumpPoses::Clump> &all;
    const std::vector<double> &x;
    const std::vector<int> &edges;
    const double *h;
  };
  struct KeptClumps {
    std::vector<ClumpPoses::Clump> all;
    std::vector<double> x;
    std::vector<int> edges;
    double h[6];
    Clumps clumps() const { return {all, x, edges, h}; }
  } kept;

  /* what an owner sends to a member: by how much it moves and turns, and the quaternion of its clump when
   * this is a whole step */
  enum { STEP, TURN = STEP + 3, TURNED = TURN + 9, COLUMNS = TURNED + 4 };

  enum Extent { PART, WHOLE };
  static Clumps clumps_now(const Hydrodynamics &);
  Places places(const Hydrodynamics &) const;
  void go(Hydrodynamics &, const sd_step_in_box &in_box, const Places &there, const Moves &V,
          Extent extent);
  template <class Give>
  void step_clump(const ClumpPoses &, const Clumps &from, size_t c, const ClumpStep &goes, const double *box,
                  std::vector<double> &x, const Give &give) const;
  void step_clumps(Hydrodynamics &, const Clumps &from, const Step &step, Extent extent);
  void step_lone(int i, const double *move, const double *beyond_box);
  void note(int i, const double *step);
};

}    // namespace StokesDyn
#endif
