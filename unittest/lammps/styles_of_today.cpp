/* Styles that LAMMPS of the set-up lacks, by name: they do nothing, and write into data files what those
 * of LAMMPS 22Jul2025 write, with the last number of pair_coeff and bond_coeff as damping. */
#include "lammps_plugin_interface.h"

#include "atom.h"
#include "bond.h"
#include "fix.h"
#include "lammps.h"
#include "memory.h"
#include "pair.h"

#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* What a style writes behind the types: before and behind the damping; nullptr: it writes nothing */
struct Line {
  const char *before, *behind;
};
static const Line DPD = {"25", "2.5"}, SPRING = {"100 2.5", ""}, BOND = {"100 0.1", ""},
                  ROTATIONAL = {"1 2 3 4 5 6 7 8 0 0 0", ""}, SILENT = {nullptr, nullptr};

/* pair_coeff I J GAMMA */
template <const Line &line> class PairToday : public Pair {
 public:
  explicit PairToday(LAMMPS *lmp) : Pair(lmp) {}
  ~PairToday() override
  {
    if (allocated) memory->destroy(setflag);
    if (allocated) memory->destroy(cutsq);
  }
  void compute(int, int) override {}
  void settings(int, char **) override {}
  void coeff(int, char **arg) override
  {
    const int n = atom->ntypes;
    if (!allocated) {
      memory->create(setflag, n + 1, n + 1, "pair:setflag");
      memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
      for (int i = 0; i <= n; i++)
        for (int j = 0; j <= n; j++) setflag[i][j] = 0;
      allocated = 1;
    }
    setflag[atoi(arg[0])][atoi(arg[1])] = 1;
    gamma = atof(arg[2]);
  }
  double init_one(int, int) override { return 2.5; }
  void write_data_all(FILE *file) override
  {
    for (int i = 1; i <= atom->ntypes; i++)
      for (int j = i; j <= atom->ntypes && line.before; j++)
        fprintf(file, "%d %d %s %g %s\n", i, j, line.before, gamma, line.behind);
  }

 private:
  double gamma = 0.0;
};

/* bond_coeff TYPE GAMMA */
template <const Line &line> class BondToday : public Bond {
 public:
  explicit BondToday(LAMMPS *lmp) : Bond(lmp) {}
  ~BondToday() override
  {
    if (allocated) memory->destroy(setflag);
  }
  void compute(int, int) override {}
  void coeff(int, char **arg) override
  {
    if (!allocated) memory->create(setflag, atom->nbondtypes + 1, "bond:setflag");
    for (int i = 0; i <= atom->nbondtypes; i++) setflag[i] = 1;
    allocated = 1;
    gamma = atof(arg[1]);
  }
  double equilibrium_distance(int) override { return 1.0; }
  void write_restart(FILE *) override {}
  void read_restart(FILE *) override {}
  void write_data(FILE *file) override
  {
    for (int i = 1; i <= atom->nbondtypes && line.before; i++)
      fprintf(file, "%d %s %g %s\n", i, line.before, gamma, line.behind);
  }
  double single(int, double, int, int, double &) override { return 0.0; }

 private:
  double gamma = 0.0;
};

class FixNothing : public Fix {
 public:
  FixNothing(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {}
  int setmask() override { return 0; }
};

template <class Base, class Style> static void *make(LAMMPS *lmp)
{
  return static_cast<Base *>(new Style(lmp));
}

static void *make_fix(LAMMPS *lmp, int narg, char **arg)
{
  return static_cast<Fix *>(new FixNothing(lmp, narg, arg));
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  PluginStyle plugin = {};
  plugin.version = SD_LAMMPS_VERSION;
  plugin.author = plugin.info = "test of neighbours";
  plugin.handle = handle;
  const auto add = [&](const char *kind, const char *name) {
    plugin.style = kind;
    plugin.name = name;
    ((PluginRegister *) regfunc)(&plugin, lmp);
  };
  const auto add_plain = [&](const char *kind, const char *name, MakePair *creator) {
    plugin.creator.of_pair = creator;
    add(kind, name);
  };
  add_plain("pair", "dpd", &make<Pair, PairToday<DPD>>);
  add_plain("pair", "dpd/omp", &make<Pair, PairToday<DPD>>);
  add_plain("pair", "bpm/spring", &make<Pair, PairToday<SPRING>>);
  add_plain("pair", "mdpd/rhosum", &make<Pair, PairToday<SILENT>>);
  add_plain("bond", "bpm/spring", &make<Bond, BondToday<BOND>>);
  add_plain("bond", "bpm/rotational", &make<Bond, BondToday<ROTATIONAL>>);
  add_plain("bond", "bpm/spring/plastic", &make<Bond, BondToday<SILENT>>);
  plugin.creator.of_command = &make_fix;
  for (const char *name : {"damping/cundall", "viscous/omp", "viscous/sphere", "srd", "lb/fluid"}) add("fix", name);
}
