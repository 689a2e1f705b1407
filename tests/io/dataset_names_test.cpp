#include "io/hdf5/dataset_names.hpp"

#include <gtest/gtest.h>

namespace stridor {
namespace {

TEST(DatasetNames, SayWhatADatasetIs) {
  EXPECT_EQ(long_name_of("/time"), "time");
  EXPECT_EQ(long_name_of("/acceleration_peak"), "acceleration peak");
  EXPECT_EQ(long_name_of("/channels/cantilever.free_end.y.acceleration"),
            "acceleration of cantilever.free_end along y");
  EXPECT_EQ(long_name_of("/channels/a.b.c.x.displacement"), "displacement of a.b.c along x");
  EXPECT_EQ(long_name_of("/channels/observed.displacement"), "displacement of observed");
  EXPECT_EQ(long_name_of("/contact/pad/slip_velocity"), "slip velocity of the contact pad");
  EXPECT_EQ(long_name_of("/modal/disc/damping_ratio"), "damping ratio of the modes of disc by itself");
  EXPECT_EQ(long_name_of("/final/time"), "time at the end");
  EXPECT_EQ(long_name_of("/final/disc/velocity"), "velocity of disc at the end");
  EXPECT_EQ(long_name_of("/bursts/start_frequency"), "start frequency of bursts");
  EXPECT_EQ(long_name_of("/unstable/growth_max"), "growth max of unstable windows");
  EXPECT_EQ(long_name_of("/responses/a.b.y.displacement/a.c.x/real"),
            "real part of a.b.y.displacement per force at a.c.x");
  EXPECT_EQ(long_name_of("/branches/003/growth"), "growth, branches 003");
  EXPECT_EQ(long_name_of(""), "");
}

}  // namespace
}  // namespace stridor
