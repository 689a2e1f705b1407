# One library per folder: the link graph is the include order of the folders.
# core <- substructures <- coupling <- solvers <- models <- analysis <- io <- app

add_library(stridor_options INTERFACE)
target_compile_features(stridor_options INTERFACE cxx_std_20)
target_compile_options(stridor_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  # Eigen and fmt headers trip these two in g++ 12 at -O3; both are false positives there.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds>
  $<$<BOOL:${STRIDOR_WERROR}>:-Werror>)
target_include_directories(stridor_options INTERFACE "${PROJECT_SOURCE_DIR}")
# Dense products of Eigen go to BLAS, which picks the instruction set of the machine at run time.
target_compile_definitions(stridor_options INTERFACE EIGEN_USE_BLAS)
target_link_libraries(stridor_options INTERFACE BLAS::BLAS)
target_include_directories(stridor_options SYSTEM INTERFACE
  "${CLI11_INCLUDE_DIR}" "${NLOHMANN_JSON_INCLUDE_DIR}")

# Reading the headers of Eigen, fmt and gtest takes most of a compilation, so they are read once:
# for the libraries, and once more for the tests, which are compiled with other options. Each source
# still includes what it uses; the dev preset compiles without these.
set(STRIDOR_HEADERS <algorithm> <array> <cmath> <complex> <filesystem> <functional> <map> <memory>
  <optional> <span> <string> <vector> <Eigen/Dense> <Eigen/Sparse> <fmt/format.h>)
add_library(stridor_headers OBJECT "${PROJECT_SOURCE_DIR}/cmake/headers.cpp")
target_link_libraries(stridor_headers PRIVATE stridor_options Eigen3::Eigen fmt::fmt)
target_precompile_headers(stridor_headers PRIVATE ${STRIDOR_HEADERS})

# stridor_library(FOLDER SOURCES ... LINKS ... [HEADERS <header>...])
# A folder that names HEADERS has precompiled headers of its own, with these beside the common ones.
function(stridor_library folder)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS;PRIVATE_LINKS;HEADERS" ${ARGN})
  add_library(stridor_${folder} STATIC ${arg_SOURCES})
  target_link_libraries(stridor_${folder}
    PUBLIC stridor_options ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  if(arg_HEADERS)
    target_precompile_headers(stridor_${folder} PRIVATE ${STRIDOR_HEADERS} ${arg_HEADERS})
  else()
    target_precompile_headers(stridor_${folder} REUSE_FROM stridor_headers)
  endif()
endfunction()

# What is tested stands in the libraries; the tests themselves need not be fast, but must compile fast.
set(STRIDOR_TEST_OPTIONS -O1)

# All programs of tests labelled unit: what the sanitizers run.
add_custom_target(unit_tests)

# stridor_test(NAME LABEL unit|verification|scene SOURCES ... LINKS ...)
# One program per call; every TEST in it becomes a ctest with that label.
function(stridor_test name)
  cmake_parse_arguments(arg "" "LABEL" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE stridor_options ${arg_LINKS} Eigen3::Eigen fmt::fmt GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${STRIDOR_TEST_OPTIONS})
  target_precompile_headers(${name} REUSE_FROM stridor_test_headers)
  target_compile_definitions(${name} PRIVATE
    STRIDOR_SOURCE_DIR="${PROJECT_SOURCE_DIR}" STRIDOR_PROGRAM="$<TARGET_FILE:stridor>")
  if(arg_LABEL STREQUAL unit)
    add_dependencies(unit_tests ${name})
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS ${arg_LABEL} TIMEOUT 600)
endfunction()
