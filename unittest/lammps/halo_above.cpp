/* fix ID all test/halo REACH tells of the halo of all atoms (halo.h): how many pairs of an atom and a copy within the
 * reach have the copy below and how many above, and on how many ranks those above are not what a halo of them has. */
#include "lammps_plugin_interface.h"

#include "fix.h"
#include "halo.h"
#include "lammps.h"
#include "utils.h"

#include "sd_linear.h"

#include <vector>

using namespace LAMMPS_NS;
using namespace StokesDyn;

class FixTestHalo : public Fix {
 public:
  FixTestHalo(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
  {
    const double reach = utils::numeric(FLERR, arg[3], false, lmp);
    const size_t n = 3 * (size_t) atom->nlocal;
    std::vector<double> rows(n), some;
    for (size_t k = 0; k < n; k++) rows[k] = atom->x[k / 3][k % 3];
    const Lattice lattice = Lattice::of(domain);
    Halo others(world), above(world);
    others.find(lattice, reach, rows);
    above.find(lattice, reach, rows, Halo::ABOVE);
    std::vector<double> x = rows, y = rows;
    others.extend(lattice.h, x, {});
    above.extend(lattice.h, y, {});
    const std::vector<double> flag = others.above();
    int pairs[2] = {0, 0};
    for (size_t j = n; j < x.size(); j += 3) {
      const bool is_above = flag[(j - n) / 3] != 0.0;
      for (size_t i = 0; i < n; i += 3)
        if (sd_distance_squared(&x[i], &x[j]) <= reach * reach) pairs[is_above]++;
      if (is_above) some.insert(some.end(), &x[j], &x[j] + 3);
    }
    int wrong = some.size() + n != y.size();
    for (size_t k = 0; k < some.size() && !wrong; k++) wrong = some[k] != y[n + k];
    utils::logmesg(lmp, "halo: {} below, {} above, {} wrong\n", sum_of_all(world, pairs[0]),
                   sum_of_all(world, pairs[1]), sum_of_all(world, wrong));
  }
  int setmask() override { return 0; }
};

static void *make_halo(LAMMPS *lmp, int narg, char **arg)
{
  return static_cast<Fix *>(new FixTestHalo(lmp, narg, arg));
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  PluginStyle plugin = {};
  plugin.version = SD_LAMMPS_VERSION;
  plugin.author = plugin.info = "test of the halo";
  plugin.handle = handle;
  plugin.style = "fix";
  plugin.name = "test/halo";
  plugin.creator.of_command = &make_halo;
  ((PluginRegister *) regfunc)(&plugin, lmp);
}
