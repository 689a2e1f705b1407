#include "io/report/packed_text.hpp"

#include <zlib.h>

#include <array>
#include <stdexcept>

namespace stridor {
namespace {

/// A stream of zlib that ends itself.
struct Deflater {
  z_stream stream{};
  Deflater() {
    constexpr int gzip_header = 16;
    constexpr int memory_level = 8;
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + gzip_header,
                     memory_level, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::runtime_error("zlib cannot be started");
  }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream); }
};

}  // namespace

std::string gzipped(std::span<const unsigned char> bytes) {
  constexpr std::size_t piece = std::size_t{1} << 30;  // what a uInt counts, and more than enough
  Deflater deflater;
  std::string packed;
  std::array<char, 1 << 16> buffer{};
  std::size_t taken = 0;
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    if (deflater.stream.avail_in == 0 && taken < bytes.size()) {
      const std::size_t count = std::min(piece, bytes.size() - taken);
      deflater.stream.next_in = const_cast<Bytef*>(bytes.data() + taken);
      deflater.stream.avail_in = static_cast<uInt>(count);
      taken += count;
    }
    deflater.stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    deflater.stream.avail_out = static_cast<uInt>(buffer.size());
    status = deflate(&deflater.stream, taken == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      throw std::runtime_error("zlib cannot pack");
    packed.append(buffer.data(), buffer.size() - deflater.stream.avail_out);
  }
  return packed;
}

std::string base64_text(std::span<const unsigned char> bytes) {
  constexpr const char* digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t rest = bytes.size() - i;
    const unsigned value = (unsigned{bytes[i]} << 16) | (rest > 1 ? unsigned{bytes[i + 1]} << 8 : 0U) |
                           (rest > 2 ? unsigned{bytes[i + 2]} : 0U);
    text += digits[value >> 18];
    text += digits[(value >> 12) & 63U];
    text += rest > 1 ? digits[(value >> 6) & 63U] : '=';
    text += rest > 2 ? digits[value & 63U] : '=';
  }
  return text;
}

}  // namespace stridor
