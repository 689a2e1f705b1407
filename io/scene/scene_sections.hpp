// Sections of a scene besides its model: what a run records, measures and keeps, how its pictures
// are made, and what is expected of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/spectrogram.hpp"
#include "core/schema.hpp"

namespace stridor {

/// What is recorded of a run.
struct RecordParameters {
  double interval = 0.0;  ///< between samples, s, a multiple of time.step
  std::vector<std::string>
      channels;         ///< "<body>.<point>.<x|y>.<displacement|velocity|acceleration>",
                        ///< "<contact>.<quantity>"
  bool energy = false;  ///< the energy ledger
  static const Schema& schema();
};

/// Window and band of the statistics.
struct MeasureParameters {
  double from = 0.0;         ///< s
  std::optional<double> to;  ///< s; the end of the run where absent
  std::vector<double> band;  ///< two frequencies, Hz; empty: no band-pass
  static const Schema& schema();
};

/// When the state of a run is stored, so that it can go on after a kill.
struct CheckpointParameters {
  double every = 60.0;  ///< s of wall time
  static const Schema& schema();
};

/// How `cycle` seeks the periodic motion that the scene settles to.
struct CycleParameters {
  double settle = 0.0;  ///< s, > 0
  static const Schema& schema();
};

/// How the spectrogram of a run is made, where its command line does not say otherwise.
struct SpectrogramSection {
  std::optional<std::string> channel;  ///< one of record.channels
  WindowKind window = WindowKind::hann;
  std::optional<double> length;         ///< of a piece, s
  double overlap = 0.75;                ///< part of a piece shared with the next
  std::optional<double> max_frequency;  ///< Hz, end of the picture
  static const Schema& schema();
};

/// One expected result of a scene, checked by `run --verify`.
struct Expectation {
  std::string result;  ///< path in the JSON object of a verb, e.g. "contact_force.min"
  double value = 0.0;
  double tolerance = 0.0;  ///< largest allowed |result − value|
  static const Schema& schema();
};

}  // namespace stridor
