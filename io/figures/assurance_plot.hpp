// Modal assurance criteria of computed and measured modes as a picture.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace stridor {

/// A cell for each pair, dark where the shapes are alike.
struct AssurancePicture {
  Eigen::MatrixXd assurance;     ///< [computed mode][measured mode], from 0 to 1
  std::vector<double> computed;  ///< frequencies of the rows, Hz
  std::vector<double> measured;  ///< frequencies of the columns, Hz
};

/// Draws measured modes across and computed ones upwards, labelled by their frequencies, with the values
/// of 0.1 and more in their cells where there is room.
/// @throws std::invalid_argument if there is no mode, or not as many frequencies as rows and columns
/// @throws ConfigError, FileError as draw_figure()
void plot_assurance(const AssurancePicture& picture, const std::string& caption,
                    const std::filesystem::path& figure);

}  // namespace stridor
