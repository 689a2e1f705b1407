// Frequency responses as an HDF5 file.
//
//     /                                      attributes: what was computed, of what and how
//     /frequency                             Hz
//     /responses/<output>/<input>/real       of the motion per force, [frequency]
//     /responses/<output>/<input>/imaginary  likewise
//     /responses/<output>/<input>/truncation_error  how far it is off with the modes that a run
//                                            keeps, [frequency]; /truncation: of all, one number
//     /compared/number, output, input, source, frac, ratio   of measured responses, [compared]
//     /compared/<number>/frequency           Hz, and there
//     /compared/<number>/measured_real, measured_imaginary, computed_real, computed_imaginary
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/output_options.hpp"

namespace stridor {

/// The motion at one point per harmonic force at another, or the same, one.
struct ResponseCurve {
  std::string output;  ///< "<body>.<point>.<x|y|z>.<displacement|velocity|acceleration>"
  std::string input;   ///< "<body>.<point>.<x|y|z>"
  std::string units;   ///< "m/s^2/N"
  std::vector<std::complex<double>> values;  ///< one per frequency
  /// ‖h_kept − h‖/‖h‖ with the modes that a run keeps and the residual flexibility of the others;
  /// nothing where a run keeps all.
  std::optional<double> truncation{};
  /// |h_kept − h| at each frequency, in `units`; empty where a run keeps all.
  std::vector<double> truncation_error{};
};

/// A measured response and the same one of the scene.
struct ComparedResponse {
  ResponseCurve measured;
  ResponseCurve computed;           ///< at the frequencies of the measured one
  std::vector<double> frequencies;  ///< Hz
  double assurance = 0.0;           ///< FRAC, see response_assurance()
  double ratio = 0.0;               ///< of the r.m.s., computed over measured
  std::string source;               ///< "file:line" of the measured one
};

/// "receptance", "mobility" or "accelerance" by the unit of a response; "response" of another unit.
std::string response_quantity(const std::string& units);

/// @param frequencies Hz
/// @param compared    measured responses that were set beside; none: there is no /compared
/// @throws FileError if the file exists, its folder is not writable, or anything cannot be written
void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes,
                         const std::vector<ComparedResponse>& compared = {});

}  // namespace stridor
