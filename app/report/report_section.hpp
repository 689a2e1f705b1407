// Sections of a report: what the page tells of each file of results.
//
// A section is JSON for the scripts of the page: what the file is, a verdict, and views of its
// numbers, which stand in blocks of the page.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/report/report_page.hpp"
#include "io/results/locus_file.hpp"
#include "io/results/result_file.hpp"
#include "io/scene/scene_mechanics.hpp"

namespace stridor {

/// The options of a report.
struct ReportOptions {
  CommonOptions common;
  std::vector<std::string> files;
  std::string output;
  std::string budget = "8MiB";
  std::vector<std::string> channels;  ///< of runs; the most useful ones where none is named
  bool is_full = false;               ///< every sample, whatever the budget
  bool without_shapes = false;
  std::string command_line;
};

/// Unstable windows that are to be set beside the bursts of runs of the same scene.
struct WindowsOfScene {
  std::string file;
  SceneInFile scene;
  std::vector<TimedWindow> windows;
};

/// The page, its options and the windows of its loci, shared by all sections.
struct ReportContext {
  const ReportOptions& options;
  ReportPage& page;
  double bytes_per_file = 0.0;  ///< of the page, for the present file
  std::vector<WindowsOfScene> windows;
};

/// The section of a file. @throws FileError if it is no file of results, or damaged
Json report_section(const ResultFile& file, const ReportContext& context);

/// The scene that a file is of, without folder and ending; empty where the file does not say.
std::string scene_name(const ResultFile& file);

/// Of a file that has the same name in every folder of results: "study/precision.h5".
std::string name_with_folder(const ResultFile& file);

/// The beginning of every section: title, file, kind, and where it comes from.
/// @param what was computed, which with the name of the scene is the title: "run to 2 s"
Json section_head(const ResultFile& file, const std::string& kind, const std::string& what);

/// A verdict: the level chooses a colour and a sign. "calm" or "loud" says what was heard of a run,
/// "stable" or "unstable" what small vibrations do, "failed" that something did not come to its
/// end, "told" nothing of these.
Json verdict(const std::string& level, const std::string& text);

/// "0.123 m/s^2" for people, with a prefix where the unit has one.
std::string shown(double value, const std::string& units);

/// Points of a line as the page has them: x and y of one after the other.
std::vector<double> points_of(const std::vector<double>& x, const std::vector<double>& y);

/// Levels over time and frequency as a view of the page, in steps of half a decibel, the highest of
/// neighbours where there are more than a picture shows.
/// @param amplitude row per frequency, column per time
/// @param units     of the amplitudes
Json levels_view(const std::vector<double>& times, const std::vector<double>& frequencies,
                 const Eigen::MatrixXd& amplitude, double max_frequency, const std::string& units,
                 ReportPage& page);

// Sections by kind; throw as report_section().
Json run_section(const ResultFile& file, const ReportContext& context);
Json locus_section(const ResultFile& file, const ReportContext& context);
Json map_section(const ResultFile& file, const ReportContext& context);
Json sweep_section(const ResultFile& file, const ReportContext& context);
Json cycle_section(const ResultFile& file, const ReportContext& context);
Json response_section(const ResultFile& file, const ReportContext& context);
Json spectrogram_section(const ResultFile& file, const ReportContext& context);
Json contact_section(const ResultFile& file, const ReportContext& context);
Json precision_section(const ResultFile& file, const ReportContext& context);
Json eigenvalue_section(const ResultFile& file, const ReportContext& context);
Json comparison_section(const ResultFile& file, const ReportContext& context);
Json contact_law_section(const ResultFile& file, const ReportContext& context);
Json master_curve_section(const ResultFile& file, const ReportContext& context);

}  // namespace stridor
