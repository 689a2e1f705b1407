// What a modal test delivers: places, frequencies, damping and shapes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// One measured mode, in SI units.
struct TestMode {
  std::int64_t number = 0;     ///< as the file has it
  double frequency = 0.0;      ///< undamped, Hz
  double damping_ratio = 0.0;  ///< viscous; half of a hysteretic loss factor
  double modal_mass = 0.0;     ///< kg, of the shape as it stands; of a complex one |a|/(2 ω_d)
  bool is_complex = false;
  std::map<std::int64_t, std::array<std::complex<double>, 3>> shape;  ///< x, y, z by label of node
  std::string source;  ///< where it stands, "FILE:LINE"
};

/// An element, with the labels of its nodes in the order of its shape.
struct TestElement {
  ElementShape shape = ElementShape::quad8;
  std::vector<std::int64_t> nodes;
};

struct ModalTest {
  std::map<std::int64_t, Eigen::Vector3d> nodes;  ///< places, m, by label
  /// What is drawn between nodes: labels in order. Not all of them need have a place.
  std::vector<std::vector<std::int64_t>> lines{};
  std::vector<TestElement> elements{};
  std::vector<TestMode> modes;                    ///< in the order of the file
  std::vector<std::string> remarks;               ///< what was taken to be so though the file does not say it
};

}  // namespace stridor
