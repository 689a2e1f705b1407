// Numbers and lines of a Gmsh mesh, written as text or as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/imports/source_text.hpp"

namespace stridor {

/// Goes through a file once. Numbers of a record stand on one line, or in binary files behind each
/// other. Each `what` names the number in messages: "a node tag".
/// Every function that reads throws ConfigError where something else stands.
class GmshCursor {
 public:
  /// @param source outlives the cursor
  explicit GmshCursor(const SourceText& source) : source_(source) {}

  /// Numbers from here on are little-endian bytes.
  void turn_binary() { is_binary_ = true; }
  bool is_binary() const { return is_binary_; }

  std::size_t offset() const { return offset_; }
  std::size_t remaining() const { return source_.text.size() - offset_; }
  [[noreturn]] void refuse(std::size_t offset, const std::string& message) const;

  /// Passes blanks and line ends; false at the end of the file.
  bool skip_blank();
  /// The rest of a line of text, also in binary files, without blanks at its ends.
  std::string_view line();
  /// Passes everything up to the line "$EndNAME" and that line.
  void skip_section(std::string_view name, std::size_t begin);
  /// The line "$EndNAME", which must come next.
  void end_section(std::string_view name);

  /// An integer of 4 bytes.
  std::int64_t integer(const char* what);
  /// A size or tag of 8 bytes, not negative.
  std::int64_t size(const char* what);
  /// An integer of text, also in binary files.
  std::int64_t text_integer(const char* what);
  /// Finite.
  double real(const char* what);
  /// A number of 8 bytes that is not used, finite or not.
  void skip_real(const char* what);
  /// In text the line must end here.
  void end_record(const char* what);

  /// @param least_bytes that each of the counted things takes in the rest of the file
  /// @return count, if the file can hold so many
  std::size_t checked_count(std::int64_t count, std::size_t least_bytes, std::size_t offset,
                            const char* what) const;

 private:
  std::string_view word(const char* what);
  const char* bytes(std::size_t count, const char* what);

  const SourceText& source_;
  std::size_t offset_ = 0;
  bool is_binary_ = false;
};

}  // namespace stridor
