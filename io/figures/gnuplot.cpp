#include "io/figures/gnuplot.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/helper_program.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

constexpr const char* packages = "install the packages gnuplot-nox and fonts-dejavu-core";

// Messages of gnuplot on one line, without those known to be harmless.
std::string read_messages(const fs::path& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line);) {
    const bool is_blank = line.find_first_not_of(" \t^\r") == std::string::npos;
    const bool is_harmless = line.find("No writable cache directories") != std::string::npos ||
                             line.find("adjusting to [") != std::string::npos;
    if (is_blank || is_harmless) continue;
    if (!text.empty()) text += "; ";
    text += line.substr(line.find_first_not_of(" \t"));
  }
  // A script may be long; the reason is at the end of the message.
  constexpr std::size_t longest = 600;
  return text.size() > longest ? "… " + text.substr(text.size() - longest) : text;
}

// Commands that choose the terminal for the ending of the name.
std::string terminal(const std::string& ending, FigureSize size) {
  // fontscale, so that sizes given in a script are points of the figure with every terminal.
  const auto font = [&](double scale) {
    return fmt::format("font 'DejaVu Sans,{:g}' fontscale {:.4f}", size.font_size, scale);
  };
  if (ending == ".svg") {
    constexpr double px_per_cm = 96.0 / 2.54;
    return fmt::format("set terminal svg size {:.0f},{:.0f} noenhanced {} background '#ffffff'\n",
                       size.width * px_per_cm, size.height * px_per_cm, font(96.0 / 72.0));
  }
  if (ending == ".pdf") {
    return fmt::format("set terminal pdfcairo size {:g}cm,{:g}cm noenhanced {} linewidth 0.5\n",
                       size.width, size.height, font(72.0 / 96.0));
  }
  constexpr double dots_per_cm = 100.0;
  // The terminals for PNG take an inch to have 96 dots.
  const double scale = dots_per_cm * 2.54 / 96.0;
  return fmt::format(
      "if (strstrt(GPVAL_TERMINALS, 'pngcairo') > 0) {{\n"
      "  set terminal pngcairo size {0:.0f},{1:.0f} noenhanced {2} linewidth 2\n"
      "}} else {{\n"
      "  set terminal png size {0:.0f},{1:.0f} noenhanced {2} linewidth 2\n"
      "}}\n",
      size.width * dots_per_cm, size.height * dots_per_cm, font(scale));
}

std::vector<fs::path> font_folders() {
  std::vector<fs::path> folders{"/usr/share/fonts", "/usr/local/share/fonts"};
  if (const char* home = std::getenv("HOME")) {
    folders.emplace_back(fs::path(home) / ".fonts");
    folders.emplace_back(fs::path(home) / ".local/share/fonts");
  }
  return folders;
}

}  // namespace

std::string gnuplot_string(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') {
      quoted += "''";
    } else {
      quoted += (c == '\n' || c == '\r' || c == '\0') ? ' ' : c;
    }
  }
  return quoted + "'";
}

void check_figure_name(const fs::path& figure) {
  const std::string ending = figure.extension().string();
  if (ending == ".png" || ending == ".svg" || ending == ".pdf") return;
  throw ConfigError(
      Refusal::wrong_value, "",
      fmt::format("figure '{}': the name must end with .png, .svg or .pdf", figure.string()));
}

bool has_fonts(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    std::error_code error;
    fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
                                           error);
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
      const std::string ending = entry->path().extension().string();
      if (ending == ".ttf" || ending == ".otf" || ending == ".ttc" || ending == ".pfb") return true;
    }
  }
  return false;
}

namespace {

/// Whether a figure can be drawn where it is to stand.
/// @throws FileError with the reason
void check_place(const fs::path& figure) {
  const std::string ending = figure.extension().string();
  // Without fonts gnuplot draws figures without any text and reports success.
  if (ending != ".svg" && std::getenv("FONTCONFIG_FILE") == nullptr && !has_fonts(font_folders())) {
    throw FileError(Refusal::helper_program, figure.string(), "",
                    fmt::format("there are no fonts to draw it with; {}", packages));
  }
  std::error_code error;
  const fs::path folder = figure.has_parent_path() ? figure.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    throw FileError(Refusal::cannot_write, figure.string(), "",
                    fmt::format("there is no folder '{}'", folder.string()));
  }
  if (fs::exists(figure, error) && !fs::is_regular_file(figure, error)) {
    throw FileError(Refusal::cannot_write, figure.string(), "",
                    "is not a regular file and is not replaced");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw FileError(
        Refusal::cannot_write, figure.string(), "",
        fmt::format("cannot write in the folder '{}': {}", folder.string(), std::strerror(errno)));
  }
}

/// @throws FileError if gnuplot could not be started, or did not do what it was told
void check_outcome(const HelperOutcome& outcome, const fs::path& messages_path,
                   const std::string& figure) {
  if (outcome.spawn_error == ENOENT)
    throw FileError(Refusal::helper_program, figure, "",
                    fmt::format("gnuplot is not installed; {}", packages));
  if (outcome.spawn_error != 0) {
    throw FileError(Refusal::helper_program, figure, "",
                    fmt::format("cannot start gnuplot: {}", std::strerror(outcome.spawn_error)));
  }
  const std::string messages = read_messages(messages_path);
  if (WIFSIGNALED(outcome.status)) {
    throw FileError(Refusal::helper_program, figure, "",
                    fmt::format("gnuplot was ended by signal {}", WTERMSIG(outcome.status)));
  }
  if (WEXITSTATUS(outcome.status) != 0 || !messages.empty()) {
    throw FileError(
        Refusal::helper_program, figure, "",
        fmt::format("gnuplot failed: {}", messages.empty() ? "no reason given" : messages));
  }
}

}  // namespace

void draw_figure(const fs::path& figure, const std::string& script, FigureSize size) {
  check_figure_name(figure);
  if (!(size.width > 0.0 && size.height > 0.0 && size.font_size > 0.0)) {
    throw std::invalid_argument("draw_figure: the size must be positive");
  }
  check_place(figure);
  const Activity drawing("drawing " + figure.filename().string());
  const ScratchFolder scratch("figure", {"script.gp", "messages"}, figure.string());
  PartFile part(figure.string());
  part.made();
  const fs::path script_path = scratch / "script.gp";
  {
    std::ofstream file(script_path, std::ios::binary);
    file << "set encoding utf8\n"
         << terminal(figure.extension().string(), size) << "set output "
         << gnuplot_string(part.path()) << '\n'
         << script << "\nset output\n";
    file.close();
    if (!file)
      throw FileError(Refusal::cannot_write, figure.string(), "",
                      "cannot write a temporary script; is the disk full?");
  }
  const fs::path messages_path = scratch / "messages";
  // -d: no start-up files.
  check_outcome(run_helper({"gnuplot", "-d", script_path.string()}, "", messages_path.string()),
                messages_path, figure.string());
  std::error_code error;
  const auto drawn = fs::file_size(part.path(), error);
  if (error || drawn == 0)
    throw FileError(Refusal::helper_program, figure.string(), "", "gnuplot wrote no picture");
  part.replace();
}

}  // namespace stridor
