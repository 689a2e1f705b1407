// What a report holds, unpacked as its scripts do.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/report/sample_coding.hpp"

namespace stridor::test {

/// The bytes of base 64; fails the test at any other character.
inline std::vector<unsigned char> bytes_of_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  unsigned value = 0;
  int bits = 0;
  for (const char one : text) {
    if (one == '=') break;
    const std::size_t digit = digits.find(one);
    EXPECT_NE(digit, std::string::npos) << "no digit of base 64: " << one;
    value = (value << 6 | static_cast<unsigned>(digit)) & 0xffffffU;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(value >> bits));
  }
  return bytes;
}

/// A gzip member unpacked.
inline std::vector<unsigned char> inflated(const std::vector<unsigned char>& packed) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
  stream.next_in = const_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  std::vector<unsigned char> plain;
  std::array<unsigned char, 4096> buffer{};
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = buffer.data();
    stream.avail_out = static_cast<uInt>(buffer.size());
    status = inflate(&stream, Z_NO_FLUSH);
    plain.insert(plain.end(), buffer.begin(), buffer.end() - stream.avail_out);
  }
  EXPECT_EQ(status, Z_STREAM_END);
  inflateEnd(&stream);
  return plain;
}

/// The text of a script element of a page.
inline std::string script_of(const std::string& page, const std::string& id) {
  const std::string start = "id=\"" + id + "\">";
  const std::size_t begin = page.find(start);
  EXPECT_NE(begin, std::string::npos) << id;
  if (begin == std::string::npos) return "";
  return page.substr(begin + start.size(), page.find("</script>", begin) - begin - start.size());
}

inline nlohmann::json contents_of_report(const std::string& page) {
  return nlohmann::json::parse(script_of(page, "report"));
}

/// The numbers that a reference {"block", "coding", "count"} stands for.
inline std::vector<double> numbers_of(const std::string& page, const nlohmann::json& reference) {
  const std::vector<unsigned char> bytes =
      inflated(bytes_of_base64(script_of(page, reference["block"].get<std::string>())));
  const auto count = reference["count"].get<std::size_t>();
  const std::string coding = reference["coding"];
  if (coding == "scaled16") return decoded_samples(bytes, count);
  if (coding == "bytes") return {bytes.begin(), bytes.end()};
  std::vector<double> values;
  const std::size_t size = coding == "float64" ? 8 : 4;
  EXPECT_EQ(bytes.size(), size * count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<unsigned char, 8> one{};
    for (std::size_t k = 0; k < size; ++k) one[k] = bytes[k * count + i];
    double value = 0.0;
    float single = 0.0F;
    std::memcpy(&value, one.data(), 8);
    std::memcpy(&single, one.data(), 4);
    values.push_back(size == 8 ? value : static_cast<double>(single));
  }
  return values;
}

}  // namespace stridor::test
