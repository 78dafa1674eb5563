# Tests of the core (cmocka, ctest) and the plugins that only tests load.
find_path(cmocka_include cmocka.h REQUIRED)
find_library(cmocka_library cmocka REQUIRED)
enable_testing()

set(tests ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/core)
file(GLOB test_sources CONFIGURE_DEPENDS ${tests}/test_*.c)
foreach(file ${test_sources})
  get_filename_component(name ${file} NAME_WE)
  # The core's own sources once more, so that sanitizers see them too.
  add_executable(${name} ${file} ${core_sources})
  target_include_directories(${name} PRIVATE ${source}/core ${cmocka_include})
  target_compile_options(${name} PRIVATE -Wall -Wextra -g)
  if(STOKESDYN_SANITIZE)
    target_compile_options(${name} PRIVATE -fsanitize=${STOKESDYN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${name} PRIVATE -fsanitize=${STOKESDYN_SANITIZE})
  endif()
  target_link_libraries(${name} PRIVATE ${cmocka_library} m)
  add_test(NAME ${name} COMMAND ${name})
endforeach()

# A plugin that believes to be built for another LAMMPS, to see the guard refuse it. In a folder of its own, since newer LAMMPS
# loads every plugin in LAMMPS_PLUGIN_PATH.
add_plugin(wrongversionplugin)
set_target_properties(wrongversionplugin PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/wrong)
target_compile_definitions(wrongversionplugin PRIVATE SD_LAMMPS_NUM=19990101)

# Timings of fix hydro/vans; not a test.
add_executable(bench_vans ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/bench/bench_vans.c)
target_link_libraries(bench_vans PRIVATE stokesdyn_core)
