#include "app/stability/measured_responses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <span>
#include <string_view>

#include "analysis/assurance.hpp"
#include "analysis/response_peaks.hpp"
#include "app/results/universal_file.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// "pad.tip.-y" of a node and a direction of a file; nothing for other directions than x, y, z.
std::optional<std::pair<std::string, double>> direction_of(int direction) {
  const int along = std::abs(direction);
  if (along < 1 || along > 3) return std::nullopt;
  return std::pair(std::string(1, "xyz"[along - 1]), direction < 0 ? -1.0 : 1.0);
}

std::optional<int> derivative_of(int quantity) {
  switch (static_cast<UffQuantity>(quantity)) {
    case UffQuantity::displacement:
      return 0;
    case UffQuantity::velocity:
      return 1;
    case UffQuantity::acceleration:
      return 2;
    default:
      return std::nullopt;
  }
}

UffQuantity quantity_of(Derivative derivative) {
  return derivative == Derivative::none    ? UffQuantity::displacement
         : derivative == Derivative::first ? UffQuantity::velocity
                                           : UffQuantity::acceleration;
}

/// "pad.tip.y" of "pad.tip.y.acceleration".
std::string without_motion(const std::string& name) {
  return name.substr(0, name.rfind('.'));
}

/// A measured function as one of the curves of the study.
struct NamedFunction {
  const UffFunction* function = nullptr;
  std::string output, input;  ///< "<body>.<point>.<x|y|z>"
  int derivative = 0;         ///< of the displacement of the output
  double sign = 1.0;
};

class Naming {
 public:
  Naming(const ResponseStudy& study, const std::vector<NodeName>& names) : study_(study) {
    for (const NodeName& name : names) {
      if (!points_.emplace(name.node, name.point.body + "." + name.point.point).second)
        throw ConfigError(Refusal::doubled_name, "--node",
                          fmt::format("node {} has two names", name.node));
    }
  }

  /// @return why it is passed over; empty where it is named
  std::string name(const UffFunction& function, bool is_only_one, NamedFunction& named) const {
    named.function = &function;
    if (function.type != static_cast<int>(UffFunctionType::frequency_response))
      return fmt::format("is of type {}, not a frequency response (4)", function.type);
    const std::optional<int> derivative = derivative_of(function.ordinate_quantity);
    if (!derivative)
      return fmt::format("is of a quantity {}, neither displacement (8), velocity (11) nor acceleration (12)",
                         function.ordinate_quantity);
    if (function.denominator_quantity != static_cast<int>(UffQuantity::excitation_force))
      return fmt::format("is per a quantity {}, not a force (13)", function.denominator_quantity);
    named.derivative = *derivative;
    if (points_.empty() && is_only_one) {
      named.output = without_motion(study_.places().outputs.front().name);
      named.input = without_motion(study_.places().inputs.front().name);
      named.sign = sign_of(function.response) * sign_of(function.reference);
      return "";
    }
    const auto output = dof_name(function.response, named.sign);
    const auto input = dof_name(function.reference, named.sign);
    if (!output) return unnamed(function.response);
    if (!input) return unnamed(function.reference);
    named.output = *output;
    named.input = *input;
    return "";
  }

 private:
  static double sign_of(const UffDof& dof) { return dof.direction < 0 ? -1.0 : 1.0; }
  std::optional<std::string> dof_name(const UffDof& dof, double& sign) const {
    const auto point = points_.find(dof.node);
    const auto direction = direction_of(dof.direction);
    if (point == points_.end() || !direction) return std::nullopt;
    sign *= direction->second;
    return point->second + "." + direction->first;
  }
  static std::string unnamed(const UffDof& dof) {
    if (!direction_of(dof.direction))
      return fmt::format("is along direction {} of node {}, neither x, y nor z (1 to 3)",
                         dof.direction, dof.node);
    return fmt::format("is of node {}, which no --node names", dof.node);
  }

  const ResponseStudy& study_;
  std::map<std::int64_t, std::string> points_;
};

/// The stretch of a function within a range.
ComparedResponse stretch_of(const NamedFunction& named, double from, double to) {
  ComparedResponse compared;
  const UffFunction& function = *named.function;
  compared.source = function.source;
  compared.measured = {named.output, named.input, "", {}};
  for (std::size_t i = 0; i < function.abscissa.size(); ++i) {
    const double frequency = function.abscissa[i];
    if (!(frequency > 0.0 && frequency >= from && frequency <= to)) continue;
    compared.frequencies.push_back(function.abscissa[i]);
    compared.measured.values.push_back(named.sign * function.values[i]);
  }
  return compared;
}

double root_mean_square(const std::vector<std::complex<double>>& values) {
  double sum = 0.0;
  for (const std::complex<double>& value : values) sum += std::norm(value);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

constexpr const char* motions_of_responses[] = {"displacement", "velocity", "acceleration"};
constexpr const char* units_of_responses[] = {"m/N", "m/s/N", "m/s^2/N"};

/// 0, 1, 2 for a displacement, velocity or acceleration per force.
int derivative_of(const ResponseCurve& curve) {
  const auto* found = std::find(std::begin(units_of_responses), std::end(units_of_responses),
                                std::string_view(curve.units));
  return static_cast<int>(found - std::begin(units_of_responses));
}

/// The response between two points of a scene as a displacement, velocity or acceleration.
ResponseCurve response_between(const ResponseStudy& study, const std::string& output,
                               const std::string& input, int derivative,
                               const std::vector<double>& frequencies) {
  for (ResponseCurve& curve : study.curves(frequencies)) {
    if (without_motion(curve.output) != output || curve.input != input) continue;
    const int order = derivative_of(curve);
    for (std::size_t i = 0; i < curve.values.size(); ++i) {
      const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequencies[i]);
      curve.values[i] *= std::pow(s, derivative - order);
    }
    const auto motion = static_cast<std::size_t>(derivative);
    curve.output = output + "." + motions_of_responses[motion];
    curve.units = units_of_responses[motion];
    return std::move(curve);
  }
  return {};
}

/// Computes what belongs to a measured response: the curve between the same points as the same
/// motion.
void compute(const ResponseStudy& study, const NamedFunction& named, ComparedResponse& compared) {
  compared.computed =
      response_between(study, named.output, named.input, named.derivative, compared.frequencies);
  compared.measured.output = compared.computed.output;
  compared.measured.units = compared.computed.units;
  compared.assurance = assurance_criterion(compared.computed.values, compared.measured.values);
  compared.ratio = root_mean_square(compared.computed.values) /
                   root_mean_square(compared.measured.values);
}

/// Responses to one force at the same frequencies, of different points or directions.
using Points = std::vector<const ComparedResponse*>;

/// The same but for rounding of text.
bool are_alike(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(
      a, b, [](double x, double y) { return std::abs(x - y) <= 1e-6 * std::max(x, y); });
}

std::vector<Points> points_by_force(const std::vector<ComparedResponse>& compared) {
  std::vector<Points> forces;
  for (const ComparedResponse& one : compared) {
    const auto goes_with = [&](const Points& points) {
      return points.front()->computed.input == one.computed.input &&
             are_alike(points.front()->frequencies, one.frequencies);
    };
    const auto force = std::find_if(forces.begin(), forces.end(), goes_with);
    if (force == forces.end()) {
      forces.push_back({&one});
      continue;
    }
    // A point that was measured twice, or as two motions, counts once.
    const auto is_same = [&](const ComparedResponse* known) {
      return without_motion(known->computed.output) == without_motion(one.computed.output);
    };
    if (std::ranges::none_of(*force, is_same)) force->push_back(&one);
  }
  std::erase_if(forces, [](const Points& points) { return points.size() < 2; });
  return forces;
}

/// The velocities of all points per force, [point][frequency].
Eigen::MatrixXcd velocities(const Points& points, const ResponseCurve ComparedResponse::*which) {
  const std::vector<double>& frequencies = points.front()->frequencies;
  Eigen::MatrixXcd all(static_cast<Eigen::Index>(points.size()),
                       static_cast<Eigen::Index>(frequencies.size()));
  for (std::size_t p = 0; p < points.size(); ++p) {
    const ResponseCurve& curve = points[p]->*which;
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequencies[i]);
      all(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(i)) =
          curve.values[i] * std::pow(s, 1 - derivative_of(curve));
    }
  }
  return all;
}

/// Where the points together move most, as places in the list of frequencies.
std::vector<std::size_t> peaks_of(const Eigen::MatrixXcd& velocities) {
  constexpr double stands_out = 2.0;
  constexpr std::size_t most = 60;
  const Eigen::VectorXd level = velocities.colwise().norm();
  return response_peaks(std::span(level.data(), static_cast<std::size_t>(level.size())), stands_out,
                        most);
}

double assurance_of(const Eigen::MatrixXcd& a, std::size_t i, const Eigen::MatrixXcd& b,
                    std::size_t j) {
  const auto shape = [](const Eigen::MatrixXcd& all, std::size_t at) {
    return std::span(all.col(static_cast<Eigen::Index>(at)).data(),
                     static_cast<std::size_t>(all.rows()));
  };
  return assurance_criterion(shape(a, i), shape(b, j));
}

bool is_of_study(const ResponseStudy& study, const NamedFunction& named) {
  const auto has = [](const std::vector<Channel>& channels, const std::string& name) {
    return std::any_of(channels.begin(), channels.end(),
                       [&](const Channel& one) { return without_motion(one.name) == name; });
  };
  return has(study.places().inputs, named.input) && has(study.places().outputs, named.output);
}

}  // namespace

std::vector<NodeName> parse_node_names(const std::vector<std::string>& words) {
  std::vector<NodeName> names;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const std::size_t dot = word.find('.', equals == std::string::npos ? 0 : equals);
    NodeName name;
    const char* end = word.data() + std::min(equals, word.size());
    const auto [at, error] = std::from_chars(word.data(), end, name.node);
    if (equals == std::string::npos || dot == std::string::npos || error != std::errc{} || at != end)
      throw ConfigError(Refusal::wrong_value, "--node",
                        fmt::format("expected NUMBER=BODY.POINT, got '{}'", word));
    name.point = {word.substr(equals + 1, dot - equals - 1), word.substr(dot + 1)};
    names.push_back(std::move(name));
  }
  return names;
}

std::vector<ComparedResponse> compared_responses(const ResponseStudy& study,
                                                 const UffFunctions& measured,
                                                 const std::vector<NodeName>& names, double from,
                                                 double to, std::vector<std::string>& remarks) {
  const Naming naming(study, names);
  const bool is_only_one = measured.functions.size() == 1 && study.places().inputs.size() == 1 &&
                           study.places().outputs.size() == 1;
  std::vector<ComparedResponse> all;
  for (const UffFunction& function : measured.functions) {
    NamedFunction named;
    std::string reason = naming.name(function, is_only_one, named);
    if (reason.empty() && !is_of_study(study, named)) {
      reason = fmt::format("is {} per {}, which neither --input nor --output asks for", named.output,
                           named.input);
    }
    if (!reason.empty()) {
      remarks.push_back(fmt::format("{}: {}", function.source, reason));
      continue;
    }
    ComparedResponse compared = stretch_of(named, from, to);
    if (compared.frequencies.empty()) {
      remarks.push_back(fmt::format("{}: has no values from {:g} to {:g} Hz", function.source, from, to));
      continue;
    }
    compute(study, named, compared);
    all.push_back(std::move(compared));
  }
  if (!all.empty()) return all;
  std::string text = "nothing of the file can be compared with the responses of the scene";
  for (const std::string& remark : remarks) text += "\n  " + remark;
  throw ConfigError(Refusal::wrong_value, "--compare", text);
}

ResponseCurve computed_beside(const ResponseStudy& study, const ComparedResponse& compared,
                              const std::vector<double>& frequencies) {
  return response_between(study, without_motion(compared.computed.output), compared.computed.input,
                          derivative_of(compared.computed), frequencies);
}

std::vector<ComparedShapes> response_shapes(const std::vector<ComparedResponse>& compared) {
  std::vector<ComparedShapes> all;
  for (const Points& points : points_by_force(compared)) {
    ComparedShapes shapes;
    shapes.input = points.front()->computed.input;
    for (const ComparedResponse* one : points)
      shapes.outputs.push_back(without_motion(one->computed.output));
    shapes.frequencies = points.front()->frequencies;
    const Eigen::MatrixXcd measured = velocities(points, &ComparedResponse::measured);
    const Eigen::MatrixXcd computed = velocities(points, &ComparedResponse::computed);
    for (std::size_t i = 0; i < shapes.frequencies.size(); ++i)
      shapes.assurance.push_back(assurance_of(computed, i, measured, i));
    const std::vector<std::size_t> of_measured = peaks_of(measured);
    const std::vector<std::size_t> of_computed = peaks_of(computed);
    shapes.peak_assurance.resize(static_cast<Eigen::Index>(of_computed.size()),
                                 static_cast<Eigen::Index>(of_measured.size()));
    for (const std::size_t peak : of_computed)
      shapes.computed_peaks.push_back(shapes.frequencies[peak]);
    for (std::size_t m = 0; m < of_measured.size(); ++m) {
      shapes.measured_peaks.push_back(shapes.frequencies[of_measured[m]]);
      for (std::size_t c = 0; c < of_computed.size(); ++c)
        shapes.peak_assurance(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(m)) =
            assurance_of(computed, of_computed[c], measured, of_measured[m]);
    }
    all.push_back(std::move(shapes));
  }
  return all;
}

UffContents uff_contents(const ResponseStudy& study, const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves) {
  UffContents contents = headed_contents("frequency responses of " + study.loaded().path);
  PointNodes points;
  const auto dof_of = [&](const Channel& channel) {
    return points.dof(channel.point->body + "." + channel.point->point, channel.direction);
  };
  std::size_t i = 0;
  for (const Channel& output : study.places().outputs) {
    for (const Channel& input : study.places().inputs) {
      UffFunction function;
      function.type = static_cast<int>(UffFunctionType::frequency_response);
      function.id = curves[i].output + " per " + curves[i].input;
      function.response = dof_of(output);
      function.reference = dof_of(input);
      function.abscissa_quantity = static_cast<int>(UffQuantity::frequency);
      function.ordinate_quantity = static_cast<int>(quantity_of(output.derivative));
      function.denominator_quantity = static_cast<int>(UffQuantity::excitation_force);
      function.is_complex = true;
      function.abscissa = frequencies;
      function.values = curves[i++].values;
      contents.functions.push_back(std::move(function));
    }
  }
  contents.nodes = points.placed(study.loaded());
  return contents;
}

}  // namespace stridor
