/* fix hydro/vans: a one-dimensional turbulent stream over a granular bed. See
 * doc/fix_hydro_vans.md. The arithmetic is in core/vans; the stream with its profiles in
 * vans_stream; here: atoms, ranks, time. */
#ifndef SD_FIX_HYDRO_VANS_H
#define SD_FIX_HYDRO_VANS_H

#include "clump_overlaps.h"
#include "neighbours.h"
#include "resume.h"
#include "rows_fix.h"
#include "vans_fluctuations.h"
#include "vans_stream.h"

namespace LAMMPS_NS {
class Region;
}

namespace StokesDyn {

class FixHydroVans : public RowsFix {
 public:
  static constexpr const char *STYLE = "hydro/vans";

  FixHydroVans(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  void end_of_step() override;
  void post_run() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  /* fix_modify: profile, given, average, solve */
  int modify_param(int, char **) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

 private:
  VansSettings set;
  VansStream stream;
  LAMMPS_NS::Region *region = nullptr;
  int average_bit = 1;

  /* Columns of the global array, before those of the classes. */
  enum { Z, VELOCITY, PHI, GRAIN_X, GRAIN_Y, GRAIN_Z, DRAG_PER_GRAIN, EXCHANGE, EDDY_VISCOSITY,
         STRESS, ARRAY_COLUMNS };
  /* Entries of the global vector. */
  enum { FORCE_X, FORCE_Y, FORCE_Z, TRANSPORT, FRICTION_VELOCITY, LARGEST_STRESS, OUTSIDE, SHIELDS,
         TOTAL_DRAG, BED, MOMENTUM, TRANSIT, DRIVING, BOTTOM, WALLS, SURFACE, OTHERS, DISCHARGE,
         DRIVE, ELEVATION, VOLUME, MEAN_TRANSPORT, TRANSPORT_ERROR, MEAN_STRESS, STRESS_ERROR,
         WALL_SHARE, PRESSED, VECTOR_SIZE };
  /* And of each class, behind them. */
  enum { CLASS_RADIUS, CLASS_HEIGHT, CLASS_TRANSPORT, CLASS_NUMBERS };

  /* Per atom: force and velocity fluctuation; memo: what must follow the atom besides, a column
   * that no keyword asks for is not there. LOST: share of its volume that is another's too. */
  enum { FORCE = 0, FLUCTUATION = 3, OUTPUTS = 6 };
  AtomArray out;
  Resume resume;
  struct Columns {
    enum { SOLVED = 0, LEFT = 1 };
    int account = -1, lost = -1, eddy = -1, motion = -1, all = LEFT;
    Columns(const VansSettings &set, const Resume &resume);
  } column;
  AtomRows memo;
  sd_vans_account *account(int i) { return (sd_vans_account *) (memo.writable(i) + column.account); }

  /* The same on all ranks and in the restart file; last_step: of the forces in array_atom; elapsed:
   * since the last coupling. */
  LAMMPS_NS::bigint last_step = -1;
  double elapsed = 0.0;
  /* what the last solve had for all grains; not finite: not known, from older restart files */
  double handed = 0.0;
  VansFluctuations fluctuations;
  struct {
    double radius = 0.0, density = 0.0;
  } mean;
  std::vector<SavedNumbers> saved() override;
  void write_state(NamedState &) override;
  void read_state(const NamedState &) override;

  /* Of the last step, of this rank and of all: force x y z, drag along x, spheres outside; force of
   * the pressure gradient, and its impulse since the first step. */
  struct Sums {
    double force[3] = {0, 0, 0}, drag = 0, outside = 0, pressure = 0, pressed = 0;
  } local, global;
  LAMMPS_NS::bigint summed_step = -1;
  /* have they been read, in this run or in one whose restart file has them? */
  bool variables_known = false;
  Neighbourhood neighbourhood;
  /* of the last look at the grains' time step */
  LAMMPS_NS::bigint looked_step = -1;

  ClumpOverlaps overlaps;
  std::vector<unsigned char> take;
  std::vector<double> F, drag_x, u, weight, work, acceleration;

  double area() const;
  void check_box() const;
  void check_radius();
  void check_others() const;
  void look_at_neighbours();
  void look_at_gravity() const;
  void tell_fall();
  double phi_at_surface();
  void check_mesh();
  void tell_steps();
  void tell_roughness();
  void tell_smooth();
  void tell_lid();
  void tell_overlap();
  void tell_weight();
  std::vector<double> masses_that_move() const;
  void tell_stiff();
  void tell_sizes();
  void tell_waves();
  void find_classes();
  void find_bins(int n, int average);
  std::vector<double> different_radii(int average) const;
  double of_class(int c, int number) const;
  void find_region();
  void find_names();

  void select(int bit, bool not_in_group = false);
  sd_vans_grains grains();
  int forces(const sd_vans_grains &all, bool accelerated = false);
  /* What a call of post_force is: a step after the last one, the step once more with which a run begins where
   * another ended and whose force stands, or neither */
  enum Moment { ANEW, STEP, AGAIN };
  void push(int i, Moment moment);
  void check_forces() const;
  void sum_up();
  void tell_outside();

  bool variables_matter() const;
  void take_gravity();
  void read_variables();
  void take_variables(const std::vector<double> &last);
  void feel_pressure();
  void press(Moment moment, const Sums &before);
  void find_accelerations(Moment moment);
  void average();
  void couple(double T, double dt);
  void end_interval();
  void solve_on_demand(double T, double dt);
  VansStream::Given impulses(double ratio);
  double due(int i, double T, double ratio);
  void hand_over(double T, double ratio);
  void renew_fluctuations(double time, bool first);
  void count_overlaps();

  double steady(int k) const;
  /* What keywords give as numbers or variables of equal style, where the values go, their limits */
  struct Given {
    Field &field;
    double &value;
    double least;
    const char *keyword, *part;
  };
  std::vector<Given> givens();
  void modify_profile(Keywords &in, const Voice &what);

  void record(int i) override;
};

}    // namespace StokesDyn
#endif
