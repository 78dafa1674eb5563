/* What serves u = Omega F of a scene: who sees whom, and the core's engine that sums over these
 * (sd_mobility.h), of spheres or of the points of their shells.
 *
 *   LIST   with a cut-off, or by clumps: pairs among the rows and copies of those that are near, of other
 *          ranks and images (halo.h)
 *   NEAR   everybody sees everybody by Ewald sums (far_field.h), with near parts among the same
 *   ALL    everybody sees everybody directly: the spheres of all ranks (cloud.h) */
#ifndef SD_ENGINE_H
#define SD_ENGINE_H

#include "callback.h"
#include "cloud.h"
#include "far_field.h"
#include "halo.h"
#include "pointers.h"
#include "scene.h"
#include "shells.h"

#include "sd_mobility.h"
#include "sd_neighbor.h"

#include <string>
#include <vector>

namespace StokesDyn {

class Engine : protected LAMMPS_NS::Pointers {
 public:
  Engine(const Voice &voice, Scene &, Shells &);

  FarField far_field;
  /* The spheres of all ranks, in view ALL */
  Cloud cloud;

  /* Of the scene and its shells as they stand; on all ranks together. Pairs are found anew if its rows are of
   * others. idle: room that nobody else uses until this returns, for the places of points; an engine that
   * reads them later on has room of its own. */
  void place(std::vector<double> &idle);

  // --- since then

  /* Which spheres of which ranks it sees, and in view LIST whom */
  sd_view view() const { return engine->view; }
  const sd_pairs &list() const { return settings.has_cutoff() ? pairs.pairs : candidates.pairs; }
  /* Does one sphere see another, or an image of itself, on any rank? Does that of row k see
   * nobody? Near a wall every sphere sees itself. */
  bool anybody_sees() const { return somebody_sees; }
  bool alone(int k) const
  {
    const bool listed = view() == SD_VIEW_LIST && !settings.boundary.has_images();
    return listed ? list().first[k] == list().first[k + 1] : !somebody_sees;
  }
  /* View NEAR, but for a slab; else nullptr */
  const sd_ewald *splitting() const
  {
    return view() == SD_VIEW_NEAR && engine != &sd_mobility_slab ? &far_field.splitting() : nullptr;
  }
  /* u = Omega F: context of sd_mobility_apply. */
  sd_mobility *mobility() { return &omega; }
  /* What the core may ask of the other ranks: of the rows of spheres */
  sd_world ranks() const { return halo.ranks(); }

  double memory_usage() const;

 private:
  const Voice voice;
  Scene &scene;
  Shells &shells;
  const SceneSettings &settings;

  Stamp pairs_found;
  bool somebody_sees = false;
  Halo halo, halo_of_points;
  Owned<sd_neighbors, sd_neighbors_free> candidates, pairs;
  const sd_mobility_engine *engine = &sd_mobility_list;
  Owned<sd_mobility, sd_mobility_free> omega;

  const int *first_in_cloud() const { return shells.on() ? shells.first_of_all().data() : nullptr; }
  /* Does it take each pair across a border on one side alone? */
  bool one_sided() const { return engine == &sd_mobility_ewald && !far_field.splitting().images.wall.sign; }
  void place_list(std::vector<double> &idle);
  /* copies: found, or too many for this keyword's reach */
  void surround(bool found, const std::string &keyword);
  void find_pairs();
  void look_for_others(double spheres);
  void put(int n_all_or_copies, std::vector<double> &idle);
  std::vector<double> turned_shells(int n_all_or_copies);
  void put_points(std::vector<double> &idle, sd_mobility_scene &core);
  sd_world ranks_of_cloud();
  [[noreturn]] void out_of_memory();
};

}    // namespace StokesDyn
#endif
