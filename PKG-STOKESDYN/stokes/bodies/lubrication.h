/* Lubrication between the spheres of a step (sd_lubrication.h), and between them and a wall
 * (sd_wall_film.h, sd_multiblob_wall.h): LAMMPS's atoms to the core.
 *
 * Films have a halo of their own, since with noise they stand elsewhere than the engine's points
 * (hydrodynamics_noise.cpp); what it holds is as the rows stood in place(). */
#ifndef SD_STOKES_LUBRICATION_H
#define SD_STOKES_LUBRICATION_H

#include "callback.h"
#include "halo.h"
#include "pointers.h"
#include "shells.h"

#include "sd_lubrication.h"
#include "sd_random.h"

#include <array>
#include <memory>
#include <vector>

namespace StokesDyn {

class Ambient;
class Scene;

class Lubrication : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    bool on = false;
    /* over the mean radius of a pair: the floor of gaps, and where it ends */
    double gap = 1e-3, range = 2.0;
  };
  const Settings &settings;

  /* Where spheres are shells of points, films are of what these do not know. */
  Lubrication(const Voice &voice, const Settings &settings, const Shells &shells) :
      Pointers(voice.lmp), settings(settings), voice(voice), shells(shells), halo(world)
  {
  }

  /* The rows of the scene where they stand now, and copies around them, in the fluid of this step (nullptr:
   * it and the box rest), on all ranks. noisy: random forces will be drawn. Error: radii that are too
   * different. */
  void place(const Scene &scene, const Ambient *fluid, bool noisy = false);
  /* The same spheres at x [3 n], in a fluid and a box that rest, without walls */
  void place_at(const Scene &scene, const std::vector<double> &x);
  /* Since then */
  sd_lubrication *matrix() { return &near; }
  /* [copies] as sd_tied.h has it */
  const double *those_above() const { return above.data(); }
  /* out [6 n]: forces and torques on the spheres that move with v, by rows */
  void forces(const double *v, double *out);

  /* F [6 n] += random forces on the spheres, of covariance L, where they were placed so; on all
   * ranks together. SD_OK or that of sd_lubrication_noise.h */
  sd_status draw(const Scene &scene, const sd_random_key &key, double *F) const;

  double memory_usage() const;

 private:
  const Voice voice;
  const Shells &shells;
  Owned<sd_lubrication, sd_lubrication_free> near;
  std::unique_ptr<sd_two_sphere, void (*)(sd_two_sphere *)> functions{nullptr, sd_two_sphere_free};
  double largest_ratio = 0.0;
  /* of shells of so many points, with the addition, by radius */
  sd_films films = {};
  std::array<int, 3> kind_of_films = {};
  std::vector<double> u;
  std::vector<int> points;
  /* rows, then copies; velocities of the copies beyond those of their spheres; which are above */
  Halo halo;
  std::vector<double> x, a, w, drift, above;

  void surround(const Scene &where, const double *places);
  void place_films(const Scene &where, const Ambient *fluid, bool noisy);
  void add_wall(const Scene &where, const sd_wall &wall);
  void provide(double largest, double smallest);
  void check(sd_status status) const;
};

}    // namespace StokesDyn
#endif
