# Every library that the program uses. FFTW, SuiteSparse and udunits ship no CMake
# configuration in Debian, so they come through the find modules beside this file.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(muparser REQUIRED)
find_package(FFTW3 REQUIRED)
find_package(SuiteSparse REQUIRED COMPONENTS CHOLMOD UMFPACK)
find_package(UDUNITS2 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(BLAS REQUIRED)
find_package(LAPACK REQUIRED)

# The serial library even where an MPI build of HDF5 is installed beside it.
set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 REQUIRED COMPONENTS C HL)
if(HDF5_IS_PARALLEL)
  message(FATAL_ERROR "The HDF5 found is the MPI build. Install libhdf5-dev (serial) "
                      "or point HDF5_ROOT at a serial build.")
endif()

find_path(CLI11_INCLUDE_DIR CLI/CLI.hpp REQUIRED)
find_path(NLOHMANN_JSON_INCLUDE_DIR nlohmann/json.hpp REQUIRED)

if(NOT TARGET stridor_hdf5)
  add_library(stridor_hdf5 INTERFACE)
  target_include_directories(stridor_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
  target_link_libraries(stridor_hdf5 INTERFACE ${HDF5_C_HL_LIBRARIES} ${HDF5_C_LIBRARIES})
endif()
