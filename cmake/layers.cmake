# One library a folder: hookeye_layer(render LINK meshing ... PRIVATE embree ...). Sources are all
# .cpp files below the folder, but for those of helpers/ and of the folder WITHOUT, which is a library
# of its own.
function(hookeye_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic)
  if(HOOKEYE_WERROR)
    # GCC 12 sees overruns in std::string that are not there (GCC bugs 105329, 105651).
    target_compile_options(${target} PRIVATE -Werror -Wno-error=array-bounds -Wno-error=restrict
                           -Wno-error=stringop-overflow -Wno-error=stringop-overread)
  endif()
endfunction()

# What headers cost (CLI11, nlohmann, Eigen) is paid once for eight sources. Not for kernels: GCC
# inlines less where a unit grows. HOOKEYE_UNITY_KERNELS: there too, where nobody asks for speed.
function(hookeye_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${HOOKEYE_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  if(HOOKEYE_UNITY)  # GCC takes a source that another includes for a header
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()

# FROM FOLDER: sources of that folder below; PCH_OF TARGET: with that target's precompiled header.
function(hookeye_layer name)
  cmake_parse_arguments(L "UNITY" "FROM;PCH_OF;WITHOUT" "LINK;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${L_FROM}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/helpers/")
  if(L_WITHOUT)
    list(FILTER sources EXCLUDE REGEX "/${L_WITHOUT}/")
  endif()
  add_library(${name} STATIC ${sources})
  # The Python module is linked from the same objects.
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC Eigen3::Eigen fmt::fmt ${L_LINK} PRIVATE ${L_PRIVATE})
  hookeye_flags(${name})
  if(L_UNITY OR HOOKEYE_UNITY_KERNELS)
    hookeye_unity(${name})
  endif()
  if(HOOKEYE_PCH AND L_PCH_OF AND NOT L_PCH_OF STREQUAL name)
    target_precompile_headers(${name} REUSE_FROM ${L_PCH_OF})
  elseif(HOOKEYE_PCH)
    target_precompile_headers(${name} PRIVATE <Eigen/Core> <Eigen/Dense> <Eigen/SparseCore>
      <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <optional> <string>
      <vector> <fmt/format.h>)
  endif()
endfunction()

# A program that hosts a library for the main one (core/helper.h), from helpers/NAME.cpp:
# hookeye_helper(gmsh LAYER meshing PRIVATE ${GMSH_LIBRARY}). Whatever uses them depends on `helpers`.
add_custom_target(helpers)
function(hookeye_helper name)
  cmake_parse_arguments(H "" "LAYER" "PRIVATE" ${ARGN})
  add_executable(helper_${name} helpers/${name}.cpp)
  set_target_properties(helper_${name} PROPERTIES OUTPUT_NAME ${name}
    RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/libexec/hookeye)
  # It loads its own library and none that the layer may need elsewhere.
  target_link_options(helper_${name} PRIVATE -Wl,--as-needed)
  target_link_libraries(helper_${name} PRIVATE ${H_LAYER} ${H_PRIVATE})
  hookeye_flags(helper_${name})
  add_dependencies(helpers helper_${name})
  install(TARGETS helper_${name} RUNTIME DESTINATION libexec/hookeye)
endfunction()

# The program's BLAS is OpenBLAS, whatever else is installed. A linker that drops what no object has
# asked for yet would drop it, and Ceres' own choice (ATLAS) would serve CHOLMOD and Eigen too.
function(hookeye_blas target)
  list(JOIN OPENBLAS_LIBRARY "," libraries)
  target_link_options(${target} PRIVATE
    "LINKER:--push-state,--no-as-needed,${libraries},--pop-state")
endfunction()

# hookeye_test_entries(TARGET PREFIX FILE...): ctest's PREFIX.NAME runs the tests of NAME_test.cpp in
# one process. Those that tests/costs.txt tells begin first, the longest ahead. Those of a folder
# long/ have the label `long`: ./check leaves them out, ./check --long does not. Those of
# tests/sanitized.txt have the label `sanitized`.
function(hookeye_test_entries target prefix)
  target_link_libraries(${target} PRIVATE test_main)
  foreach(source IN LISTS ARGN)
    get_filename_component(file ${source} NAME)
    if(NOT file MATCHES "^(.*)_test\\.cpp$")
      continue()
    endif()
    set(entry ${prefix}.${CMAKE_MATCH_1})
    # A file that only instantiates another's TEST_P has no test of its own: they run with that one.
    file(STRINGS ${source} own REGEX "^(TYPED_)?TEST(_[FP])?(_SUITE_P)?\\(")
    if(NOT own)
      continue()
    endif()
    add_test(NAME ${entry} COMMAND ${target} --file=${file})
    set_tests_properties(${entry} PROPERTIES TIMEOUT 1800)
    if(source MATCHES "/long/")
      set_tests_properties(${entry} PROPERTIES LABELS long)
    elseif(entry IN_LIST sanitized)
      set_tests_properties(${entry} PROPERTIES LABELS sanitized)
      add_dependencies(sanitized ${target})
    endif()
    if(DEFINED cost_of_${entry})
      set_tests_properties(${entry} PROPERTIES COST ${cost_of_${entry}})
    endif()
  endforeach()
endfunction()

# GoogleMock and Eigen, which nearly all tests include, are read once a binary.
function(hookeye_test_headers target)
  if(HOOKEYE_PCH)
    target_precompile_headers(${target} PRIVATE <gmock/gmock.h> <Eigen/Dense> <Eigen/SparseCore>
      <filesystem> <fmt/format.h> <fstream> <functional> <map> <memory> <string> <vector>)
  endif()
endfunction()

# Tests in tests/NAME, of layer NAME or those told: one binary, sources in folders as the layer's.
# hookeye_tests(search OF estimation)
function(hookeye_tests name)
  cmake_parse_arguments(T "" "OF" "" ${ARGN})
  if(NOT T_OF)
    set(T_OF ${name})
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${T_OF} ${T_UNPARSED_ARGUMENTS})
  target_include_directories(test_${name} PRIVATE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/tests)
  target_compile_definitions(test_${name} PRIVATE HOOKEYE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  add_dependencies(test_${name} helpers)
  hookeye_blas(test_${name})
  hookeye_flags(test_${name})
  hookeye_test_headers(test_${name})
  hookeye_test_entries(test_${name} ${name} ${sources})
endfunction()
