/* Styles of a LAMMPS far apart: they refer to what this one has not. */
void function_of_another_lammps(void);

__attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  function_of_another_lammps();
}
