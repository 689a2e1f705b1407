// Arguments that a function refuses.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace stridor::test {

/// Holds that a call throws std::invalid_argument, whose words hold the message.
template <class Callable>
void expect_rejection(Callable&& callable, const char* message) {
  EXPECT_THAT(callable,
              ::testing::ThrowsMessage<std::invalid_argument>(::testing::HasSubstr(message)));
}

}  // namespace stridor::test
