# One library per folder: the link graph is the include order of the folders.
# core <- substructures <- coupling <- solvers <- models <- analysis <- io <- app

add_library(stridor_options INTERFACE)
target_compile_features(stridor_options INTERFACE cxx_std_20)
target_compile_options(stridor_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion
  # Of other local names alone: files that are compiled together see each other's.
  $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local>
  # clang warns of all names, and at -Wconversion of signs, which g++ does not in C++.
  $<$<NOT:$<CXX_COMPILER_ID:GNU>>:-Wno-sign-conversion;$<$<NOT:$<BOOL:${STRIDOR_UNITY}>>:-Wshadow>>
  # Eigen and fmt headers trip these two in g++ 12 at -O3; both are false positives there.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds>
  # g++ frees what it no longer needs once it holds a gigabyte, instead of again and again.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>
  $<$<BOOL:${STRIDOR_WERROR}>:-Werror>)
target_include_directories(stridor_options INTERFACE "${PROJECT_SOURCE_DIR}")
# Dense products of Eigen go to BLAS, which picks the instruction set of the machine at run time.
target_compile_definitions(stridor_options INTERFACE EIGEN_USE_BLAS)
target_link_libraries(stridor_options INTERFACE BLAS::BLAS)
target_include_directories(stridor_options SYSTEM INTERFACE
  "${CLI11_INCLUDE_DIR}" "${NLOHMANN_JSON_INCLUDE_DIR}")

# Reading the headers of Eigen, fmt and gtest takes most of a compilation, so they are read once:
# for the libraries, and once more for what is compiled with other options. Each source
# still includes what it uses; the dev preset compiles without these.
set(STRIDOR_HEADERS <algorithm> <array> <cmath> <complex> <filesystem> <functional> <map> <memory>
  <optional> <span> <string> <vector> <Eigen/Dense> <Eigen/Sparse> <fmt/format.h>
  "${PROJECT_SOURCE_DIR}/substructures/matrices/dense_factors.hpp" "${PROJECT_SOURCE_DIR}/substructures/matrices/dense_spectra.hpp")
add_library(stridor_headers OBJECT "${PROJECT_SOURCE_DIR}/cmake/headers.cpp")
target_link_libraries(stridor_headers PRIVATE stridor_options Eigen3::Eigen fmt::fmt)
target_precompile_headers(stridor_headers PRIVATE ${STRIDOR_HEADERS})

# Sources that read scenes, write words and draw pictures take three to four times as long to compile with
# optimisation and no longer to run without: what computes stands elsewhere. The preset release asks for -O0.
set(STRIDOR_QUICK_OPTIONS -O1 CACHE STRING "How the compiler optimises sources in which no time goes")
add_library(stridor_quick_headers OBJECT "${PROJECT_SOURCE_DIR}/cmake/headers.cpp")
target_link_libraries(stridor_quick_headers PRIVATE stridor_options Eigen3::Eigen fmt::fmt)
target_compile_options(stridor_quick_headers PRIVATE ${STRIDOR_QUICK_OPTIONS})
target_precompile_headers(stridor_quick_headers PRIVATE ${STRIDOR_HEADERS} <nlohmann/json.hpp>)

# stridor_unity(TARGET NUM_SOURCES): lets the compiler read that many sources at a time, with the headers
# that they share once. So names without linkage differ within a folder; a source that cannot be read
# with others has the property SKIP_UNITY_BUILD_INCLUSION.
function(stridor_unity target num_sources)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${STRIDOR_UNITY} UNITY_BUILD_MODE BATCH UNITY_BUILD_BATCH_SIZE ${num_sources})
  if(STRIDOR_UNITY)
    # A local name may hide one of another source of the batch; the preset dev warns within a source.
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
endfunction()

# stridor_library(FOLDER SOURCES ... LINKS ... [PRIVATE_LINKS ...] [PRIVATE_HEADERS ...] [TOGETHER <number>] [QUICK])
# TOGETHER says how many sources the compiler reads at a time; headers that need a private link are
# PRIVATE_HEADERS. QUICK: compiled with STRIDOR_QUICK_OPTIONS.
function(stridor_library folder)
  cmake_parse_arguments(arg "QUICK" "TOGETHER" "SOURCES;LINKS;PRIVATE_LINKS;PRIVATE_HEADERS" ${ARGN})
  add_library(stridor_${folder} STATIC ${arg_SOURCES})
  target_link_libraries(stridor_${folder}
    PUBLIC stridor_options ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  if(arg_QUICK)
    target_compile_options(stridor_${folder} PRIVATE ${STRIDOR_QUICK_OPTIONS})
    target_precompile_headers(stridor_${folder} REUSE_FROM stridor_quick_headers)
  else()
    target_precompile_headers(stridor_${folder} REUSE_FROM stridor_headers)
  endif()
  get_property(is_verified DIRECTORY PROPERTY STRIDOR_HEADERS_VERIFIED)
  if(CMAKE_VERIFY_INTERFACE_HEADER_SETS AND NOT is_verified)
    # The preset headers: read together with others, a source may find what its header forgot to include.
    set_property(DIRECTORY PROPERTY STRIDOR_HEADERS_VERIFIED ON)
    file(GLOB_RECURSE headers RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}" "*.hpp")
    list(REMOVE_ITEM headers ${arg_PRIVATE_HEADERS})
    target_sources(stridor_${folder} PUBLIC FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${headers})
  endif()
  if(arg_TOGETHER)
    stridor_unity(stridor_${folder} ${arg_TOGETHER})
  endif()
endfunction()

# stridor_optimised_first(TARGET LIBRARY...): the objects of these libraries come first on the line of the
# linker. Of a template function that several objects have it takes the first copy, which is not to be one
# that is less optimised than the loops that call it.
function(stridor_optimised_first target)
  foreach(library ${ARGN})
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:stridor_${library}>)
  endforeach()
endfunction()

# What is tested stands in the libraries; the tests themselves need not be fast, but must compile fast: with -O1
# clang takes two to four times as long for them.
set(STRIDOR_TEST_OPTIONS -O0)

# All programs of tests labelled unit: what the sanitizers run; and those labelled long, which are
# built for `./run test-all` only.
add_custom_target(unit_tests)
add_custom_target(long_tests)

# stridor_test(NAME LABEL unit|text|program|verification|long SOURCES ... LINKS ... [TOGETHER <number of sources>] [COST <cost>] [FAST])
# One program per call; every TEST in it becomes a ctest with that label. TOGETHER: see stridor_library().
# FAST: the time goes into the test itself, so that the compiler is to optimise it.
# ctest starts tests of a higher COST first, so that a long one is not left to run alone at the end.
function(stridor_test name)
  cmake_parse_arguments(arg "FAST" "LABEL;TOGETHER;COST" "SOURCES;LINKS" ${ARGN})
  if(NOT arg_COST)
    set(arg_COST 0)
  endif()
  add_executable(${name} ${arg_SOURCES})
  if(arg_LINKS MATCHES "stridor_(io|figures|app)")
    stridor_optimised_first(${name} core substructures coupling solvers models analysis)
  endif()
  target_link_libraries(${name} PRIVATE stridor_options ${arg_LINKS} Eigen3::Eigen fmt::fmt GTest::gtest GTest::gmock GTest::gtest_main)
  if(arg_FAST)
    target_compile_options(${name} PRIVATE -O1)
  else()
    target_compile_options(${name} PRIVATE ${STRIDOR_TEST_OPTIONS})
    target_precompile_headers(${name} REUSE_FROM stridor_test_headers)
  endif()
  if(arg_TOGETHER)
    stridor_unity(${name} ${arg_TOGETHER})
  endif()
  target_compile_definitions(${name} PRIVATE
    STRIDOR_SOURCE_DIR="${PROJECT_SOURCE_DIR}" STRIDOR_PROGRAM="$<TARGET_FILE:stridor>")
  if(arg_LABEL STREQUAL unit)
    add_dependencies(unit_tests ${name})
  elseif(arg_LABEL STREQUAL long)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    add_dependencies(long_tests ${name})
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS ${arg_LABEL} TIMEOUT 1200 COST ${arg_COST})
  if(arg_LABEL STREQUAL long)
    # CTest has a test of its own for a program that is not there; it fails with those of the program.
    set(label_file "${CMAKE_CURRENT_BINARY_DIR}/${name}_label.cmake")
    file(GENERATE OUTPUT "${label_file}" CONTENT
"if(NOT EXISTS \"$<TARGET_FILE:${name}>\")
  set_tests_properties(${name}_NOT_BUILT PROPERTIES LABELS long)
endif()
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${label_file}")
  endif()
endfunction()
