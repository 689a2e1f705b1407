// Frequency responses of a scene between points of its bodies.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "analysis/low_pass.hpp"
#include "app/stability/sliding_state.hpp"
#include "io/results/response_file.hpp"
#include "io/scene/channels.hpp"
#include "solvers/eigenvalues/frequency_response.hpp"

namespace stridor {

/// The forces and motions of a study, as the user named them.
struct ResponsePlaces {
  std::vector<Channel> inputs;   ///< displacements that the forces do work on
  std::vector<Channel> outputs;  ///< motions that are wanted
};

/// Inputs "<body>.<point>.<x|y|z>" and outputs "<body>.<point>.<x|y|z>.<motion>"; where none is
/// given, the acceleration at each input.
/// @throws ConfigError at --input or --output
ResponsePlaces response_places(const std::vector<std::string>& inputs,
                               const std::vector<std::string>& outputs,
                               const ModelParameters& model);

/// A scene about its equilibrium, ready to be asked for responses.
class ResponseStudy {
 public:
  /// @param loaded its `observed` are set
  /// @throws ConfigError if a point does not exist or does not move in a direction, or the bodies are
  ///         not reduced; NumericalError if there is no equilibrium
  ResponseStudy(LoadedScene loaded, ContactGeometry geometry, ResponsePlaces places);

  const LoadedScene& loaded() const { return loaded_; }
  const Model& model() const { return *member_.model; }
  const ResponsePlaces& places() const { return places_; }
  /// Up to where the bodies answer as the full ones, Hz.
  double trusted_frequency() const { return trusted_; }

  /// Every output per every input, outputs first.
  /// @param frequencies Hz
  /// @throws Interrupted on request
  std::vector<ResponseCurve> curves(const std::vector<double>& frequencies) const;
  /// Adds to curves() how far they are off with the modes that a run keeps (time.retain) and the
  /// residual flexibility of the others; leaves them as they are where a run keeps all.
  void add_truncation(const std::vector<double>& frequencies,
                      std::vector<ResponseCurve>& curves) const;

 private:
  std::vector<ResponseCurve> curves_of(const FrequencyResponse& response,
                                       const std::vector<double>& frequencies) const;

  LoadedScene loaded_;
  ResponsePlaces places_;
  SceneFamily family_;
  SceneFamily::Member member_;
  SlidingState state_;
  double trusted_ = 0.0;
  Eigen::MatrixXd loads_;
  Eigen::MatrixXd sensors_;
};

}  // namespace stridor
