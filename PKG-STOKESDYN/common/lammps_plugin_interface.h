/* What LAMMPS asks of a plugin, the same since it has plugins (8Apr2021): it calls the function
 * lammpsplugin_init(lmp, handle, regfunc) of the file; that calls regfunc, a PluginRegister, once for
 * each style. Installed headers of LAMMPS lack this. */
#ifndef SD_LAMMPS_PLUGIN_INTERFACE_H
#define SD_LAMMPS_PLUGIN_INTERFACE_H

#include "lammps.h"

namespace StokesDyn {

/* Makes a style: of a pair style from nothing, of a fix or compute from the words of the command. */
typedef void *MakePair(LAMMPS_NS::LAMMPS *);
typedef void *MakeByCommand(LAMMPS_NS::LAMMPS *, int narg, char **arg);

/* A style, as LAMMPS's struct has it (lammpsplugin_t); its fields in this order. */
struct PluginStyle {
  /* of the LAMMPS that it was compiled for: "22 Jul 2025" */
  const char *version;
  /* kind: "pair", "fix", "compute" */
  const char *style;
  const char *name;
  const char *info;
  const char *author;
  union {
    MakePair *of_pair;
    MakeByCommand *of_command;
  } creator;
  /* what lammpsplugin_init was given */
  void *handle;
};

typedef void PluginRegister(PluginStyle *, void *lmp);

}    // namespace StokesDyn
#endif
