/* Spheres as shells of points (keyword multiblob): which shell each sphere has, how that of each row
 * stands, and its points, for the scene's engine and for the bodies' loop. Points are made where they are
 * used, from the sphere's row.
 *
 * All spheres have the same shell, unless the largest radius of a run is more than 1.5 times the smallest.
 * Then larger spheres have half shells of more points (sd_multiblob_half.h), so that points are about
 * equally fine everywhere: 42, 162 and 642 up to 2.5, 5 and 10 times the smallest radius. A small sphere
 * stands among the points of a large one otherwise, and feels these and not the sphere. */
#ifndef SD_SHELLS_H
#define SD_SHELLS_H

#include "callback.h"
#include "epochs.h"
#include "keywords.h"
#include "pointers.h"

#include "sd_multiblob_shape.h"
#include "sd_product.h"
#include "sd_squirmer.h"

#include <memory>
#include <vector>

namespace StokesDyn {

class Shells : protected LAMMPS_NS::Pointers {
 public:
  struct Settings {
    /* of the smallest spheres; 1: spheres are points. half: of half shells, whatever the radii are */
    int points = 1;
    bool half = false;
    /* of any sphere */
    int most = 642;
    bool one_body = true;
    bool on() const { return points > 1; }
    /* whatever their radii */
    bool alike() const { return most <= points; }
  };
  const Settings &settings;

  Shells(const Voice &voice, const Settings &settings) :
      Pointers(voice.lmp), settings(settings), voice(voice)
  {
  }

  /* Otherwise each sphere is a point. */
  bool on() const { return settings.on(); }
  /* The settings are new. */
  void make();

  // --- which sphere has which

  /* The radius from which the others are counted, and whether they are of unlike numbers: two numbers to
   * keep, so that the shells of a run stay what they are. 0, 0: nothing is known yet. */
  struct Classes {
    double smallest = 0.0, unlike = 0.0;
  };
  Classes classes;
  /* Once in a run, by all radii of those that take part; later it finds whether they still fit. Returns
   * whether the shells are others than before. Error: radii that are too different. */
  bool choose(double smallest, double largest, const Epoch &run);
  bool unlike() const { return classes.unlike != 0.0; }
  /* Then films are those of pairs of half shells, and of 12 points. */
  bool halves() const { return unlike() || settings.half; }

  /* Its shell, counted from that of the smallest spheres */
  int kind(double a) const;
  int kinds() const { return (int) models.size(); }
  const sd_multiblob *all_models() const { return models.data(); }
  const sd_multiblob &model(int kind) const { return models[kind]; }
  const sd_multiblob &model_of(double a) const { return models[kind(a)]; }
  const sd_multiblob_shape &free_sphere(int kind) const { return *lone[kind]; }
  const sd_faces_pattern *faces() const { return patterns.data(); }
  const sd_squirmer &squirmer(int kind) const { return swimmers[kind]; }
  /* How many points, how far they reach from the centre of a sphere, and their radius; also of one that is
   * itself its only point */
  int points(double a) const { return on() ? model_of(a).n : 1; }
  double extent(double a) const { return on() ? model_of(a).radius * a : 0.0; }
  double grain(double a) const { return on() ? model_of(a).point * a : a; }
  /* By how much sums over all points may be less accurate than those over spheres: the least of all shells */
  double looser() const;

  // --- the rows of this rank, and where their points begin

  /* n rows of this rank with these radii, all of them free; then those of clumps are turned. */
  void free_rows(int n, const double *a);
  void turn_row(int k, const double turn[9], const sd_multiblob_mask &mask);
  const double *turn_of(size_t k) const { return turn.empty() ? free_turn() : &turn[9 * k]; }
  sd_multiblob_mask mask_of(size_t k) const { return mask.empty() ? mask_of_free(k) : mask[k]; }
  const int *kinds_of_rows() const { return of_rows.kind.data(); }
  const int *first_of_rows() const { return of_rows.first.data(); }
  int points_of_row(size_t k) const { return of_rows.first[k + 1] - of_rows.first[k]; }
  sd_multiblob_spheres spheres(const sd_spheres &rows, int n) const
  {
    const bool free = turn.empty();
    return {rows.x, rows.a, free ? nullptr : turn.data(), free ? nullptr : mask.data(), n, kinds_of_rows(),
            first_of_rows()};
  }

  // --- the same of rows and copies, or of a cloud

  /* Turn and mask as they are sent: [sent_width() n] */
  int sent_width() const { return 9 + words; }
  std::vector<double> sent(int n) const;
  /* Points of n spheres whose rows are given as they are sent; none: all of them are free. Where they stand
   * is written to this room, which may be used for something else when nobody asks for it any more; nullptr:
   * to one of their own */
  void expand(int n, const std::vector<double> &rows, const sd_spheres &spheres, std::vector<double> *room);
  sd_spheres all() const { return {places, b.data(), w.data()}; }
  const std::vector<int> &first_of_all() const { return of_all.first; }
  /* Those of a sphere are a group; free spheres of one radius have one form, and turned ones none. */
  sd_groups groups() const { return {(int) forms.size(), of_all.first.data(), forms.data()}; }

  double memory_usage() const;

 private:
  const Voice voice;
  Stamp chosen, outgrown;
  std::vector<sd_multiblob> models;
  std::vector<std::unique_ptr<Owned<sd_multiblob_shape, sd_multiblob_shape_free>>> lone;
  std::vector<sd_faces_pattern> patterns;
  std::vector<sd_squirmer> swimmers;
  /* of a mask, when it is sent */
  int words = 1;
  /* [n] which shell, [n + 1] the first point */
  struct Places {
    std::vector<int> kind, first;
  } of_rows, of_all;
  std::vector<int> forms;
  /* of rows; empty: all of them are free */
  std::vector<double> turn;
  std::vector<sd_multiblob_mask> mask;
  std::vector<double> x, b, w;
  /* of the last expand(): in x, or in the room that was lent */
  const double *places = nullptr;

  /* Of models[0]: a restart file may say that spheres are unlike before these are made by radius. */
  bool smallest_is_half = false;

  void add_model(int n, bool half);
  void warn_of_alike(double largest) const;
  void warn_of_newcomers(double smallest, double largest, const Epoch &run);
  void find(int n, const double *a, Places &places) const;
  static const double *free_turn();
  sd_multiblob_mask mask_of_free(size_t k) const { return sd_multiblob_whole(&models[of_rows.kind[k]]); }
  void find_forms(const sd_multiblob_spheres &s);
};

}    // namespace StokesDyn
#endif
