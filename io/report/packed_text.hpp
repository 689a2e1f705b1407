// Bytes as text of a page.
#pragma once

#include <span>
#include <string>

namespace stridor {

/// The bytes as one member of gzip (RFC 1952), without name and time, so that equal bytes become
/// equal ones. @throws std::runtime_error if zlib refuses
std::string gzipped(std::span<const unsigned char> bytes);

/// Base 64 (RFC 4648, 4) with padding.
std::string base64_text(std::span<const unsigned char> bytes);

}  // namespace stridor
