#include "io/hdf5/dataset_names.hpp"

#include <gtest/gtest.h>

namespace stridor {
namespace {

TEST(DatasetNames, SayWhatADatasetIs) {
  EXPECT_EQ(long_name_of("/time"), "time since the start");
  EXPECT_EQ(long_name_of("/acceleration_peak"), "largest acceleration in the window of `measure`");
  EXPECT_EQ(long_name_of("/channels/cantilever.free_end.y.acceleration"),
            "acceleration of cantilever.free_end along y");
  EXPECT_EQ(long_name_of("/channels/a.b.c.x.displacement"), "displacement of a.b.c along x");
  EXPECT_EQ(long_name_of("/channels/observed.displacement"), "displacement of observed");
  EXPECT_EQ(long_name_of("/contact/pad/slip_velocity"),
            "slip velocity of the contact pad along the first tangent");
  EXPECT_EQ(long_name_of("/modal/disc/damping_ratio"),
            "damping ratio of the mode of disc by itself");
  EXPECT_EQ(long_name_of("/final/time"), "time at the end of the run");
  EXPECT_EQ(long_name_of("/final/disc/velocity"),
            "velocity of disc at the end of the run, in reduced coordinates");
  EXPECT_EQ(long_name_of("/unstable/growth_max"),
            "growth rate of the mode that grows fastest in the window");
  EXPECT_EQ(long_name_of("/up/period"), "period of the limit cycle (up)");
  EXPECT_EQ(long_name_of("/responses/a.b.y.displacement/a.c.x/real"),
            "real part of a.b.y.displacement per force at a.c.x");
  EXPECT_EQ(long_name_of("/new_group/some_thing"), "some thing, new group");
  EXPECT_EQ(long_name_of(""), "");
}

}  // namespace
}  // namespace stridor
