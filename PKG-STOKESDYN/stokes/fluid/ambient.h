/* The fluid as it would be without the spheres, and who feels it: read once a step, const
 * afterwards.
 *
 * Indices are those of LAMMPS's owned atoms. What is the same everywhere is not stored per atom:
 * each pass over this memory costs as much as the arithmetic. Viscosities are in the units in which
 * viscosity * length * velocity is a force, so that 6 pi eta a v needs no factor: LAMMPS's own are
 * force->vxmu2f of them (units real, metal, electron). */
#ifndef SD_AMBIENT_H
#define SD_AMBIENT_H

#include "deforming_box.h"
#include "epochs.h"
#include "field.h"
#include "flow_file.h"
#include "atom.h"
#include "pointers.h"

#include "sd_constants.h"
#include "sd_flow.h"

#include <algorithm>
#include <memory>
#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Region;
}

namespace StokesDyn {

class Ambient : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    Field visc, velocity[3], vorticity[3];
    bool has_vorticity = false;
    /* the velocity, or nullptr: that of the fields; the viscosity too? */
    std::shared_ptr<const FlowFile> grid;
    bool grid_has_visc = false;
    /* the velocity is that of the box, which fix deform changes */
    bool box = false;
    /* empty: the whole box */
    std::string region;
    std::string group = "all";

    bool rests() const
    {
      const auto is_0 = [](const Field &f) { return !f.is_variable() && f.number() == 0.0; };
      return !grid && !box && std::all_of(velocity, velocity + 3, is_0) &&
          (!has_vorticity || std::all_of(vorticity, vorticity + 3, is_0));
    }
  } &settings;

  Ambient(const Voice &voice, Epochs &epochs, Settings &settings) :
      Pointers(voice.lmp), settings(settings), voice(voice), epochs(epochs)
  {
  }

  /* Looks up variables, group and region. Errors: one that does not exist. */
  void init();
  /* Who takes part in this step, by group and region. Not for the middle of a step: nobody enters or
   * leaves there. */
  void select();
  /* The fluid of this step, or of its middle. spins: angular velocities count; derivatives of the fluid
   * velocity that are wanted beside its rotation; time: of this step, for a series; later: the box moves
   * as it will so many steps from now (all else is that of now).
   * Errors, on all ranks: a number that is none, an atom far outside of a periodic box or outside
   * of the grid, with atom and step; a time outside of the series. */
  enum Derivatives { NO_DERIVATIVES, FIRST, SECOND };
  void read(bool spins, Derivatives derivatives, double time, double later = 0.0);

  /* For steps that need the fluid in their middle, while LAMMPS's clock shows their end. look_ahead():
   * the last read() was for the start, and atoms stand there still; reads again, and keeps what time
   * has changed. half_a_step_back(): after a read() for the end, elsewhere; takes half of that change
   * back. So the error falls with the square of the step. Both are nothing where all are numbers.
   * Errors: those of read(). */
  void look_ahead(double time);
  void half_a_step_back();

  /* How much the fluid velocity of this step differs between atoms and their images an edge of the
   * box away, less what the box itself does, relative to the largest velocity: 0 fits a periodic
   * box. On all ranks together. */
  double misfit();

  /* The largest fluid velocity of this step along and across a plane x[axis] = at, at the feet of the
   * spheres on it, over the largest there and at the spheres: 0 where the fluid rests on it, for variables
   * and grids. Of values stored for atoms nothing is known there, and they count as 0. On all ranks
   * together. */
  void look_at_plane(int axis, double at, double of_largest[2]);

  /* By how much the fluid velocity grows from an atom to its images, in a box that fix deform
   * deforms: that of the image one edge away, for each edge, in the order of Lattice::h. So the
   * images move in a flow that deforms with the box. nullptr: the velocity has the period of the
   * box, or is no formula. */
  const double *jumps() const { return jumping ? jump : nullptr; }

  /* Before a run, since init(): [nlocal] who would take part where the atoms are now */
  std::vector<char> chosen_now();

  const std::vector<char> &active() const { return takes_part; }
  /* The atoms of this rank that take part, in their order. While Epochs::selection stands, nobody
   * need look at the others. */
  const std::vector<int> &who() const { return those; }

  double viscosity(int i) const { return eta.empty() ? eta_uniform : eta[i]; }
  const double *velocity(int i) const { return u.empty() ? u_uniform : &u[3 * (size_t) i]; }
  /* 6 pi eta a and 8 pi eta a^3 */
  double drag(int i) const { return 6.0 * SD_PI * viscosity(i) * atom->radius[i]; }
  double spin(int i) const
  {
    const double a = atom->radius[i];
    return 8.0 * SD_PI * viscosity(i) * a * a * a;
  }
  /* Of component d of a row: drag, or of those that turn spin */
  double resistance(int i, size_t d) const { return d < 3 ? drag(i) : spin(i); }
  /* Of the fluid: velocity [3], with spins angular velocity [3]. */
  void fluid(int i, double *s) const
  {
    const double *fluid_velocity = velocity(i);
    for (int d = 0; d < 3; d++) s[d] = fluid_velocity[d];
    for (int d = 0; d < 3 && spins; d++) s[3 + d] = w.empty() ? 0.0 : w[3 * (size_t) i + d];
  }
  /* The same less that of the sphere. */
  void slip(int i, double *s) const
  {
    fluid(i, s);
    for (int d = 0; d < 3; d++) s[d] -= atom->v[i][d];
    for (int d = 0; d < 3 && spins; d++) s[3 + d] -= atom->omega[i][d];
  }

  /* [nlocal][9] d u_p / d x_q; nullptr: not asked for, or the velocity is the same everywhere,
   * namely uniform_velocity(). */
  const double *gradients() const { return gradient.empty() ? nullptr : gradient.data(); }
  /* [nlocal][SD_FLOW_SECOND] second derivatives (sd_flow.h); nullptr: not asked for, or the velocity
   * is linear. 0 for a sphere at the edge of a grid, which has no velocity beyond. */
  const double *curvatures() const { return curvature.empty() ? nullptr : curvature.data(); }
  const double *uniform_velocity() const { return u_uniform; }

  /* Velocity u [3n] of the fluid at places x [3n], each rank has its own; read() has been called in
   * this step. On all ranks together. Formulas in x, y, z are asked of the atoms that take part, put
   * at these places one after the other. Errors: a velocity that belongs to atoms, not to places; a
   * place outside of the grid. */
  std::vector<double> at_places(const std::vector<double> &x);

  /* Does the fluid velocity differ from place to place? */
  bool varies() const;
  /* Of this step, for a velocity that varies, otherwise none: an image of a sphere moves as the
   * sphere does, and by the gradient times the shift between them. */
  const BoxMotion &box_motion() const { return motion; }

  /* Is all of it known without asking variables? Then these numbers say it: viscosity, velocity,
   * vorticity, which grid, and in a series the time that was read. */
  enum { NUMBERS = 9 };
  bool numbers_only() const;
  bool steady() const;
  void numbers(double *nine) const;
  double memory_usage() const;

 private:
  const Voice voice;
  Epochs &epochs;
  LAMMPS_NS::Region *region = nullptr;
  int igroup = 0, groupbit = 0;
  bool spins = false;
  /* that the last read() wanted */
  Derivatives wanted = NO_DERIVATIVES;

  std::vector<char> takes_part;
  /* of the group, and those of them that are in the region */
  std::vector<int> members, those;
  Stamp members_found;
  double jump[6] = {0.0};
  bool jumping = false;
  double now = 0.0, later = 0.0, eta_uniform = 0.0, u_uniform[3] = {0.0, 0.0, 0.0};
  BoxMotion motion;
  bool told_volume = false;
  /* per atom, or empty. w: half the vorticity */
  std::vector<double> eta, u, w, gradient, curvature;
  /* of look_ahead(): by how much values() have changed, or empty */
  std::vector<double> change;

  /* The places of all atoms, which others may take meanwhile: they are put back whatever happens. */
  class Places {
   public:
    explicit Places(LAMMPS_NS::Atom *atom) : atom(atom)
    {
      for (int i = 0; i < atom->nlocal; i++) x.insert(x.end(), atom->x[i], atom->x[i] + 3);
    }
    ~Places()
    {
      for (size_t i = 0; i < x.size() / 3; i++) std::copy_n(&x[3 * i], 3, atom->x[i]);
    }

   private:
    LAMMPS_NS::Atom *atom;
    std::vector<double> x;
  };

  class Carrier;
  void grid_at(const std::vector<double> &x, std::vector<double> &out) const;
  std::vector<double> formulas_at(const std::vector<double> &x);
  bool group_stands() const;
  void find_names();
  void fill_group();
  void read_fluid(Derivatives derivatives);
  std::vector<double> values() const;
  void check() const;
  std::vector<double> velocity_at(const double by[3], bool in_radii, int but = -1);
  std::vector<double> velocity_at(const std::function<void(int, double *)> &move, int but);
  void find_stored(const std::vector<double> &elsewhere, bool stored[3]) const;
  void growth_along(const double edge[3], const double expected[3], double sums[3], double most[2]);
  void find_jumps();
  void read_box(bool gradients);
  void read_gradient();
  void read_vorticity();
  void read_curvature();
  void read_grid();
  std::string outside_of_grid(const double *x) const;
  int fault(int i) const;
  [[noreturn]] void complain(long long first) const;
};

}    // namespace StokesDyn
#endif
