# Tests of the core (cmocka, ctest) and the plugins that only tests load.
find_path(cmocka_include cmocka.h REQUIRED)
find_library(cmocka_library cmocka REQUIRED)
enable_testing()

# With sanitizers the core is compiled once more, so that they see it too.
set(tested_core stokesdyn_core)
if(STOKESDYN_SANITIZE)
  set(sanitize -fsanitize=${STOKESDYN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  set(tested_core sanitized_core)
  add_library(sanitized_core STATIC EXCLUDE_FROM_ALL ${core_sources})
  target_compile_options(sanitized_core PRIVATE ${sanitize} -g -O1)
endif()

set(tests ${CMAKE_CURRENT_SOURCE_DIR}/../unittest/core)
file(GLOB test_sources CONFIGURE_DEPENDS ${tests}/test_*.c)
foreach(file ${test_sources})
  get_filename_component(name ${file} NAME_WE)
  add_executable(${name} ${file})
  target_include_directories(${name} PRIVATE ${source}/core ${cmocka_include})
  target_compile_options(${name} PRIVATE -Wall -Wextra -g ${sanitize})
  target_link_options(${name} PRIVATE ${sanitize})
  target_link_libraries(${name} PRIVATE ${tested_core} ${cmocka_library} m)
  add_test(NAME ${name} COMMAND ${name})
endforeach()

# A plugin that believes to be built for another LAMMPS, to see the guard refuse it. In a folder of its own, since newer LAMMPS
# loads every plugin in LAMMPS_PLUGIN_PATH.
add_plugin(wrongversionplugin)
set_target_properties(wrongversionplugin PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/wrong)
target_compile_definitions(wrongversionplugin PRIVATE SD_LAMMPS_NUM=19990101)
