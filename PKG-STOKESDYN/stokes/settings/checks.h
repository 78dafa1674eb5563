/* Settings that LAMMPS or the solver would do something foolish with, and what does not go with motion
 * without inertia. Free functions, each called with the name of the command that the user is told. */
#ifndef SD_CHECKS_H
#define SD_CHECKS_H

#include "pointers.h"

namespace StokesDyn {

class Engine;
class Scene;
class Voice;
struct StokesSettings;

/* The first call of BLAS in a process wants memory, and tries for ever where there is none. */
void check_room_of_blas(const Voice &voice);

/* LAMMPS makes ghosts up to its skin, which is a millimetre by default in units si: in a periodic box of
 * micrometres it would make them for hours. range: what LAMMPS takes for the cut-off; diameter: of the
 * largest sphere, for the way out */
void refuse_wide_skin(const Voice &voice, double range, double diameter);

/* A shear flow, say, does not fit a periodic box, unless that is sheared with it. */
void warn_of_misfit(const Voice &voice, double misfit);

/* Films of single points share what close pairs resist of their common motion, and resist it
 * against a fluid at rest: 5 % too much for 200 spheres that fall together, 26 % for 2000, whose
 * fluid falls with them. */
void warn_of_shared_films(const Voice &voice, double spheres);

/* Within a molecule there are no films: of spheres that all have one molecule ID nobody has any. */
void warn_of_one_molecule(const Voice &voice, const Scene &scene);

/* A cut-off that ends within a clump leaves out a part of it, and then its drag is too large: by 10
 * % for a chain of ten touching spheres that see each other up to 10.5 a. Tells of the clump with
 * the lowest molecule ID. */
void warn_of_short_cutoff(const Voice &voice, const Scene &scene, const Engine &engine);

/* Tensor oseen: some velocities would have an answer all the same where spheres are too close, and
 * none of them means anything. */
void refuse_close_oseen(const Voice &voice, const Scene &scene, const Engine &engine);

// --- motion without inertia: errors, that name the other command, and limits of the time step ----

/* The settings of the pair style, fix stokes_dynamics, the kind of run. On all ranks. */
void refuse_inertia(const Voice &voice, const StokesSettings &settings);

/* Once a run, when something besides the pair style acts on the spheres: how long a step contacts
 * and bonds allow. A contact of stiffness k relaxes at the rate lambda k/(6 pi eta a), lambda up to
 * 2.6 in dense packings, and a scheme is stable while that times the step is below 1 (ab2) or 2
 * (euler). smallest_drag: 6 pi eta a
 * Spheres in contact approach through a film of the smallest gap, xi radii, which resists by at
 * least 6 pi eta a/(4 xi). So N^-1 > (6 pi eta a/(4 xi k)) K with springs K along lines of centres,
 * and lambda is at most 4 xi, whatever the packing. film_gap: xi, 0: there are no films. Springs
 * across have the limit without. */
void announce_step_limit(const Voice &voice, bool euler, double smallest_drag, double film_gap);

/* LAMMPS sorts its atoms into bins of half the cut-off, which is small where a style has none. In
 * an open box that is mostly empty the bins would take most of the memory, or be too many: then
 * wider ones, about one for each atom. LAMMPS's own setting comes back with the end of this
 * object. */
class SortingBins : protected LAMMPS_NS::Pointers {
 public:
  explicit SortingBins(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}
  ~SortingBins();
  SortingBins(const SortingBins &) = delete;
  SortingBins &operator=(const SortingBins &) = delete;

  void limit(double range);    // what LAMMPS takes for the cut-off

 private:
  double ours = 0.0;    // the width that we have set, 0: none
};

}    // namespace StokesDyn
#endif
