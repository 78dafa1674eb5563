# Tests of the core (cmocka, ctest) and the plugins that only tests load.
find_path(cmocka_include cmocka.h REQUIRED)
find_library(cmocka_library cmocka REQUIRED)
enable_testing()

set(tests ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/core)
set(tested stokesdyn_core)
if(STOKESDYN_SANITIZE)
  # The core's own sources once more, so that sanitizers see them too.
  set(sanitize -fsanitize=${STOKESDYN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_library(sanitized_core STATIC EXCLUDE_FROM_ALL ${core_sources})
  target_include_directories(sanitized_core PUBLIC ${source}/core)
  target_compile_options(sanitized_core PUBLIC ${sanitize} -g -O1)
  target_link_options(sanitized_core PUBLIC ${sanitize})
  target_link_libraries(sanitized_core PUBLIC LAPACK::LAPACK m)
  set(tested sanitized_core)
endif()
file(GLOB test_sources CONFIGURE_DEPENDS ${tests}/test_*.c)
foreach(file ${test_sources})
  get_filename_component(name ${file} NAME_WE)
  add_executable(${name} ${file})
  target_include_directories(${name} PRIVATE ${cmocka_include})
  target_compile_definitions(${name} PRIVATE TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/../unittest/data/")
  target_compile_options(${name} PRIVATE -Wall -Wextra -g)
  target_link_libraries(${name} PRIVATE ${tested} ${cmocka_library})
  add_test(NAME ${name} COMMAND ${name})
endforeach()

# The product as processors other than x86-64 have it, and as compilers without vector types have it.
if(NOT STOKESDYN_SANITIZE)
  foreach(variant portable no)
    string(TOUPPER SD_${variant}_KERNELS definition)
    file(GLOB product_sources CONFIGURE_DEPENDS ${source}/core/sd_product*.c)
    add_library(${variant}_kernels OBJECT ${product_sources})
    target_compile_definitions(${variant}_kernels PRIVATE ${definition})
    target_compile_options(${variant}_kernels PRIVATE -Wall -Wextra -Wshadow)
    foreach(name test_simd test_product)
      add_executable(${name}_${variant}_kernels ${tests}/${name}.c $<TARGET_OBJECTS:${variant}_kernels>)
      target_include_directories(${name}_${variant}_kernels PRIVATE ${cmocka_include})
      target_compile_definitions(${name}_${variant}_kernels PRIVATE TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/../unittest/data/")
      target_link_libraries(${name}_${variant}_kernels PRIVATE stokesdyn_core ${cmocka_library})
      add_test(NAME ${name}_${variant}_kernels COMMAND ${name}_${variant}_kernels)
    endforeach()
  endforeach()
endif()

# Timings: cmake --build build --target bench_core. The rival loop in it gets all that this processor has.
include(CheckCCompilerFlag)
check_c_compiler_flag(-march=native STOKESDYN_MARCH_NATIVE)
add_executable(bench_core EXCLUDE_FROM_ALL ${tests}/../bench/bench_core.c)
target_include_directories(bench_core PRIVATE ${tests} ${cmocka_include})
target_compile_options(bench_core PRIVATE -Wall -Wextra -O3 $<$<BOOL:${STOKESDYN_MARCH_NATIVE}>:-march=native>)
target_link_libraries(bench_core PRIVATE ${tested} ${cmocka_library})

# A plugin that believes to be built for another LAMMPS, to see the guard refuse it. In a folder of its own, since newer LAMMPS
# loads every plugin in LAMMPS_PLUGIN_PATH.
add_plugin(wrongversionplugin)
set_target_properties(wrongversionplugin PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/wrong)
target_compile_definitions(wrongversionplugin PRIVATE SD_LAMMPS_NUM=19990101)

# The example that needs no LAMMPS checks its own numbers. Not under sanitizers: those runs build the core tests alone.
if(NOT STOKESDYN_SANITIZE)
  add_test(NAME clump_resistance COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/../examples/clump_resistance/check.sh $<TARGET_FILE:clump_resistance>)
endif()

# Timings of fix hydro/vans; not a test.
add_executable(bench_vans EXCLUDE_FROM_ALL ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/bench/bench_vans.c)
target_link_libraries(bench_vans PRIVATE stokesdyn_core)
