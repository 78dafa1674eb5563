/* fix hydro/vans: a one-dimensional turbulent stream over a granular bed. See doc/fix_hydro_vans.md.
 * The arithmetic is in core/vans; the stream with its profiles in vans_stream; here: atoms, ranks, time. */
#ifndef SD_FIX_HYDRO_VANS_H
#define SD_FIX_HYDRO_VANS_H

#include "fix.h"

#include "vans_stream.h"

#include <memory>

namespace LAMMPS_NS {
class Region;
}

namespace StokesDyn {

class FixHydroVans : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "hydro/vans";

  FixHydroVans(LAMMPS_NS::LAMMPS *, int, char **);
  ~FixHydroVans() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  void end_of_step() override;
  void post_run() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  int modify_param(int, char **) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return OUTPUTS + columns + 1; }
  int maxsize_restart() override { return OUTPUTS + columns + 1; }
  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  VansSettings set;
  std::unique_ptr<VansStream> stream;
  LAMMPS_NS::Region *region = nullptr;
  int average_bit = 1;

  /* Columns of the global array, before those of the classes. */
  enum {
    Z,
    VELOCITY,
    PHI,
    GRAIN_X,
    GRAIN_Y,
    GRAIN_Z,
    DRAG_PER_GRAIN,
    EXCHANGE,
    EDDY_VISCOSITY,
    STRESS,
    ARRAY_COLUMNS
  };

  /* Entries of the global vector. */
  enum {
    FORCE_X,
    FORCE_Y,
    FORCE_Z,
    TRANSPORT,
    FRICTION_VELOCITY,
    LARGEST_STRESS,
    OUTSIDE,
    SHIELDS,
    TOTAL_DRAG,
    BED,
    MOMENTUM,
    TRANSIT,
    DRIVING,
    BOTTOM,
    WALLS,
    SURFACE,
    OTHERS,
    VECTOR_SIZE
  };

  /* Per atom. array_atom: force and velocity fluctuation. memo: what must follow the atom besides; a column that no
   * keyword asks for is not there. */
  enum { OUTPUTS = 6, SOLVED = 0, LEFT_X = 1, LEFT_V = 4, LEFT_A = 7, ALWAYS = 8 };
  int columns = ALWAYS, drag_column = -1, weight_column = -1, eddy_column = -1;
  enum {
    DRAG = 0,
    IMPULSE = 1,
    SHEAR = 2,
    PAST = 3,
    FORESEEN = 4,
    MOMENTUM_COLUMNS = 5
  };                               // from drag_column on; PAST: SHEAR before the last coupling
  enum { LIFE = 0, COUNT = 1 };    // from eddy_column on: fluctuation
  double **memo = nullptr;

  /* The same on all ranks and in the restart file. */
  LAMMPS_NS::bigint last_step = -1;            // of the forces in array_atom
  double elapsed = 0.0;                        // since the last coupling
  double eddy_age = 0.0, eddy_period = 0.0;    // random walk of all grains at once
  double renewals = 0.0;
  double mean_radius = 0.0, mean_density = 0.0;
  LAMMPS_NS::bigint weights_of = -1;    // number of atoms when the overlaps were counted

  /* Of the last step. */
  double local[5] = {0, 0, 0, 0, 0},
         global[5];    // force x y z, drag along x, spheres outside; of this rank, of all
  LAMMPS_NS::bigint summed_step = -1;
  bool told_outside = false;

  std::vector<unsigned char> take;
  std::vector<double> F, drag_x, u, weight, work;

  bool has_grains() const { return set.couple != VansSettings::FLUID; }
  double area() const;
  void select(int bit, bool not_in_group = false);
  const double *fluctuations();
  const double *weights();
  bool left_as_is(int i) const;
  void record(int i);
  void find_classes();
  void count_overlaps();
  void average();
  void couple();
  VansStream::Given impulses(double T, double ratio);
  void renew_fluctuations(double time, bool first);
  void sum_up();
};

}    // namespace StokesDyn
#endif
