/* What noise needs to know of the shape of each body: roots of its own matrix (sd_body_root.h), and how it
 * follows random velocities at its points (sd_body_follow.h). Made when a shape is first seen, and kept as
 * long as the settings. */
#ifndef SD_BODY_NOISE_H
#define SD_BODY_NOISE_H

#include "callback.h"
#include "epochs.h"

#include "sd_body.h"
#include "sd_body_follow.h"
#include "sd_body_root.h"

#include <map>
#include <tuple>
#include <vector>

namespace StokesDyn {

class BodyNoise {
 public:
  /* Shapes of another run, which may be gone by now */
  void begin(const Epoch &run);
  /* By bodies [count], nullptr for those that are a point. split: of the near part of this sum, nullptr: of
   * the whole matrix. */
  std::vector<const sd_body_root *> roots(const Voice &, const std::vector<sd_body> &, const sd_ewald *split);
  const sd_body_follow *follow(const Voice &, const sd_body &);

 private:
  const sd_body_root *root(const Voice &, const sd_body &, const sd_ewald *split);

  Stamp made;
  /* by shape and sd_body_root_steps: any root will do, and bodies of many radii, or a box that changes, need
   * few. (0, 0, 0): of the whole matrix */
  using Which = std::tuple<const sd_body_shape *, int, int, int>;
  std::map<Which, Owned<sd_body_root, sd_body_root_free>> all_roots;
  std::map<const sd_body_shape *, Owned<sd_body_follow, sd_body_follow_free>> all_follow;
};

}    // namespace StokesDyn
#endif
