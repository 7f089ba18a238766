# House rules for targets.
#
#   teleop_library(core/control LAYER 4 DEPENDS teleop::model)
#
# makes the static library teleop::control of every *.cpp of that folder (an interface library
# where there is none), compiled with the house warnings, whose include root is the repository
# root. A folder is one idea, one library and one row of the layer table. A library may depend
# only on libraries of a lower layer: configuring fails otherwise, and a generated test reads the
# includes, so the architecture cannot rot silently.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

add_library(teleop_warnings INTERFACE)
target_compile_options(teleop_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
  -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual
  -Wimplicit-fallthrough -Wextra-semi
  # Not -Wnull-dereference, and no -Wrestrict: GCC 12 at -O3 reports both inside its own <string> and
  # <streambuf> (PR 105651, 105562); the analyzer and the sanitizers look for the same.
  -Wno-restrict)

function(teleop_library path)
  cmake_parse_arguments(ARG "" "LAYER" "DEPENDS;PRIVATE_DEPENDS;GENERATED" ${ARGN})
  get_filename_component(name ${path} NAME)
  set(target teleop_${name})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${path}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  if(sources)
    add_library(${target} STATIC ${sources} ${ARG_GENERATED})
    set(visibility PUBLIC)
    target_link_libraries(${target} PRIVATE teleop_warnings ${ARG_PRIVATE_DEPENDS})
  else()
    add_library(${target} INTERFACE)
    set(visibility INTERFACE)
  endif()
  add_library(teleop::${name} ALIAS ${target})
  target_include_directories(${target} ${visibility} ${PROJECT_SOURCE_DIR})
  target_link_libraries(${target} ${visibility} ${ARG_DEPENDS})
  set_target_properties(${target} PROPERTIES TELEOP_LAYER ${ARG_LAYER} TELEOP_PATH ${path})

  set(allowed ${path})
  foreach(dependency IN LISTS ARG_DEPENDS ARG_PRIVATE_DEPENDS)
    if(dependency MATCHES "^teleop::(.+)$")
      get_target_property(layer teleop_${CMAKE_MATCH_1} TELEOP_LAYER)
      if(NOT layer LESS ARG_LAYER)
        message(FATAL_ERROR "${path} (layer ${ARG_LAYER}) may not depend on "
                            "${dependency} (layer ${layer})")
      endif()
      get_target_property(dependency_path teleop_${CMAKE_MATCH_1} TELEOP_PATH)
      list(APPEND allowed ${dependency_path})
    endif()
  endforeach()
  if(BUILD_TESTING)
    list(JOIN allowed "," allowed)
    add_test(NAME layers.${name}
      COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DFOLDER=${path}
              -DALLOWED=${allowed} -P ${PROJECT_SOURCE_DIR}/cmake/check_includes.cmake)
    set_tests_properties(layers.${name} PROPERTIES LABELS layers)
  endif()
endfunction()

# teleop_program(master teleop-master DEPENDS …): the program of FOLDER/main.cpp.
function(teleop_program path name)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  add_executable(${name} ${PROJECT_SOURCE_DIR}/${path}/main.cpp)
  target_link_libraries(${name} PRIVATE teleop_warnings ${ARG_DEPENDS})
endfunction()

# teleop_test(control LABEL unit [SERIAL] DEPENDS …): every tests/control/*_test.cpp in one program; the
# target tests-LABEL builds all programs of a label. SERIAL keeps other tests away from real time.
function(teleop_test name)
  cmake_parse_arguments(ARG "SERIAL" "LABEL" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${name}/*_test.cpp)
  if(NOT sources)
    return()
  endif()
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  add_executable(${name}_test ${sources})
  target_link_libraries(${name}_test PRIVATE teleop_warnings ${ARG_DEPENDS} teleop_test_support
                        GTest::gtest_main)
  if(NOT TARGET tests-${ARG_LABEL})
    add_custom_target(tests-${ARG_LABEL})
  endif()
  add_dependencies(tests-${ARG_LABEL} ${name}_test)
  gtest_discover_tests(${name}_test TEST_PREFIX ${ARG_LABEL}. DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS ${ARG_LABEL} RUN_SERIAL ${ARG_SERIAL})
endfunction()
