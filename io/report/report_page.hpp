// Reports as one page of HTML that needs nothing beside it.
//
// A page is: markup and styles; blocks of numbers, each the base-64 text of a gzip member in
// <script type="application/octet-stream" id="block-N">; what they are as JSON in
// <script type="application/json" id="report">; the licence of uPlot and the scripts. Only what is
// asked for and comes into view is unpacked.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "io/hdf5/output_options.hpp"

namespace stridor {

/// Writes a page block by block; it takes its name when it is whole.
class ReportPage {
 public:
  /// @param title of the page
  /// @throws FileError if the file exists and may not be overwritten, or cannot be made
  ReportPage(const std::string& path, Overwrite overwrite, const std::string& title);
  ReportPage(const ReportPage&) = delete;
  ReportPage& operator=(const ReportPage&) = delete;
  ~ReportPage();

  /// Numbers in the page, as its scripts read them: {"block": …, "coding": …, "count": …}.
  /// @throws FileError if they cannot be written
  nlohmann::ordered_json add_samples(std::span<const double> samples);
  nlohmann::ordered_json add_numbers(std::span<const double> values);
  nlohmann::ordered_json add_floats(std::span<const double> values);
  nlohmann::ordered_json add_bytes(std::span<const unsigned char> bytes);

  /// Bytes of the page so far.
  std::uint64_t size() const;

  /// Ends the page. @throws FileError if it cannot be written
  void finish(const nlohmann::ordered_json& contents);

 private:
  struct Impl;
  nlohmann::ordered_json add_block(std::span<const unsigned char> bytes, const char* coding,
                                   std::size_t count);
  std::unique_ptr<Impl> impl_;
};

/// Text of JSON that may stand in a script element: no '<', and nothing but UTF-8.
std::string script_json(const nlohmann::ordered_json& contents);

/// Text of HTML.
std::string html_text(const std::string& text);

}  // namespace stridor
