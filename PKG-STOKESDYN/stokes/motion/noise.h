/* Brownian motion for fix stokes_dynamics/overdamped: the random part of a step of all spheres and
 * lone clumps, with the mobility that velocities follow from, or a random slip of all points.
 *
 *   step = sqrt(2 kT dt) y,     y of covariance M           where the mobility has no drift
 *   slip = sqrt(2 kT/dt) y,     y of covariance M'          scheme midpoint (solve_noise.h)
 *
 * Numbers are drawn where velocities are found, at the positions of that moment, and depend on atom
 * IDs, the step and the seed alone: nothing is kept for restarts, and a second setup draws the
 * same. */
#ifndef SD_STOKES_NOISE_H
#define SD_STOKES_NOISE_H

#include "field.h"
#include "pointers.h"
#include "solve_noise.h"

#include "sd_noise_spheres.h"
#include "sd_random.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace StokesDyn {

class Hydrodynamics;

class Noise : protected LAMMPS_NS::Pointers {
 public:
  explicit Noise(const Voice &voice) : Pointers(voice.lmp), voice(voice) {}

  /* The values of keywords temperature and noise_tolerance */
  void read_temperature(Keywords &in);
  void read_tolerance(Keywords &in);
  /* Is there a temperature that is not always 0? Otherwise none of the rest is called. */
  bool on() const { return temperature.is_variable() || temperature.number() > 0.0; }

  /* What else the fix does. midpoint: steps that have the drift of the mobility (how_to_draw(), below);
   * holds: the keyword that holds somebody, or nothing */
  struct Ways {
    bool adapts, midpoint;
    std::string holds;
  };
  /* What makes a drift, as errors name it; empty: nothing does, and ab2 and euler are right */
  std::string drift(const Hydrodynamics &hydro, const std::string &holds) const;
  /* Before a run: the variable, and how sums over images are split. Errors: a variable that is none,
   * and whatever has a drift that is left out or no noise: settings of the pair style, other
   * commands. */
  void init(Hydrodynamics &hydro, const Ways &ways);

  /* y [width] of the free spheres to take(i, y), with width 6 of their turn as well, where the model has
   * torques; [6] of the clumps of this rank are kept, U of their centre of mobility and W. The
   * velocities of this step have been found. Errors: a temperature below 0; a
   * mobility without a root. */
  using ToAtom = std::function<void(int i, const double *y)>;
  void draw(Hydrodynamics &hydro, size_t width, const ToAtom &take);
  /* For the solve of this step, in scheme midpoint. Errors as of draw(). */
  SolveNoise::Draw how_to_draw(const Hydrodynamics &hydro);
  /* To which that solve is made: slow modes of velocities are off by less than those of the root */
  double tolerance_of_solve() const { return tolerance / 3.0; }
  /* sqrt(2 kT dt) for a step dt from there */
  double scale(double dt) const;
  /* kT of this step */
  double energy() const { return kT; }
  const double *of_clump(size_t c) const { return &of_clumps[6 * c]; }

  /* Once: what has been drawn, and how far it moves the smallest sphere, 1/drag its mobility */
  void announce(const Hydrodynamics &hydro, double smallest, double drag) const;
  /* last_step: for which numbers were drawn before this fix was given, by a restart file; below 0: none */
  void begin(double last_step);
  /* A step begins. Once: have its random numbers been drawn before? */
  void warn_of_repeats();
  /* Of the last root: products with M (its near part, where the sum is split), e of sd_noise.h */
  const sd_noise_report &report() const { return last; }

 private:
  const Voice voice;
  Field temperature;
  uint32_t seed = 0;
  double tolerance = 0.01;

  /* of this step */
  double kT = 0.0;
  Owned<sd_noise, sd_noise_free> process;
  Owned<sd_bodies_noise, sd_bodies_noise_free> of_bodies;
  sd_noise_report last = {};
  std::vector<double> of_clumps;
  /* by rows, width numbers each; and as many as the engine's rows have */
  std::vector<double> D, w, y, engine_F, engine_u;
  /* by a matrix in two parts (sd_mobility.h) */
  bool divided = false;
  /* the last step for which numbers were drawn; NAN: no run has begun */
  double drawn = NAN;
  /* noise is a slip; a part that should be positive was not, and the user knows */
  bool midpoint = false, told_of_whole = false, told_of_repeats = false;

  sd_random_key key(sd_random_purpose what) const;
  void refuse(const Hydrodynamics &hydro, const Ways &ways) const;
  void find_temperature(const Hydrodynamics &hydro);
  [[noreturn]] void no_root(sd_status status) const;
  void draw_alone(const Hydrodynamics &hydro, size_t width, const ToAtom &take);
  sd_noise_spheres find_spheres(Hydrodynamics &hydro, size_t width);
  void draw_together(Hydrodynamics &hydro, size_t width, const ToAtom &take);
};

}    // namespace StokesDyn
#endif
