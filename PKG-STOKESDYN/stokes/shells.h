/* Spheres as shells of points (keyword multiblob): how the shell of each row stands, and its points,
 * for the scene's engine and for the bodies' loop. Points are made where they are used, from the
 * sphere's row. */
#ifndef SD_SHELLS_H
#define SD_SHELLS_H

#include "callback.h"
#include "keywords.h"
#include "pointers.h"

#include "sd_film.h"
#include "sd_multiblob_shape.h"
#include "sd_product.h"
#include "sd_squirmer.h"

#include <vector>

namespace StokesDyn {

class Shells : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    /* of each sphere; 1: spheres are points */
    int points = 1;
    bool one_body = true;
    bool on() const { return points > 1; }
  };
  const Settings &settings;

  Shells(const Voice &voice, const Settings &settings) :
      Pointers(voice.lmp), settings(settings), voice(voice)
  {
  }

  /* The settings are new. */
  void make();
  const sd_multiblob &model() const { return blob; }
  const sd_multiblob_shape &free_sphere() const { return lone; }
  const sd_squirmer &squirmer() const { return swimmer; }
  /* Its root, for noise. Error: memory. */
  void take_root();
  int points() const { return blob.n; }
  /* How far points reach from the centre of a unit sphere */
  double radius() const { return blob.radius; }
  double point() const { return blob.point; }

  /* n rows of this rank, all of them free; then those of clumps are turned. */
  void free_rows(int n);
  void turn_row(int k, const double turn[9], sd_multiblob_mask mask);
  /* Points of n spheres, rows and copies or a cloud, whose rows [10 n] are given as they are sent */
  void expand(int n, const std::vector<double> &rows, const sd_spheres &spheres);

  /* Points of rows and copies, or of the cloud */
  sd_spheres all() const { return {x.data(), b.data(), w.data()}; }
  /* Of this rank's rows: turn [9 n], mask [n]; as they are sent: [10 n], turn and mask */
  const double *turns() const { return turn.data(); }
  const sd_multiblob_mask *masks() const { return mask.data(); }
  std::vector<double> sent(int n) const;

  double memory_usage() const;

 private:
  const Voice voice;
  sd_multiblob blob = {};
  Owned<sd_multiblob_shape, sd_multiblob_shape_free> lone;
  sd_squirmer swimmer = {};
  std::vector<double> turn;
  std::vector<sd_multiblob_mask> mask;
  std::vector<double> x, b, w;
};

}    // namespace StokesDyn
#endif
