#include "io/report/report_page.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/errors.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/report/packed_text.hpp"
#include "io/report/page_sources.hpp"
#include "io/report/sample_coding.hpp"

namespace stridor {

struct ReportPage::Impl {
  Impl(const std::string& path, Overwrite how) : part(path), overwrite(how), name(path) {}

  void write(std::string_view text) {
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    size += text.size();
    if (!stream)
      throw FileError(Refusal::cannot_write, name, "", "cannot be written: " + errno_message());
  }
  static std::string errno_message() {
    return std::error_code(errno, std::generic_category()).message();
  }

  PartFile part;
  Overwrite overwrite;
  std::string name;
  std::ofstream stream;
  std::uint64_t size = 0;
  int num_blocks = 0;
};

ReportPage::ReportPage(const std::string& path, Overwrite overwrite, const std::string& title) {
  if (overwrite == Overwrite::no && std::filesystem::exists(path))
    throw FileError(Refusal::file_exists, path, "", "exists; use --force to overwrite it");
  impl_ = std::make_unique<Impl>(path, overwrite);
  errno = 0;
  impl_->stream.open(impl_->part.path(), std::ios::binary | std::ios::trunc);
  if (!impl_->stream)
    throw FileError(Refusal::cannot_write, path, "", "cannot be made: " + Impl::errno_message());
  impl_->part.made();
  std::string head(report_markup);
  const auto put = [&](const std::string& place, std::string_view text) {
    head.replace(head.find(place), place.size(), text);
  };
  put("@TITLE@", html_text(title));
  put("@STYLES@", std::string(uplot_styles) + std::string(report_styles));
  impl_->write(head);
}

ReportPage::~ReportPage() = default;

nlohmann::ordered_json ReportPage::add_block(std::span<const unsigned char> bytes,
                                             const char* coding, std::size_t count) {
  const std::string packed = gzipped(bytes);
  const auto* begin = reinterpret_cast<const unsigned char*>(packed.data());
  const std::string id = fmt::format("block-{}", impl_->num_blocks++);
  impl_->write(fmt::format("<script type=\"application/octet-stream\" id=\"{}\">", id));
  impl_->write(base64_text({begin, packed.size()}));
  impl_->write("</script>\n");
  return {{"block", id}, {"coding", coding}, {"count", count}};
}

nlohmann::ordered_json ReportPage::add_samples(std::span<const double> samples) {
  return add_block(coded_samples(samples), "scaled16", samples.size());
}

nlohmann::ordered_json ReportPage::add_numbers(std::span<const double> values) {
  return add_block(shuffled_doubles(values), "float64", values.size());
}

nlohmann::ordered_json ReportPage::add_floats(std::span<const double> values) {
  return add_block(shuffled_floats(values), "float32", values.size());
}

nlohmann::ordered_json ReportPage::add_bytes(std::span<const unsigned char> bytes) {
  return add_block(bytes, "bytes", bytes.size());
}

std::uint64_t ReportPage::size() const {
  return impl_->size;
}

void ReportPage::finish(const nlohmann::ordered_json& contents) {
  impl_->write("<script type=\"application/json\" id=\"report\">");
  impl_->write(script_json(contents));
  impl_->write("</script>\n<script>\n/*\nuPlot, https://github.com/leeoniya/uPlot\n\n");
  impl_->write(uplot_licence);
  impl_->write("*/\n");
  impl_->write(uplot_script);
  impl_->write("</script>\n<script>\n");
  impl_->write(report_script);
  impl_->write("</script>\n</body>\n</html>\n");
  impl_->stream.close();
  if (!impl_->stream)
    throw FileError(Refusal::cannot_write, impl_->name, "",
                    "cannot be written: " + Impl::errno_message());
  impl_->part.move_to_final(impl_->overwrite);
}

std::string script_json(const nlohmann::ordered_json& contents) {
  // Text that is not UTF-8 is shown with replacement characters rather than refused.
  const std::string text =
      contents.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char character : text) {
    // A browser ends a script at "</script", and a line at U+2028, wherever they stand.
    if (character == '<') safe += "\\u003c";
    else safe += character;
  }
  return safe;
}

std::string html_text(const std::string& text) {
  std::string safe;
  for (const char character : text) {
    switch (character) {
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '&': safe += "&amp;"; break;
      case '"': safe += "&quot;"; break;
      default: safe += character;
    }
  }
  return safe;
}

}  // namespace stridor
