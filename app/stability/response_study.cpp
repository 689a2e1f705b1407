#include "app/stability/response_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/assurance.hpp"
#include "app/stability/verdict.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"

namespace stridor {
namespace {

constexpr const char* motion_units[] = {"m/N", "m/s/N", "m/s^2/N"};

Channel motion_channel(const std::string& name, const char* option, const ModelParameters& model) {
  Channel channel = parse_channel(name, option, model);
  if (channel.point) return channel;
  throw ConfigError(Refusal::wrong_value, option,
                    fmt::format("'{}' is a quantity of a contact; frequency responses are "
                                "those of points of bodies",
                                name));
}

/// "pad.tip.y" of an input.
std::string input_name(const Channel& input) {
  return input.name.substr(0, input.name.rfind('.'));
}

void refuse_repeated(const std::vector<Channel>& channels, const char* option) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (channels[i].name == channels[j].name)
        throw ConfigError(Refusal::doubled_name, option,
                          fmt::format("'{}' is given twice", channels[i].name));
  }
}

LoadedScene observing(LoadedScene loaded, const ResponsePlaces& places) {
  for (const auto* channels : {&places.inputs, &places.outputs})
    for (const Channel& channel : *channels)
      loaded.observed.emplace_back(*channel.point, channel.key);
  return loaded;
}

/// The displacement of a channel on the modes.
/// @throws ConfigError if it is held
std::pair<int, int> displacement_of(const Model& model, const Channel& channel) {
  const Model::Point& point = model.points.at(*channel.point);
  const int row = point.rows.row(channel.direction);
  const std::string what = fmt::format("'{}.{}' along {}", channel.point->body,
                                       channel.point->point, "xyz"[channel.direction]);
  const Eigen::MatrixXd& rows = model.system.bodies[static_cast<std::size_t>(point.body)].modal.rows;
  if (row >= 0 && rows.row(row).cwiseAbs().maxCoeff() > 0.0) return {point.body, row};
  throw ConfigError(Refusal::motion_is_held, channel.key,
                    row < 0 ? fmt::format("{} does not move: '{}' moves in its plane alone", what,
                                          channel.point->body)
                            : fmt::format("{} does not move: a support holds it", what));
}

Eigen::MatrixXd rows_of(const Model& model, const std::vector<Channel>& channels) {
  std::vector<std::pair<int, int>> displacements;
  for (const Channel& channel : channels) displacements.push_back(displacement_of(model, channel));
  return rows_on_modes(model.system, displacements);
}

}  // namespace

ResponsePlaces response_places(const std::vector<std::string>& inputs,
                               const std::vector<std::string>& outputs,
                               const ModelParameters& model) {
  ResponsePlaces places;
  for (const std::string& input : inputs)
    places.inputs.push_back(motion_channel(input + ".displacement", "--input", model));
  for (const std::string& output : outputs)
    places.outputs.push_back(motion_channel(output, "--output", model));
  if (outputs.empty()) {
    for (const std::string& input : inputs)
      places.outputs.push_back(motion_channel(input + ".acceleration", "--input", model));
  }
  refuse_repeated(places.inputs, "--input");
  refuse_repeated(places.outputs, "--output");
  return places;
}

ResponseStudy::ResponseStudy(LoadedScene loaded, ContactGeometry geometry, ResponsePlaces places)
    : loaded_(observing(std::move(loaded), places)),
      places_(std::move(places)),
      family_(loaded_, {}) {
  const Activity solving("equilibrium");
  member_ = family_.at({});
  try {
    require_modes(*member_.model);
    loads_ = rows_of(*member_.model, places_.inputs);
    sensors_ = rows_of(*member_.model, places_.outputs);
  } catch (const ConfigError& error) {
    throw loaded_.located(error);
  }
  state_ = sliding_state_of(member_, geometry, kept_terms(loaded_.scene), "");
  trusted_ = stridor::trusted_frequency(member_.model->system);
}

std::vector<ResponseCurve> ResponseStudy::curves_of(const FrequencyResponse& response,
                                                    const std::vector<double>& frequencies) const {
  std::vector<ResponseCurve> curves;
  for (const Channel& output : places_.outputs) {
    for (const Channel& input : places_.inputs) {
      curves.push_back({output.name, input_name(input),
                        motion_units[static_cast<std::size_t>(output.derivative)],
                        {}});
      curves.back().values.reserve(frequencies.size());
    }
  }
  Activity sweeping("frequency responses");
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    throw_if_stopped();
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequencies[i]);
    const std::array<std::complex<double>, 3> derivative{1.0, s, s * s};
    const Eigen::MatrixXcd h = response.at(s);
    auto curve = curves.begin();
    for (Eigen::Index output = 0; output < h.rows(); ++output) {
      const auto order = places_.outputs[static_cast<std::size_t>(output)].derivative;
      for (Eigen::Index input = 0; input < h.cols(); ++input)
        (curve++)->values.push_back(derivative[static_cast<std::size_t>(order)] * h(output, input));
    }
    sweeping.report(static_cast<double>(i + 1) / static_cast<double>(frequencies.size()));
  }
  return curves;
}

std::vector<ResponseCurve> ResponseStudy::curves(const std::vector<double>& frequencies) const {
  return curves_of(FrequencyResponse(state_.pencil, loads_, sensors_), frequencies);
}

void ResponseStudy::add_truncation(const std::vector<double>& frequencies,
                                   std::vector<ResponseCurve>& curves) const {
  const auto& time = loaded_.scene.time;
  if (!time || !time->retain) return;
  const Eigen::Index num_loads = loads_.rows();
  const Eigen::Index num_sensors = sensors_.rows();
  Eigen::MatrixXd rows(num_loads + num_sensors, loads_.cols());
  rows << loads_, sensors_;
  const Pencil kept =
      retained(with_ports(state_.pencil, rows), member_.model->system, time);
  const Eigen::MatrixXd kept_rows = added_ports(kept, rows.rows());
  const std::vector<ResponseCurve> of_run =
      curves_of(FrequencyResponse(kept, kept_rows.topRows(num_loads), kept_rows.bottomRows(num_sensors)),
                frequencies);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    curves[c].truncation = response_difference(of_run[c].values, curves[c].values);
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      curves[c].truncation_error.push_back(std::abs(of_run[c].values[i] - curves[c].values[i]));
  }
}

}  // namespace stridor
