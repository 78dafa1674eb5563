# For LAMMPS's own build (provide_lammps.sh): what most of its files include is compiled once, which saves three tenths
# of the work.
set(headers pointers.h atom.h comm.h domain.h error.h force.h memory.h update.h)
list(TRANSFORM headers PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/../src/)
cmake_language(EVAL CODE
  "cmake_language(DEFER CALL target_precompile_headers lammps PRIVATE \"${headers};<cmath>;<cstring>\")")
