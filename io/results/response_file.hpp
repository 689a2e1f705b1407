// Frequency responses as an HDF5 file.
//
//     /                                      attributes: what was computed, of what and how
//     /frequency                             Hz
//     /responses/<output>/<input>/real       of the motion per force, [frequency]
//     /responses/<output>/<input>/imaginary  likewise
//     /responses/<output>/<input>/truncation how far it is off with the modes that a run keeps; one
//     number
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
};

/// "receptance", "mobility" or "accelerance" by the unit of a response; "response" of another unit.
std::string response_quantity(const std::string& units);

/// @param frequencies Hz
/// @throws FileError if the file exists, its folder is not writable, or anything cannot be written
void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes);

}  // namespace stridor
