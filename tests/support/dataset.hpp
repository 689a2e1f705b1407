// Numbers of an HDF5 file.
#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <filesystem>
#include <string>
#include <vector>

namespace stridor::test {

/// All values of a dataset of one or two dimensions; a failure where there is none.
inline std::vector<double> dataset(const std::filesystem::path& path, const std::string& name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(file, 0);
  hsize_t shape[2] = {1, 1};
  EXPECT_GE(H5LTget_dataset_info(file, name.c_str(), shape, nullptr, nullptr), 0) << name;
  std::vector<double> values(shape[0] * shape[1]);
  H5LTread_dataset_double(file, name.c_str(), values.data());
  H5Fclose(file);
  return values;
}

}  // namespace stridor::test
