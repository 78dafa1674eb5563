/* Internal fix: the memory of pair_style stokes_dynamics, what must follow its atom through
 * migration, sorting and restart.
 *
 * Each sphere that takes part has a row with F and v' of the last step and solve, and one with what
 * F depends on as a run or a restart file left it; others have none. When a run begins exactly
 * where the last one ended, the force of that step still stands (common/resume.h), and the run goes
 * on as if it had never been broken. */
#ifndef SD_FIX_STOKES_DYNAMICS_STATE_H
#define SD_FIX_STOKES_DYNAMICS_STATE_H

#include "ambient.h"
#include "resume.h"
#include "rows_fix.h"
#include "shells.h"
#include "time_step_guard.h"

#include "sd_preconditioner.h"

#include <cstdint>
#include <vector>

namespace StokesDyn {

struct StokesSettings;

class FixStokesDynamicsState : public RowsFix {
 public:
  static constexpr const char *STYLE = "STOKES_DYNAMICS/STATE";
  static constexpr const char *ID = "STOKES_DYNAMICS_STATE";

  /* The one of this LAMMPS, nullptr if there is none. Error: a fix of the user's has its ID. */
  static FixStokesDynamicsState *find(LAMMPS_NS::LAMMPS *lmp);
  /* The same, made anew unless it is of this kind. */
  static FixStokesDynamicsState *provide(LAMMPS_NS::LAMMPS *lmp, const StokesSettings &settings);
  /* If it is there; in destructors */
  static void take_away(LAMMPS_NS::LAMMPS *lmp);

  FixStokesDynamicsState(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void setup_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  void pre_reverse(int, int vflag) override;
  void post_run() override;

  /* Columns of a row. Behind them v' (and w') of the solve before the last one, where history is kept, and
   * force (and torque) of that, where lines are: spheres are points, and guesses on a line through two
   * answers. */
  enum { FORCE = 0, VPRIME = 3, TORQUE = 6, WPRIME = 9 };
  /* Place in a row of component d of the six that begin with FORCE or VPRIME */
  static size_t at(int first, size_t d) { return first + (d < 3 ? d : d + 3); }
  const bool rotation, history, lines;
  int width() const { return rotation ? 6 : 3; }
  int before() const { return 2 * width(); }
  int forces_before() const { return before() + (history ? width() : 0); }
  /* of each sphere, whose forces on the fluid are behind that, in the axes of its shell: 3 columns each;
   * 0: none. Then those of the solve before, and the velocities that went with them; of points, these are
   * in the place of v' before */
  const int shell_points;
  /* of any sphere: those of larger spheres, of another shell, have rows of their own, of their points and
   * those before */
  const int most_points;
  template <class T> struct OfPoints {
    T *now, *before;
  };
  /* Of atom i, whose shell has so many points and is the kind-th of Shells; to write, and to read: nullptr
   * where there are none */
  OfPoints<double> writable_points(int i, int kind, int n);
  OfPoints<const double> points_of(int i, int kind, int n) const;
  int of_points() const { return forces_before() + (lines ? width() : 0); }
  int of_points_before() const { return of_points() + 3 * shell_points; }
  int velocities_before() const { return shell_points > 0 ? of_points() + 6 * shell_points : before(); }
  AtomRows rows;
  /* Atom i has none of them. */
  void erase(int i);
  /* Where the preconditioner, or the factor of films, was made (preconditioner.h, films_factor.h): of these
   * atoms, at their places of then; and what else it was of, global.made_of */
  void made_here(const std::vector<int> &who, const std::vector<double> &of);
  /* d [3] from there to where atom i is, to the nearest image; and how far these all have moved since, as
   * sd_moved_add sums it, on all ranks together. false: one of them was not there */
  AtomRows made_at;
  void from_made(int i, double d[3]) const;
  bool moved_since_made(const std::vector<int> &who, double sums[SD_MOVED]) const;
  /* are clumps rigid? Then a restart file says how many atoms each molecule has */
  bool rigid = false;

  /* The same on all ranks. A step of -1: never. */
  struct Global {
    /* time step of the forces, and of v' */
    double last_step = -1, last_solve = -1;
    /* were the rows made for a fix that reports v'? */
    double reported = 0;
    /* that took part then */
    double spheres = 0;
    /* of the fluid in the last step (Ambient::numbers) */
    double numbers[Ambient::NUMBERS] = {0};
    double solves = 0, unconverged = 0;
    /* has algorithm 1, so that 2 goes on? */
    double diverged = 0;
    /* of the last solve */
    double iterations = 0, residual = 0;
    /* time of the runs before the restart file that LAMMPS's own clock does not count */
    double time_before = 0;
    /* answers that the rows hold, of solves that follow one another: 0, 1, 2; and what these were asked, a
     * number of Guess; 0: nothing that others begin from */
    double solutions = 0;
    uint64_t guess = 0;
    /* forces of points in the last solve: were they nearer to the line through the two before it
     * than to the last of these? Where no line is kept, 0 */
    double line = 0;
    /* periodic lengths and tilts as the last run left them */
    double box[6] = {0};
    /* which shells the spheres have */
    Shells::Classes shells;
    /* hash of the words of the pair_style command */
    uint64_t settings = 0;
    /* kept for those who know what they mean */
    TimeStepGuard::State guard;
    std::vector<double> made_of, loose, open_box;
    /* as a restart file says, until a run has looked (RigidClumps::set_members) */
    std::vector<double> members;
  } global;

  /* In steps with a virial: the sum of the torques of pair styles, bonds and kspace, this one's too, on the
   * atoms of this rank and on the copies that it has of others' */
  const double *torque_of_pairs() const { return of_pairs; }

  /* Of this step, since the first run: it goes on after a restart. */
  double time() const;
  /* If they are new: nothing of the past stands. */
  void settings_are(const std::vector<std::string> &words);
  bool box_left_as_is() const;
  bool placed_as_left(int i) const { return resume.placed(i, left[i]); }
  bool moving_as_left(int i) const { return resume.moving(i, left[i]); }

 private:
  AtomRows larger[3];
  double of_pairs[3] = {0.0};
  Resume resume;
  AtomRows left;

  bool has_larger() const { return shell_points > 0 && most_points > shell_points; }
  std::vector<double> of_larger_spheres() const;
  std::vector<double> members_now() const;
  void set_larger_spheres(const std::vector<double> &all);
  void forget();
  void record(int i) override;
  std::vector<SavedNumbers> saved() override;
  void write_state(NamedState &) override;
  void read_state(const NamedState &) override;
  /* Rows of another length: the pair style has been given with or without rotation since. */
  bool restored() const override { return global.last_step >= 0; }
  void another_in_file(int i) override { set_arrays(i); }
  void present_box(double *box) const;
};

}    // namespace StokesDyn
#endif
