#include "engine.h"

#include "keywords.h"
#include "lattice.h"
#include "ranks.h"

#include "comm.h"
#include "domain.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

Engine::Engine(const Voice &voice, Scene &scene, Shells &shells) :
    Pointers(voice.lmp), far_field(voice, scene, shells), cloud(voice.lmp), voice(voice), scene(scene), shells(shells),
    settings(scene.settings), halo(world), halo_of_points(world)
{
}

void Engine::out_of_memory()
{
  voice.fail_one("out of memory for the list of pairs");
}

// --- who sees whom -------------------------------------------------------------------------------

void Engine::place(std::vector<double> &idle)
{
  if (!settings.everybody()) return place_list(idle);
  engine = far_field.choose();
  if (view() == SD_VIEW_NEAR) {
    look_for_others(far_field.count());
    if (!somebody_sees) return;
    surround(halo.find_or_keep(Lattice::of(domain), far_field.reach(), scene.places(),
                               one_sided() ? Halo::ABOVE : Halo::OTHERS),
             "far_field: the largest radius, " + text(scene.largest()));
    far_field.tell();
    put(scene.size_with_copies(), idle);
  } else {
    cloud.gather(scene.local(), scene.all_tags(), scene.all_molecules(), scene.all_epochs().rows);
    look_for_others(cloud.size());
    put(cloud.size(), idle);
  }
}

void Engine::place_list(std::vector<double> &idle)
{
  const int n = scene.size();
  engine = &sd_mobility_list;
  if (!pairs_found.is(scene.all_epochs().rows))
    find_pairs();
  else if (!somebody_sees)
    return;    // nobody will ask where the spheres are
  else
    scene.bring(halo);
  if (settings.has_cutoff()) {
    const sd_spheres spheres = scene.local();
    if (sd_neighbors_reserve(&pairs, n, candidates.first[n]) != SD_OK) out_of_memory();
    sd_pairs_within(&candidates.pairs, &spheres, settings.cutoff, pairs.first, pairs.neighbor);
    pairs.pairs.n = n;
  }
  put(scene.size_with_copies(), idle);
}

void Engine::surround(bool found, const std::string &keyword)
{
  if (!found)
    voice.fail_one("keyword " + keyword + ", reaches more than 1000 images of each sphere and 1e7 "
                   "in all; is it in other units?");
  scene.bring(halo);
}

/* Of all ranks, where everybody sees everybody: of two there is another, and of one there is if it has
 * images, or other points. */
void Engine::look_for_others(double spheres)
{
  somebody_sees = spheres > (shells.on() || settings.boundary.has_images() ? 0.0 : 1.0);
}

/* Until LAMMPS re-neighbours again, an atom stays within half the skin of where it was when it did
 * so last. A list made then holds with the cut-off and one skin; made later, both spheres of a pair
 * may still move a whole skin from where they are. */
void Engine::find_pairs()
{
  const double reach = settings.cutoff + (neighbor->ago == 0 ? 1.0 : 2.0) * neighbor->skin;
  const int n = scene.size();
  if (settings.whole && settings.clumps_only)
    halo.clear();
  else
    surround(halo.find(Lattice::of(domain), reach, scene.places()),
             "cut_off_distance: '" + text(settings.cutoff) + "'");
  const int n_all = scene.size_with_copies();
  const double *x = scene.local().x;
  sd_status status;
  if (settings.clumps_only) {
    std::vector<double> sent(n_all + 1);
    std::vector<int64_t> ids(scene.all_tags()), known_molecules(scene.all_molecules());
    for (auto *names : {&ids, &known_molecules}) {
      for (int k = 0; k < n; k++) sent[k] = ubuf((*names)[k]).d;
      halo.refresh(sent.data(), sent.data() + n, 1);
      names->resize(n_all + 1);
      for (int k = n; k < n_all; k++) (*names)[k] = ubuf(sent[k]).i;
    }
    std::vector<int> scratch(n_all + 1);
    const sd_named known = {x, ids.data(), known_molecules.data()};
    status = sd_neighbors_clump(&candidates, &known, n, n_all, reach, scratch.data());
  } else
    status = sd_neighbors_cutoff(&candidates, x, n, n_all, reach);
  if (status != SD_OK) out_of_memory();
  const int sees = candidates.first[n] > 0 || (settings.boundary.has_images() && n > 0);
  somebody_sees = largest_of_all(world, sees);
  pairs_found.set(scene.all_epochs().rows);
}

// Products of all pairs of fewer take a tenth of a millisecond, and keep all digits.
static const int FLOATS_FROM = 512;

/* The spheres where they stand, and what the core may ask */
void Engine::put(int n_all_or_copies, std::vector<double> &idle)
{
  const bool by_cloud = view() == SD_VIEW_ALL;
  sd_mobility_scene core = {};
  core.how = far_field.how();
  core.n = scene.size();
  core.n_all = n_all_or_copies;
  core.spheres = by_cloud ? cloud.spheres() : scene.local();
  core.pairs = view() == SD_VIEW_LIST ? &list() : nullptr;
  core.one_sided = one_sided();
  core.world = by_cloud ? ranks_of_cloud() : ranks();
  if (shells.on()) put_points(idle, core);
  if (core.n_all < FLOATS_FROM) core.how.tolerance = 0.0;
  const sd_status status = sd_mobility_place(&omega, engine, &core);
  if (status != SD_OK)
    fail_by(voice.of("set-up of the matrix-vector product by " + std::string(engine->name)), status);
}

/* How the shells of all stand, whose rows go where those of the spheres did; empty where no clump turns any */
std::vector<double> Engine::turned_shells(int n_all_or_copies)
{
  if (!settings.whole) return {};
  const size_t width = shells.sent_width(), own = width * scene.size();
  std::vector<double> rows = shells.sent(scene.size()), all(width * n_all_or_copies + 1);
  if (view() == SD_VIEW_ALL)
    cloud.to_all(rows.data(), all.data(), (int) width);
  else {
    std::copy_n(rows.begin(), own, all.begin());
    halo.refresh(rows.data(), &all[own], (int) width);
  }
  return all;
}

/* In the place of these spheres their points */
void Engine::put_points(std::vector<double> &idle, sd_mobility_scene &core)
{
  shells.expand(core.n_all, turned_shells(core.n_all), core.spheres, engine->reads_places_once ? &idle : nullptr);
  core.n = shells.first_of_rows()[core.n];
  core.n_all = shells.first_of_all()[core.n_all];
  core.spheres = shells.all();
  core.groups = shells.groups();
  if (view() == SD_VIEW_ALL) return;
  halo_of_points = halo.refined(shells.first_of_all());
  core.world = halo_of_points.ranks();
}

/* They know each other's rows by the cloud. */
sd_world Engine::ranks_of_cloud()
{
  sd_world all = {};
  all.ctx = this;
  all.me = comm->me;
  all.ranks = comm->nprocs;
  all.spread = [](void *ctx, const double *rows, double *cloud_rows, int width) {
    Engine *engine = static_cast<Engine *>(ctx);
    return callback([=] { engine->cloud.to_all(rows, cloud_rows, width, engine->first_in_cloud()); });
  };
  all.collect = [](void *ctx, const double *cloud_rows, double *rows, int width) {
    Engine *engine = static_cast<Engine *>(ctx);
    return callback([=] { engine->cloud.to_own(cloud_rows, rows, width, engine->first_in_cloud()); });
  };
  return all;
}

double Engine::memory_usage() const
{
  return sizeof(int) * ((double) candidates.room + pairs.room) + cloud.memory_usage() + halo.memory_usage();
}

}    // namespace StokesDyn
