/* What fix sph/inlet and sph/outlet have in common: open ends of a flow. Beyond a plane stands a layer of
 * particles that are not moved by forces; one layer sends new ones, the other takes those that come. */
#ifndef SD_FIX_SPH_OPENING_H
#define SD_FIX_SPH_OPENING_H

#include "sd_sph_opening.h"
#include "sph.h"

#include <array>
#include <functional>
#include <vector>

namespace StokesDyn {

class FixSphOpening : public SphFix {
 public:
  FixSphOpening(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  double compute_scalar() override;

  /* Of a particle of the group at x: does it stand in the layer? */
  bool holds(const double *x) const { return beyond(x) > 0.0 && reaches(x); }
  bool is_held(int i) const { return is_beyond(i) && reaches(atom->x[i]); }
  /* Has the layer a pressure that is given to it? */
  virtual bool gives_pressure() const = 0;
  /* That of this step; all ranks. Then that of particle i, in the layer. */
  void find_pressures();
  double pressure_of(int i) const { return pressures[i]; }

 protected:
  std::vector<SavedNumbers> saved() override { return {{"passed", &passed, 1, true}}; }
  /* the words FACE POSITION WIDTH, which come first */
  Keywords parse_place(int narg, char **arg);
  double beyond(const double *x) const { return side * (x[axis] - plane); }
  /* Is particle i one of the group beyond the plane? */
  bool is_beyond(int i) const { return (atom->mask[i] & groupbit) && beyond(atom->x[i]) > 0.0; }
  /* Of a place beyond the plane: does the layer go so far across? */
  virtual bool reaches(const double *) const { return true; }

  /* 0 1 2; 1: the layer is at the upper end of the flow, -1: at the lower one */
  int axis = 0, side = 1;
  double plane = 0.0, width = 0.0;
  /* mass that has passed, of this rank */
  double passed = 0.0;
  Field pressure;
  /* the flow turns against the opening, which has been said */
  bool told = false;
  void tell_of_backflow(const std::string &what);
  /* The flow before the layer, within 2 h of the plane; all ranks. Then its speed out of the layer, across
   * from place x, and how the flow goes as a whole. */
  void look_at_flow();
  double speed_before(const double *x, double otherwise) const;
  double whole_flow() const;
  /* Masses and momenta at the nodes of the section; all ranks. place: of a particle of the group, nullptr
   * if it does not count. Then the mass across from place x. */
  std::vector<double> over_section(const std::function<const double *(int)> &place);
  double mass_over(const std::vector<double> &sums, const double *x) const;

 private:
  /* the layer hides the empty space beyond it, and the fluid is not behind it */
  void check_width();
  void check_side() const;
  sd_sph_section section = {};
  std::vector<double> flow;
  double largest_h() const;
  std::array<double, 2> across(const double *x) const;
  std::vector<double> pressures;
};

}    // namespace StokesDyn
#endif
