// stridor frf: frequency responses of a scene between points of its bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/results/file_attributes.hpp"
#include "app/results/pictures.hpp"
#include "app/results/universal_file.hpp"
#include "app/stability/measured_responses.hpp"
#include "app/stability/response_picture.hpp"
#include "app/stability/response_study.hpp"
#include "app/stability/stability.hpp"
#include "core/errors.hpp"
#include "io/figures/axes.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

struct FrfOptions {
  StabilityOptions stability;  ///< scene, about and what is common
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::string from;
  std::string to;
  int points = 1001;
  std::string scale = "linear";
  std::vector<std::string> files;
  std::optional<std::string> figure;
  std::optional<std::string> measured;
  std::vector<std::string> nodes;
  UniversalOptions universal;
  std::string command_line;
};

void check_files(const FrfOptions& options) {
  for (const std::string& file : options.files) {
    if (!is_universal(file) && fs::path(file).extension() != ".h5")
      throw ConfigError(Refusal::wrong_value, "-o",
                        fmt::format("'{}' ends neither in .h5 (HDF5) nor in .uff or .unv "
                                    "(universal file, dataset 58)",
                                    file));
    check_output(file, options.stability.common.overwrite());
  }
  if (options.figure) check_figure(*options.figure, options.stability.common);
  if (options.universal.is_given() && std::ranges::none_of(options.files, is_universal))
    throw ConfigError(Refusal::wrong_value, options.universal.is_binary ? "--binary" : "--single",
                      "is the form of universal files; name one with -o FILE.uff");
  if (!options.nodes.empty() && !options.measured)
    throw ConfigError(Refusal::wrong_value, "--node",
                      "names nodes of a measurement; give it with --compare");
}

std::vector<double> frequencies_of(const FrfOptions& options) {
  const NumericKey key{"frequency", "Hz", Range::non_negative()};
  const bool is_log = options.scale == "log";
  const double from = parse_value(key, options.from, "--from");
  const double to = parse_value(key, options.to, "--to");
  if (to < from)
    throw ConfigError(Refusal::wrong_value, "--to",
                      fmt::format("{:g} Hz lies below --from, {:g} Hz", to, from));
  return spaced_values(key, from, to, from == to ? 1 : options.points,
                       is_log ? Spacing::logarithmic : Spacing::linear);
}

/// The responses, and those measured that were set beside them.
struct FoundResponses {
  const FrfOptions& options;
  const ResponseStudy& study;
  std::vector<double> frequencies;
  std::vector<ResponseCurve> curves;
  std::vector<ComparedResponse> compared;
  std::vector<ComparedShapes> shapes;
  std::vector<std::string> remarks;
};

void write_files(const FoundResponses& found) {
  const FrfOptions& options = found.options;
  const StabilityOptions& stability = options.stability;
  for (const std::string& file : options.files) {
    if (is_universal(file)) {
      const UffContents contents = uff_contents(found.study, found.frequencies, found.curves);
      write_text_file(file, [&](const TextSink& sink) {
        write_uff(contents, "-o", sink, options.universal.numbers());
      });
      continue;
    }
    Attributes attributes = source_attributes(found.study.loaded(), options.command_line);
    attributes.emplace_back("about", stability.about);
    attributes.emplace_back("trusted_frequency", found.study.trusted_frequency());
    if (options.measured) attributes.emplace_back("measured", *options.measured);
    write_response_file(file, stability.common.overwrite(), found.frequencies, found.curves,
                        attributes, found.compared, found.shapes);
  }
}

/// Whether the modes that a run keeps leave anything out.
bool is_off(const ResponseCurve& curve) {
  return curve.truncation && *curve.truncation > 0.0;
}

void draw_responses(const FoundResponses& found) {
  const FrfOptions& options = found.options;
  ResponsePicture picture(options.scale == "log");
  // Names are too long for a legend: it has numbers, the caption what they stand for.
  std::string names;
  int colour = 0;
  const auto next_label = [&](const ResponseCurve& curve) {
    names += fmt::format(" {}: {} per {}.", colour + 1, curve.output, curve.input);
    return std::to_string(colour + 1);
  };
  if (found.compared.empty()) {
    const auto [frequencies, curves] = resolved_curves(
        found.frequencies, found.curves,
        [&](const std::vector<double>& between) { return found.study.curves(between); });
    for (const ResponseCurve& curve : curves) {
      const std::string label = next_label(curve);
      picture.add(frequencies, curve, label, Mark::line, colour++);
    }
    for (std::size_t i = 0; i < found.curves.size(); ++i)
      if (is_off(found.curves[i]))
        picture.add_error(found.frequencies, found.curves[i], static_cast<int>(i));
  }
  const bool has_errors = found.compared.empty() && std::ranges::any_of(found.curves, is_off);
  for (const ComparedResponse& one : found.compared) {
    const std::string label = next_label(one.computed);
    const auto [frequencies, curves] =
        resolved_curves(one.frequencies, {one.computed}, [&](const std::vector<double>& between) {
          return std::vector{computed_beside(found.study, one, between)};
        });
    picture.add(one.frequencies, one.measured, "", Mark::points, 2 * colour + 1);
    picture.add(frequencies, curves.front(), label, Mark::line, 2 * colour);
    ++colour;
  }
  for (const ComparedShapes& shapes : found.shapes) picture.add_shapes(shapes);
  picture.draw(
      fmt::format(
          "Frequency responses about the {} geometry.{}{}{} {}, scene {}.", options.stability.about,
          names, found.compared.empty() ? "" : " Points: measured.",
          has_errors ? " Dashed: how far they are off with the modes that a run keeps." : "",
          fs::path(options.stability.scene).filename().string(), found.study.loaded().hash()),
      *options.figure);
}

/// Where the modes of a run leave most out.
std::size_t worst_of(const ResponseCurve& curve) {
  const std::vector<double>& errors = curve.truncation_error;
  return static_cast<std::size_t>(std::max_element(errors.begin(), errors.end()) - errors.begin());
}

/// Where a curve is largest.
std::size_t peak_of(const ResponseCurve& curve) {
  const auto less = [](const std::complex<double>& a, const std::complex<double>& b) {
    return std::abs(a) < std::abs(b);
  };
  return static_cast<std::size_t>(
      std::max_element(curve.values.begin(), curve.values.end(), less) - curve.values.begin());
}

Json numbers_json(const std::vector<std::complex<double>>& values, bool is_real) {
  Json list = Json::array();
  for (const std::complex<double>& value : values)
    list.push_back(number(is_real ? value.real() : value.imag()));
  return list;
}

Json numbers_json(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

Json shapes_json(const ComparedShapes& shapes) {
  Json object = {{"input", shapes.input},
                 {"outputs", shapes.outputs},
                 {"frequencies", shapes.frequencies},
                 {"mac", shapes.assurance},
                 {"measured_peaks", shapes.measured_peaks},
                 {"computed_peaks", shapes.computed_peaks},
                 {"peaks", Json::array()}};
  for (const PeakPair& pair : peak_pairs(shapes)) {
    const auto macs = shapes.peak_assurance.col(static_cast<Eigen::Index>(pair.measured));
    object["peaks"].push_back({{"measured", shapes.measured_peaks[pair.measured]},
                               {"computed", shapes.computed_peaks[pair.computed]},
                               {"mac", pair.assurance},
                               {"macs", std::vector<double>(macs.begin(), macs.end())}});
  }
  return object;
}

Json responses_json(const FoundResponses& found) {
  Json object = {{"about", found.options.stability.about},
                 {"window", {0.0, number(found.study.trusted_frequency())}},
                 {"frequencies", found.frequencies},
                 {"responses", Json::array()},
                 {"files", found.options.files},
                 {"remarks", found.remarks}};
  for (std::size_t i = 0; i < found.curves.size(); ++i) {
    const ResponseCurve& curve = found.curves[i];
    const std::size_t peak = peak_of(curve);
    object["responses"].push_back(
        {{"output", curve.output},
         {"input", curve.input},
         {"units", curve.units},
         {"peak",
          {{"frequency", found.frequencies[peak]},
           {"magnitude", number(std::abs(curve.values[peak]))}}},
         {"truncation", number_or_null(curve.truncation)},
         {"truncation_error",
          curve.truncation ? numbers_json(curve.truncation_error) : Json(nullptr)},
         {"real", numbers_json(curve.values, true)},
         {"imaginary", numbers_json(curve.values, false)}});
  }
  if (found.options.measured) {
    object["compared"] = Json::array();
    for (const ComparedResponse& one : found.compared) {
      object["compared"].push_back({{"output", one.computed.output},
                                    {"input", one.computed.input},
                                    {"source", one.source},
                                    {"frac", number(one.assurance)},
                                    {"ratio", number(one.ratio)},
                                    {"from", one.frequencies.front()},
                                    {"to", one.frequencies.back()},
                                    {"points", one.frequencies.size()}});
    }
    object["shapes"] = Json::array();
    for (const ComparedShapes& shapes : found.shapes)
      object["shapes"].push_back(shapes_json(shapes));
  }
  return object;
}

void print_shapes(const ComparedShapes& shapes) {
  const std::vector<PeakPair> pairs = peak_pairs(shapes);
  if (pairs.empty()) {
    fmt::print("\nno peak stands out of the {} responses to {}\n",
               shapes.measured_peaks.empty() ? "measured" : "computed", shapes.input);
    return;
  }
  fmt::print("\n{} directions move by a force at {}; where they move most\n", shapes.outputs.size(),
             shapes.input);
  fmt::print("{:>14} {:>14} {:>10} {:>7}\n", "measured, Hz", "computed, Hz", "difference", "MAC");
  for (const PeakPair& pair : pairs) {
    const double measured = shapes.measured_peaks[pair.measured];
    const double computed = shapes.computed_peaks[pair.computed];
    fmt::print("{:>14.3f} {:>14.3f} {:>8.2f} % {:>7.4f}\n", measured, computed,
               100.0 * (computed / measured - 1.0), pair.assurance);
  }
}

void print_responses(const FoundResponses& found) {
  const double trusted = found.study.trusted_frequency();
  for (std::size_t i = 0; i < found.curves.size(); ++i) {
    const ResponseCurve& curve = found.curves[i];
    const std::size_t peak = peak_of(curve);
    fmt::print("{} per {}: largest {:.4g} {} at {:.6g} Hz\n", curve.output, curve.input,
               std::abs(curve.values[peak]), curve.units, found.frequencies[peak]);
    if (!curve.truncation) continue;
    if (!(*curve.truncation > 0.0)) {
      fmt::print("  the same with the modes that a run keeps (time.retain)\n");
      continue;
    }
    const std::size_t worst = worst_of(curve);
    fmt::print(
        "  with the modes that a run keeps (time.retain): off by {:.2g}, most at {:.6g} Hz, by "
        "{:.2g} {}\n",
        *curve.truncation, found.frequencies[worst], curve.truncation_error[worst], curve.units);
  }
  fmt::print("{} frequencies from {:g} to {:g} Hz about the {} geometry\n", found.frequencies.size(),
             found.frequencies.front(), found.frequencies.back(), found.options.stability.about);
  if (found.frequencies.back() > trusted)
    fmt::print("above {:.6g} Hz the reduced bodies do not answer as the full ones; keep more modes\n",
               trusted);
  if (!found.compared.empty()) {
    fmt::print("\n{:<44} {:>6} {:>8}  {}\n", "measured", "FRAC", "ratio", "frequencies, Hz");
    for (const ComparedResponse& one : found.compared) {
      fmt::print("{:<44} {:>6.3f} {:>8.3f}  {:g} to {:g}\n",
                 one.computed.output + " per " + one.computed.input, one.assurance, one.ratio,
                 one.frequencies.front(), one.frequencies.back());
    }
  }
  for (const ComparedShapes& shapes : found.shapes) print_shapes(shapes);
  for (const std::string& remark : found.remarks) fmt::print("{}\n", remark);
  for (const std::string& file : found.options.files) fmt::print("{}\n", file);
  if (found.options.figure) fmt::print("{}\n", *found.options.figure);
}

ExitCode frf(FrfOptions options) {
  check_files(options);
  const std::vector<NodeName> names = parse_node_names(options.nodes);
  UffFunctions measured;
  if (options.measured) measured = read_uff_functions_file(*options.measured);
  StabilityOptions& stability = options.stability;
  LoadedScene loaded = load_scene(stability.scene, stability.common.sets);
  make_choices(stability, loaded.scene);
  try {
    require_bodies(loaded);
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  const std::vector<double> frequencies = frequencies_of(options);
  ResponsePlaces places = response_places(options.inputs, options.outputs, loaded.scene.model);
  const ResponseStudy study(std::move(loaded), stability.geometry(), std::move(places));
  FoundResponses found{options, study, frequencies, study.curves(frequencies), {}, {}, {}};
  study.add_truncation(frequencies, found.curves);
  if (options.measured) {
    found.remarks = measured.remarks;
    found.compared = compared_responses(study, measured, names, frequencies.front(),
                                        frequencies.back(), found.remarks);
    found.shapes = response_shapes(found.compared);
  }
  write_files(found);
  if (options.figure) draw_responses(found);
  if (stability.common.json) {
    print_json(responses_json(found));
  } else {
    print_responses(found);
  }
  return ExitCode::done;
}

}  // namespace

void add_frf_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<FrfOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "frf", "Frequency responses between points, about the equilibrium, friction included");
  verb->add_option("scene", options->stability.scene, "Scene file (YAML)")->required();
  verb->add_option("--input", options->inputs,
                   "Where and along what a force acts, <body>.<point>.<x|y|z>; may be repeated")
      ->required()
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--output", options->outputs,
                   "Motion that is wanted, <body>.<point>.<x|y|z>.<displacement|velocity|"
                   "acceleration>: receptance, mobility or accelerance; may be repeated; default: "
                   "the acceleration at each input")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--from", options->from, "Lowest frequency, Hz or with a unit")->required();
  verb->add_option("--to", options->to, "Highest frequency")->required();
  verb->add_option("--points", options->points, "Number of frequencies")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  verb->add_option("--scale", options->scale, "Frequencies at equal distances or at equal ratios")
      ->check(CLI::IsMember({"linear", "log"}))
      ->capture_default_str();
  verb->add_option("--about", options->stability.about,
                   "Geometry about which the system is linearised: undeformed, or that of the "
                   "deformed sliding equilibrium; default: undeformed, with contacts on the faces of "
                   "plates deformed")
      ->check(CLI::IsMember({"undeformed", "deformed"}));
  verb->add_option("-o", options->files,
                   "File to write: .h5 (HDF5), or .uff, .unv (universal file); may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  add_universal_options(*verb, options->universal);
  verb->add_option("--figure", options->figure,
                   "Picture of magnitude, phase and locus of the responses: .png, .svg or .pdf");
  verb->add_option(
      "--compare", options->measured,
      "Measured responses (universal file, dataset 58) to set beside: FRAC and ratio, and "
      "MAC where a force moves several points");
  verb->add_option("--node", options->nodes,
                   "Which point a node of the measurement is, NUMBER=BODY.POINT; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  add_scene_options(*verb, options->stability.common);
  add_json_option(*verb, options->stability.common);
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return frf(*options); }; });
}

}  // namespace stridor
