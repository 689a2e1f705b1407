#include "io/results/wave_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

namespace stridor {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(static_cast<unsigned char>(value));
  return bytes;
}

// By the layout of RIFF WAVE (Microsoft and IBM, Multimedia Programming Interface, 1991, ch. 3).
TEST(WaveFile, TwoChannelsByteForByte) {
  const std::array<std::vector<double>, 2> channels{std::vector<double>{0.0, 1.0},
                                                    std::vector<double>{-1.0, 0.5}};
  EXPECT_EQ(wave_bytes(channels, 48000),
            "RIFF" + bytes_of({48, 0, 0, 0}) + "WAVEfmt " + bytes_of({16, 0, 0, 0}) +
                bytes_of({1, 0, 2, 0}) + bytes_of({0x80, 0xbb, 0, 0}) +  // 48,000 Hz
                bytes_of({0x00, 0x65, 0x04, 0x00}) +                     // 288,000 bytes a second
                bytes_of({6, 0, 24, 0}) + "data" + bytes_of({12, 0, 0, 0}) +
                bytes_of({0, 0, 0, 0x01, 0x00, 0x80}) +           // 0, −(2²³ − 1)
                bytes_of({0xff, 0xff, 0x7f, 0x00, 0x00, 0x40}));  // 2²³ − 1, rounded half of it
}

TEST(WaveFile, AnOddNumberOfBytesIsPaddedAndTheLengthsSayWhatIsThere) {
  const std::array<std::vector<double>, 1> channel{std::vector<double>{0.25}};
  const std::string bytes = wave_bytes(channel, 8000);
  ASSERT_EQ(bytes.size(), 48u);
  EXPECT_EQ(bytes.substr(4, 4), bytes_of({40, 0, 0, 0}));
  EXPECT_EQ(bytes.substr(40, 4), bytes_of({3, 0, 0, 0}));
  EXPECT_EQ(bytes.back(), '\0');
}

TEST(WaveFile, WhatIsBeyondTheScaleIsCutOff) {
  const std::array<std::vector<double>, 1> loud{std::vector<double>{-7.0, 3.0}};
  const std::array<std::vector<double>, 1> full{std::vector<double>{-1.0, 1.0}};
  EXPECT_EQ(wave_bytes(loud, 8000), wave_bytes(full, 8000));
}

TEST(WaveFile, RefusesWhatIsNoSound) {
  const auto refuses = [](const std::vector<std::vector<double>>& channels, int rate,
                          const char* text) {
    EXPECT_THAT([&] { wave_bytes(channels, rate); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(text)));
  };
  refuses({}, 8000, "one or two channels");
  refuses({{0.0}, {0.0}, {0.0}}, 8000, "one or two channels");
  refuses({{0.0}, {0.0, 1.0}}, 8000, "not of the same length");
  refuses({{0.0}}, 0, "must be positive");
}

}  // namespace
}  // namespace stridor
