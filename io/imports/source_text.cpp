#include "io/imports/source_text.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/errors.hpp"
#include "core/excerpt.hpp"
#include "core/utf8.hpp"
#include "io/hdf5/regular_file.hpp"

namespace stridor {
namespace {

constexpr std::string_view text_blanks = " \t\r\f\v";

/// Formats that are known by their first bytes.
struct Signature {
  std::string_view bytes;
  const char* description;
};
using namespace std::string_view_literals;
constexpr std::array<Signature, 20> signatures{{
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file (MED, CGNS or results?); export a mesh from it"},
    {"\x1f\x8b"sv, "a gzip archive; unpack it first"},
    {"BZh"sv, "a bzip2 archive; unpack it first"},
    {"\xfd"
     "7zXZ"sv,
     "an xz archive; unpack it first"},
    {"\x28\xb5\x2f\xfd"sv, "a zstd archive; unpack it first"},
    {"PK\x03\x04"sv, "a zip archive; unpack it first"},
    {"\xef\xbb\xbf"sv, "a text with a byte order mark; save it without"},
    {"\xff\xfe"sv, "a text in UTF-16; save it as ASCII or UTF-8"},
    {"\xfe\xff"sv, "a text in UTF-16; save it as ASCII or UTF-8"},
    {"ISO-10303-21"sv, "a STEP file, a geometry without a mesh; mesh it first"},
    {"DBRep_DrawableShape"sv, "a BREP file, a geometry without a mesh; mesh it first"},
    {"CASCADE Topology"sv, "a BREP file, a geometry without a mesh; mesh it first"},
    {"solid "sv, "an STL file, a surface without volumes; mesh it first"},
    {"# vtk DataFile"sv, "a VTK file; convert it to Gmsh 4.1"},
    {"<?xml"sv, "an XML file (VTU?); convert it to Gmsh 4.1"},
    {"<VTKFile"sv, "a VTU file; convert it to Gmsh 4.1"},
    {"    -1\n"sv, "a universal file (UNV); convert it to Gmsh 4.1"},
    {"    -1\r"sv, "a universal file (UNV); convert it to Gmsh 4.1"},
    {"MeshVersionFormatted"sv, "a mesh of Medit; convert it to Gmsh 4.1"},
    {"CDF"sv, "a NetCDF file (Exodus?); convert it to Gmsh 4.1"},
}};

}  // namespace

void refuse_at(const TextPlace& place, const std::string& message) {
  const SourceText& source = *place.source;
  Problem problem{Refusal::wrong_text, "", message, source.name};
  if (source.places == PlaceForm::byte) {
    problem.message = fmt::format("byte {}: {}", place.offset, message);
  } else {
    const auto begin = source.text.begin();
    const auto here =
        begin + static_cast<std::ptrdiff_t>(std::min(place.offset, source.text.size()));
    const auto line = std::count(begin, here, '\n') + 1;
    const auto column = std::distance(
        std::find(std::make_reverse_iterator(here), std::make_reverse_iterator(begin), '\n').base(),
        here);
    constexpr auto largest = std::numeric_limits<int>::max() - 1;
    problem.line = static_cast<int>(std::min<std::ptrdiff_t>(line, largest));
    problem.column = static_cast<int>(std::min<std::ptrdiff_t>(column, largest)) + 1;
    const std::string_view rest =
        std::string_view(source.text).substr(static_cast<std::size_t>(here - begin - column));
    problem.excerpt =
        excerpt_of(rest.substr(0, rest.find_first_of("\r\n")), problem.line, problem.column);
  }
  throw ConfigError(std::vector<Problem>{problem});
}

SourceText read_source_text(const std::string& path, const std::string& expected) {
  refuse_irregular_file(path);
  const OpenFile file(std::fopen(path.c_str(), "rb"));
  if (!file)
    throw FileError(Refusal::cannot_read, path, "",
                    fmt::format("cannot be opened; expected {}", expected));
  struct stat status = {};
  if (fstat(fileno(file.get()), &status) != 0 || !S_ISREG(status.st_mode))
    throw FileError(Refusal::other_kind_of_file, path, "",
                    fmt::format("is no regular file; expected {}", expected));
  if (status.st_size == 0)
    throw FileError(Refusal::other_kind_of_file, path, "",
                    fmt::format("is empty; expected {}", expected));
  SourceText source{path, std::string(static_cast<std::size_t>(status.st_size), '\0')};
  if (std::fread(source.text.data(), 1, source.text.size(), file.get()) != source.text.size())
    throw FileError(Refusal::cannot_read, path, "", "cannot be read to its end");
  return source;
}

std::string foreign_format(std::string_view text) {
  for (const Signature& signature : signatures) {
    if (text.substr(0, signature.bytes.size()) == signature.bytes) return signature.description;
  }
  if (text.size() >= 80 && text[72] == 'S' && text.substr(73, 7) == "      1")
    return "an IGES file, a geometry without a mesh; mesh it first";
  return "";
}

std::optional<std::int64_t> integer_in(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

std::optional<double> real_in(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0.0;
  const char* end = word.data() + word.size();
  auto result = std::from_chars(word.data(), end, value);
  if (result.ec == std::errc() && result.ptr == end)
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  // Rare forms; a number has no more than some tens of letters.
  constexpr std::size_t longest = 400;
  if (word.empty() || word.size() > longest) return std::nullopt;
  std::string text(word);
  if (result.ec == std::errc() && (*result.ptr == 'D' || *result.ptr == 'd'))
    text[static_cast<std::size_t>(result.ptr - word.data())] = 'e';
  end = text.data() + text.size();
  result = std::from_chars(text.data(), end, value);
  if (result.ptr != end) return std::nullopt;
  if (result.ec == std::errc::result_out_of_range) {
    // Both too large and too small a number.
    value = std::strtod(text.c_str(), nullptr);
  } else if (result.ec != std::errc()) {
    return std::nullopt;
  }
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string lower_case_of(std::string_view text) {
  std::string lower(text);
  for (char& letter : lower) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return lower;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(text_blanks);
  if (begin == std::string_view::npos) return text.substr(text.size());
  return text.substr(begin, text.find_last_not_of(text_blanks) - begin + 1);
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result;
  std::size_t i = 0;
  while (i < text.size() && result.size() < longest) {
    const Utf8Character character = utf8_at(text, i);
    const std::size_t length = std::max<std::size_t>(character.length, 1);
    const bool is_printable = character.length > 0 && character.code >= 0x20 &&
                              (character.code < 0x7f || character.code >= 0xa0);
    result += is_printable ? std::string(text.substr(i, length)) : "?";
    i += length;
  }
  return i < text.size() ? result + "..." : result;
}

}  // namespace stridor
