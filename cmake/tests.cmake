# Tests of the core (cmocka, ctest) and the plugins that only tests load.
find_path(cmocka_include cmocka.h REQUIRED)
find_library(cmocka_library cmocka REQUIRED)
enable_testing()

set(tests ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/core)

# Every program that ctest runs here: what the run with sanitizers builds.
add_custom_target(core_tests)

# What takes long, with and without sanitizers, the longest one first
set(longest ladder drift ewald_levels multiblob_noise_periodic ewald_ranks slab simd field multiblob_periodic
  precondition_rotation clusters slab_tables waves multiblob_clusters multiblob_noise lubrication ewald_wall
  solve ewald_open multiblob_loop clump_exact vans_wall tie clump noise)

# core_test(NAME MODEL FILE [LIBRARY...]): a test sees the core of its own model, and what the rooms above it share.
# Libraries come before the model's.
function(core_test_program name model file)
  add_executable(${name} ${file})
  target_include_directories(${name} PRIVATE ${cmocka_include} ${tests} ${tests}/${model})
  target_compile_definitions(${name} PRIVATE TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/../unittest/data/")
  target_compile_options(${name} PRIVATE -Wall -Wextra)
  # What tests wait for is the library: -O3 takes a compiler three times as long, -O1 with sanitizers as well.
  string(REGEX REPLACE "^test_" "" short ${name})
  if(STOKESDYN_SANITIZE)
    if(NOT short IN_LIST longest)
      target_compile_options(${name} PRIVATE -O0)
    endif()
  else()
    target_compile_options(${name} PRIVATE -O1)
  endif()
  target_link_libraries(${name} PRIVATE ${ARGN} stokesdyn_${model} ${cmocka_library})
endfunction()

function(core_test name model file)
  core_test_program(${name} ${model} ${file} ${ARGN})
  add_test(NAME ${name} COMMAND ${name})
  add_dependencies(core_tests ${name})
  if(STOKESDYN_SANITIZE)
    # By default 256 MB of freed memory wait for late readers, and new pages take as long as the tests.
    set_tests_properties(${name} PROPERTIES ENVIRONMENT ASAN_OPTIONS=quarantine_size_mb=16)
  endif()
endfunction()

foreach(model base drag ${models})
  file(GLOB_RECURSE test_sources CONFIGURE_DEPENDS ${tests}/${model}/test_*.c)
  list(FILTER test_sources EXCLUDE REGEX /test_two_sphere_exact.c$)
  foreach(file ${test_sources})
    get_filename_component(name ${file} NAME_WE)
    if(STOKESDYN_SANITIZE AND name STREQUAL test_ladder)
      continue() # a minute of closed forms, over code that each engine's own tests run here as well
    endif()
    core_test(${name} ${model} ${file})
  endforeach()
endforeach()

# Kernels, and the look-up in a grid, as processors other than x86-64 have them, and as compilers without vector types:
# these rooms once more, before the library that has them too.
if(NOT STOKESDYN_SANITIZE)
  set(kernel_rooms tensor product ${ewald_rooms} lubrication precondition flow)
  list(TRANSFORM kernel_rooms PREPEND stokes/)
  list(APPEND kernel_rooms base)
  list(TRANSFORM kernel_rooms PREPEND ${source}/core/)
  # What is asked here is whether such code is right, of small scenes (SD_SMALL), and -O0 compiles it in a fifth of the
  # time.
  list(REMOVE_ITEM kernel_options -O3)
  set(options_plain "")
  foreach(variant portable no)
    string(TOUPPER SD_${variant}_KERNELS definition)
    # Plain C is what the library has in that set; without vectors a file may differ in it.
    set(kernel_sets plain)
    if(variant STREQUAL portable)
      set(kernel_sets baseline)
    endif()
    add_rooms(${variant}_kernels ${kernel_rooms})
    target_compile_definitions(${variant}_kernels PRIVATE ${definition} SD_SMALL)
    target_compile_options(${variant}_kernels PRIVATE -O0 -w)    # GCC would warn of loops that it does not unroll
    target_include_directories(${variant}_kernels PRIVATE $<TARGET_PROPERTY:stokesdyn_stokes,INCLUDE_DIRECTORIES>)
    target_link_libraries(${variant}_kernels PUBLIC stokesdyn_stokes)
    set_target_properties(${variant}_kernels PROPERTIES EXCLUDE_FROM_ALL ON)
    foreach(file product/test_simd product/test_product product/test_product_single ewald/test_ewald_kernels
            lubrication/test_block_cholesky flow/test_flow_grid)
      get_filename_component(name ${file} NAME)
      core_test(${name}_${variant}_kernels stokes ${tests}/stokes/${file}.c ${variant}_kernels)
      target_compile_definitions(${name}_${variant}_kernels PRIVATE ${definition} SD_SMALL)
    endforeach()
  endforeach()
endif()

# Two spheres exactly, which the plugin has as a table: what makes the shipped one. Made anew at some nodes, it is the
# same.
set(table ${tests}/stokes/two_sphere/table)
file(GLOB exact_sources CONFIGURE_DEPENDS ${table}/sd_*.c)
add_library(two_sphere_exact STATIC ${exact_sources})
target_include_directories(two_sphere_exact PUBLIC ${table})
target_compile_options(two_sphere_exact PRIVATE -Wall -Wextra -Wshadow)
target_link_libraries(two_sphere_exact PUBLIC stokesdyn_stokes)
set_target_properties(two_sphere_exact PROPERTIES EXCLUDE_FROM_ALL ON)
foreach(test test_two_sphere test_lubrication test_film test_unlike_pair test_multiblob_pair)
  target_link_libraries(${test} PRIVATE two_sphere_exact)
endforeach()
add_executable(make_two_sphere_table ${table}/make_two_sphere_table.c)
target_compile_options(make_two_sphere_table PRIVATE -Wall -Wextra -Wshadow)
target_link_libraries(make_two_sphere_table PRIVATE two_sphere_exact)
add_test(NAME two_sphere_table COMMAND make_two_sphere_table check 23)
add_dependencies(core_tests make_two_sphere_table)
# and that of shells of points
add_executable(make_film_table ${table}/make_film_table.c)
target_compile_options(make_film_table PRIVATE -Wall -Wextra -Wshadow)
target_link_libraries(make_film_table PRIVATE two_sphere_exact)
add_test(NAME film_table COMMAND make_film_table check 1 4 5)
add_test(NAME film_table_half COMMAND make_film_table check half 0 0.44 0.31)
add_test(NAME film_table_half_large COMMAND make_film_table check half 1 0.44 0.17)
add_dependencies(core_tests make_film_table)
# and the constants of half shells
add_executable(make_half_shells ${tests}/stokes/multiblob/table/make_half_shells.c)
target_compile_options(make_half_shells PRIVATE -Wall -Wextra -Wshadow)
target_link_libraries(make_half_shells PRIVATE stokesdyn_stokes)
add_test(NAME half_shells COMMAND make_half_shells check)
add_dependencies(core_tests make_half_shells)
# The series themselves change once a year; their long tests run then, by hand. Here it is asked whether they are what
# was tested.
core_test_program(test_two_sphere_exact stokes ${tests}/stokes/two_sphere/test_two_sphere_exact.c two_sphere_exact)
set_target_properties(test_two_sphere_exact PROPERTIES EXCLUDE_FROM_ALL ON)
add_test(NAME two_sphere_series COMMAND ${table}/check.sh)

# What takes longest begins first, so that all cores end together.
list(LENGTH longest cost)
foreach(name ${longest})
  if(TEST test_${name})
    set_tests_properties(test_${name} PROPERTIES COST ${cost})
  endif()
  math(EXPR cost "${cost} - 1")
endforeach()

# Timings: cmake --build build --target bench_product bench_solve (unittest/bench/README.md)
foreach(bench product solve resting ewald slab lubrication field speed_error tolerance)
  add_executable(bench_${bench} EXCLUDE_FROM_ALL ${tests}/../bench/bench_${bench}.c)
  target_include_directories(bench_${bench} PRIVATE ${tests} ${tests}/stokes ${cmocka_include})
  target_compile_options(bench_${bench} PRIVATE -Wall -Wextra -O2)
  target_link_libraries(bench_${bench} PRIVATE stokesdyn_stokes ${cmocka_library})
endforeach()
# The rival loop in it gets all that this processor has.
include(CheckCCompilerFlag)
check_c_compiler_flag(-march=native STOKESDYN_MARCH_NATIVE)
target_compile_options(bench_product PRIVATE -O3 $<$<BOOL:${STOKESDYN_MARCH_NATIVE}>:-march=native>)

# A plugin that believes to be built for another LAMMPS, and styles whose symbols this LAMMPS has not, to see the guard
# refuse them. In a folder of its own, since newer LAMMPS loads every plugin in LAMMPS_PLUGIN_PATH.
if(STOKESDYN_PLUGIN)
  add_loader(wrongversionplugin 19990101)
  add_plugin_file(wrongstyles ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/lammps/wrong_styles.c)
  set_target_properties(wrongstyles PROPERTIES OUTPUT_NAME stokesdynstyles)
  # Styles by the names of those that this LAMMPS lacks, to see that ours know them (test_neighbours.py).
  add_plugin_file(stylesoftoday ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/lammps/styles_of_today.cpp)
  target_include_directories(stylesoftoday PRIVATE ${source}/common)
  target_link_libraries(stylesoftoday PRIVATE lammps_headers)
  # What no output of ours shows (test_halo.py)
  add_plugin_file(haloabove ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/lammps/halo_above.cpp
    $<TARGET_OBJECTS:styles_common> $<TARGET_OBJECTS:styles_stokes>)
  target_include_directories(haloabove PRIVATE $<TARGET_PROPERTY:styles_stokes,INTERFACE_INCLUDE_DIRECTORIES>)
  target_link_libraries(haloabove PRIVATE lammps_headers stokesdyn_stokes)
  set(plugins wrongversionplugin wrongstyles stylesoftoday haloabove)
  set_target_properties(${plugins} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/wrong)
  add_custom_target(test_plugins DEPENDS ${plugins})
endif()

# The example that needs no LAMMPS checks its own numbers. Not under sanitizers: those runs build the core tests alone.
if(NOT STOKESDYN_SANITIZE)
  add_test(NAME clump_resistance COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/../examples/clump_resistance/run.py --program
    $<TARGET_FILE:clump_resistance>)
endif()

# Timings of fix hydro/vans; not a test.
add_executable(bench_vans EXCLUDE_FROM_ALL ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/bench/bench_vans.c)
target_link_libraries(bench_vans PRIVATE stokesdyn_vans)
