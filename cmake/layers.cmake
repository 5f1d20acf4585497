# One library a folder: hookeye_layer(render LINK meshing ... PRIVATE embree ...). Sources are all
# .cpp files below the folder.
function(hookeye_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic)
  if(HOOKEYE_WERROR)
    # GCC 12 sees overruns in std::string that are not there (GCC bugs 105329, 105651).
    target_compile_options(${target} PRIVATE -Werror -Wno-error=array-bounds -Wno-error=restrict
                           -Wno-error=stringop-overflow -Wno-error=stringop-overread)
  endif()
endfunction()

function(hookeye_layer name)
  cmake_parse_arguments(L "" "" "LINK;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(${name} STATIC ${sources})
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC Eigen3::Eigen fmt::fmt ${L_LINK} PRIVATE ${L_PRIVATE})
  hookeye_flags(${name})
  if(HOOKEYE_PCH)
    target_precompile_headers(${name} PRIVATE <Eigen/Core> <Eigen/Dense> <Eigen/SparseCore>
      <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <optional> <string>
      <vector> <fmt/format.h>)
  endif()
endfunction()

# Tests of a folder: one binary from tests/FOLDER/*_test.cpp.
function(hookeye_tests name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${name} ${ARGN} GTest::gmock GTest::gtest_main)
  target_include_directories(test_${name} PRIVATE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/tests)
  target_compile_definitions(test_${name} PRIVATE HOOKEYE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  hookeye_flags(test_${name})
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. NO_PRETTY_VALUES DISCOVERY_TIMEOUT 120
                       PROPERTIES TIMEOUT 900)
endfunction()
