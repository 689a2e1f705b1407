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
//     /shapes/number, input                  of forces with several measured points, [shapes]
//     /shapes/<number>/frequency, mac        Hz, and at each
//     /shapes/<number>/measured_peak, computed_peak, peak_mac   Hz, [computed][measured]
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
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
  double assurance = 0.0;           ///< FRAC, see assurance_criterion()
  double ratio = 0.0;               ///< of the r.m.s., computed over measured
  std::string source;               ///< "file:line" of the measured one
};

/// The deflection shapes that the responses to one force show, at the points and along the
/// directions that were measured.
struct ComparedShapes {
  std::string input;                   ///< "<body>.<point>.<x|y|z>"
  std::vector<std::string> outputs;    ///< likewise, two or more
  std::vector<double> frequencies;     ///< Hz, those of all its measured responses
  std::vector<double> assurance;       ///< MAC of the two shapes at each
  std::vector<double> measured_peaks;  ///< Hz, of the mobility of all points together
  std::vector<double> computed_peaks;
  Eigen::MatrixXd peak_assurance;  ///< MAC of the shapes there, [computed peak][measured peak]
};

/// A measured peak beside the computed one that is taken to be the same.
struct PeakPair {
  std::size_t measured = 0;  ///< places in the lists of peaks
  std::size_t computed = 0;
  double assurance = 0.0;  ///< MAC of the shapes there
};

/// For every measured peak the computed one whose shape is most alike; of those that are as alike
/// to 0.05 the nearest in frequency. None where one of both has no peak.
std::vector<PeakPair> peak_pairs(const ComparedShapes& shapes);

/// "receptance", "mobility" or "accelerance" by the unit of a response; "response" of another unit.
std::string response_quantity(const std::string& units);

/// @param frequencies Hz
/// @param compared    measured responses that were set beside; none: there is no /compared
/// @param shapes      of these, where several belong to one force; none: there is no /shapes
/// @throws FileError if the file exists, its folder is not writable, or anything cannot be written
void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes,
                         const std::vector<ComparedResponse>& compared = {},
                         const std::vector<ComparedShapes>& shapes = {});

}  // namespace stridor
