#include "io/imports/law_table_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>
#include <functional>

#include "core/errors.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// F̃ = 2 ŷ^1.5 v̂^0.1, Ã = 3 ŷ, μ = ŷ^½ v̂^0.3.
ContactTable power_table() {
  ContactTable table;
  table.speeds = {0.01, 0.1, 3.0};
  table.indentations = {1e-3, 0.2};
  for (const double y : table.indentations) {
    for (const double v : table.speeds) {
      table.force.push_back(2.0 * std::pow(y, 1.5) * std::pow(v, 0.1));
      table.area.push_back(3.0 * y);
      table.friction.push_back(std::sqrt(y) * std::pow(v, 0.3));
    }
  }
  return table;
}

class LawTableFile : public ::testing::Test {
 protected:
  std::string path() const { return folder_ / "law.h5"; }
  void write(const ContactTable& table) const {
    write_law_table(path(), Overwrite::yes, table, std::vector<double>(table.force.size(), 5.0),
                    {});
  }
  /// Message about the file after a change of it.
  std::string says(const std::function<void(hid_t)>& change) const {
    write(power_table());
    const hid_t file = H5Fopen(path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    change(file);
    H5Fclose(file);
    return message_of<FileError>([&] { (void)read_law_table(path()); });
  }

  TemporaryFolder folder_;
};

TEST_F(LawTableFile, IsReadAsItWasWritten) {
  write(power_table());
  const TabulatedLaw law = read_law_table(path());
  const ViscoelasticContact contact = law.at(0.02, 0.4);
  EXPECT_NEAR(contact.force.value, 2.0 * std::pow(0.02, 1.5) * std::pow(0.4, 0.1), 1e-15);
  EXPECT_NEAR(contact.area.value, 0.06, 1e-14);
  EXPECT_NEAR(contact.friction.value, std::sqrt(0.02) * std::pow(0.4, 0.3), 1e-14);
}

TEST_F(LawTableFile, ExistingFileIsKeptUnlessItMayBeReplaced) {
  write(power_table());
  EXPECT_THAT(message_of<FileError>([&] {
                write_law_table(path(), Overwrite::no, power_table(), std::vector<double>(6), {});
              }),
              HasSubstr("use --force"));
}

TEST_F(LawTableFile, WhatIsNoTableIsRefused) {
  EXPECT_THAT(message_of<FileError>([&] { (void)read_law_table(folder_ / "none.h5"); }),
              HasSubstr("none.h5: cannot be opened"));
  EXPECT_THAT(message_of<FileError>([&] { (void)read_law_table(folder_.path()); }),
              HasSubstr("is a folder"));
  write_file(folder_ / "text.h5", "speed, force");
  EXPECT_THAT(message_of<FileError>([&] { (void)read_law_table(folder_ / "text.h5"); }),
              HasSubstr("is not an HDF5 file"));
  EXPECT_THAT(says([](hid_t file) { H5Ldelete(file, "/friction", H5P_DEFAULT); }),
              HasSubstr("dataset /friction: is missing"));
  EXPECT_THAT(says([](hid_t file) {
                H5Ldelete(file, "/area", H5P_DEFAULT);
                const hsize_t shape[] = {3, 2};
                const double values[6] = {1, 1, 1, 1, 1, 1};
                H5LTmake_dataset_double(file, "/area", 2, shape, values);
              }),
              HasSubstr("/area: is 3 x 2, but there are 2 indentations and 3 speeds"));
  EXPECT_THAT(says([](hid_t file) {
                H5Ldelete(file, "/speed", H5P_DEFAULT);
                H5LTmake_dataset_string(file, "/speed", "fast");
              }),
              HasSubstr("/speed: does not hold real numbers"));
  EXPECT_THAT(says([](hid_t file) {
                H5Ldelete(file, "/speed", H5P_DEFAULT);
                const hsize_t shape[] = {3};
                const double values[] = {1.0, 1.0, 2.0};
                H5LTmake_dataset_double(file, "/speed", 1, shape, values);
              }),
              HasSubstr("speeds are not positive and ascending"));
}

TEST_F(LawTableFile, SizesThatNoFileHoldsAreRefusedBeforeMemoryIsTaken) {
  EXPECT_THAT(says([](hid_t file) {
                H5Ldelete(file, "/speed", H5P_DEFAULT);
                const hsize_t shape[] = {hsize_t{1} << 50};
                const hsize_t chunk[] = {16};
                const hid_t space = H5Screate_simple(1, shape, nullptr);
                const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
                H5Pset_chunk(layout, 1, chunk);
                H5Dclose(H5Dcreate2(file, "/speed", H5T_IEEE_F64LE, space, H5P_DEFAULT, layout,
                                    H5P_DEFAULT));
                H5Pclose(layout);
                H5Sclose(space);
              }),
              HasSubstr("/speed: is damaged: 1125899906842624 entries in a file of"));
}

}  // namespace
}  // namespace stridor
