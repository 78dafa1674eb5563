/* How everybody sees everybody (keyword far_field): by all pairs, or by Ewald sums, in which box these are
 * and how they are split. In an open box the next split depends on the last one's box. */
#ifndef SD_FAR_FIELD_H
#define SD_FAR_FIELD_H

#include "pointers.h"
#include "scene.h"
#include "shells.h"

#include "sd_mobility.h"

#include <string>
#include <vector>

namespace StokesDyn {

class FarField : protected LAMMPS_NS::Pointers {
 public:
  FarField(const Voice &voice, const Scene &, const Shells &);

  /* periodic sums are split into two positive parts, for noise: sd_ewald_choose_positive; 0: not so */
  double positive = 0.0;

  /* The engine for the scene and its shells as they stand, on all ranks together. Errors: no grid for the
   * sum, too many images, radii that are too different */
  const sd_mobility_engine *choose();
  /* What engines are told, also of other sums; as long as this stands */
  sd_mobility_how how() const;

  // --- of a sum that is split

  /* slab: that of its taller box */
  const sd_ewald &splitting() const { return ewald; }
  /* points; up to where spheres have near parts with each other */
  double count() const { return ewald.count + second_level.count; }
  double reach() const { return ewald.reach + 2.0 * shells.extent(scene.largest()); }
  /* The parameters, once a run and when they are others than those told last. */
  void tell();
  /* The box around an open cloud, or the heights of a slab: six numbers to keep */
  std::vector<double> open_box() const;
  void set_open_box(const std::vector<double> &box);

 private:
  const Voice voice;
  const Scene &scene;
  const Shells &shells;
  const SceneSettings &settings;

  sd_ewald ewald = {};
  sd_ewald_level second_level = {};
  sd_slab slab = {};
  /* the parameters, as they were last told */
  std::string said;
  Stamp told;

  int width() const { return shells.on() ? 3 : scene.width(); }
  bool periodic() const;
  /* of a product, for sd_mobility_how.tolerance; 0: a solve goes on below the rounding of floats */
  double harmless_error() const;
  /* with which spheres, by their points, have far_field_tolerance */
  double tolerance_of_sums() const;
  bool split();
  sd_status choose_split(const sd_ewald_box &box, const sd_ewald_sizes &sizes);
  void split_slab();
  sd_ewald_sizes measure(sd_ewald_box &box) const;
  sd_ewald_sizes sizes_of_all(double largest) const;
  sd_slab_spheres measure_slab(const sd_slab_walls &walls) const;
  [[noreturn]] void no_grid(double count, const std::string &where, sd_status status) const;
  void refuse_images(double each, double images, double largest) const;
};

}    // namespace StokesDyn
#endif
