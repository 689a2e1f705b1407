#include "substructures/bodies/modes_body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "substructures/bodies/drawn_test.hpp"
#include "substructures/bodies/realised_shape.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"
#include "substructures/reduction/proportional_damping.hpp"

namespace stridor {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr std::array<const char*, 3> direction_names{"x", "y", "z"};

/// Modes and where their shapes are known, with a column of `shapes` for each mode and three rows
/// for each port and for each measured node that is drawn besides.
class ModesBody {
 public:
  explicit ModesBody(const ModesBodyParameters& parameters) : parameters_(parameters) {
    for (const auto& [name, port] : parameters.ports) names_.push_back(name);
    find_places();
    choose_modes();
    find_drawn();
    fill_shapes();
    add_rigid();
    add_residual();
  }

  BodyMatrices make() const {
    const Eigen::Index n = omega_.size();
    BodyMatrices body;
    body.is_modal = true;
    body.mass.resize(n, n);
    body.mass.setIdentity();
    const Eigen::MatrixXd squares = omega_.array().square().matrix().asDiagonal();
    body.stiffness = squares.sparseView();
    const Eigen::MatrixXd rates = (2.0 * ratio_.array() * omega_.array()).matrix().asDiagonal();
    const SparseMatrix velocity = rates.sparseView();
    if (const auto damping = proportional_damping(velocity, body.mass, body.stiffness)) {
      body.damping = *damping;
    } else {
      body.velocity = velocity;
      body.circulatory = SparseMatrix(n, n);
    }
    if (parameters_.complete_up_to) body.lowest_omitted = two_pi * *parameters_.complete_up_to;
    add_nodes(body);
    body.outlines = drawn_.lines;
    add_surfaces(body);
    return body;
  }

 private:
  const ModalTest& test(const std::string& key) const {
    if (parameters_.file.empty())
      throw ConfigError(Refusal::contradiction, key,
                        "is of a `file`; give one, or the shapes themselves");
    if (!parameters_.test) throw std::invalid_argument("ModesBodyParameters: the file has not been read");
    return *parameters_.test;
  }

  void find_places() {
    for (const std::string& name : names_) {
      const ModesPortParameters& port = parameters_.ports.at(name);
      Eigen::Vector3d at = Eigen::Vector3d::Zero();
      if (!port.at.empty()) {
        for (std::size_t i = 0; i < port.at.size(); ++i) at(static_cast<Eigen::Index>(i)) = port.at[i];
      } else if (port.node) {
        const std::string key = "ports." + name + ".node";
        const auto& nodes = test(key).nodes;
        const auto node = nodes.find(*port.node);
        if (node == nodes.end()) {
          throw ConfigError(Refusal::wrong_value, key,
                            fmt::format("the file has no place of a node {} (datasets 15, 2411); "
                                        "give `at`",
                                        *port.node));
        }
        at = node->second;
      }
      places_.push_back(at);
    }
  }

  void choose_modes() {
    if (!parameters_.frequencies.empty()) {
      num_given_ = static_cast<Eigen::Index>(parameters_.frequencies.size());
      omega_ = two_pi * Eigen::Map<const Eigen::VectorXd>(parameters_.frequencies.data(), num_given_);
    } else if (!parameters_.file.empty()) {
      const std::vector<TestMode>& all = test("file").modes;
      if (parameters_.take.empty()) {
        for (const TestMode& mode : all) measured_.push_back(&mode);
      }
      for (const double number : parameters_.take) measured_.push_back(&mode_of_number(number, all));
      num_given_ = static_cast<Eigen::Index>(measured_.size());
      omega_.resize(num_given_);
      for (Eigen::Index i = 0; i < num_given_; ++i)
        omega_(i) = two_pi * measured_[static_cast<std::size_t>(i)]->frequency;
    }
    ratio_ = per_mode(parameters_.damping_ratios, "damping_ratios",
                      [](const TestMode& mode) { return mode.damping_ratio; }, 0.0);
    masses_ = per_mode(parameters_.modal_masses, "modal_masses",
                       [](const TestMode& mode) { return mode.modal_mass; }, 1.0);
    for (Eigen::Index i = 0; i < num_given_; ++i) {
      const std::string of = measured_.empty() ? fmt::format("mode {}", i + 1) : source_of(i);
      if (!(masses_(i) > 0.0)) {
        throw ConfigError(Refusal::wrong_value, "modal_masses",
                          fmt::format("{} has the modal mass {:g} kg: it must be positive; "
                                      "give the masses here where the file has none",
                                      of, masses_(i)));
      }
      if (!(ratio_(i) >= 0.0 && ratio_(i) < 1.0)) {
        throw ConfigError(Refusal::wrong_value, "damping_ratios",
                          fmt::format("{} has the damping ratio {:g}: it must be at least 0 "
                                      "and below 1",
                                      of, ratio_(i)));
      }
    }
  }

  static const TestMode& mode_of_number(double number, const std::vector<TestMode>& all) {
    std::vector<std::int64_t> numbers;
    for (const TestMode& mode : all) {
      if (static_cast<double>(mode.number) == number) return mode;
      numbers.push_back(mode.number);
    }
    throw ConfigError(
        Refusal::unknown_name, "take",
        fmt::format("the file has no mode {:g} (there are: {})", number, fmt::join(numbers, ", ")));
  }

  std::string source_of(Eigen::Index mode) const {
    const TestMode& one = *measured_[static_cast<std::size_t>(mode)];
    return fmt::format("mode {} ({})", one.number, one.source);
  }

  template <class OfFile>
  Eigen::VectorXd per_mode(const std::vector<double>& given, const char* key, const OfFile& of_file,
                           double otherwise) const {
    if (given.size() == 1) return Eigen::VectorXd::Constant(num_given_, given.front());
    if (!given.empty()) {
      check_count(given, key);
      return Eigen::Map<const Eigen::VectorXd>(given.data(), num_given_);
    }
    Eigen::VectorXd values = Eigen::VectorXd::Constant(num_given_, otherwise);
    for (std::size_t i = 0; i < measured_.size(); ++i)
      values(static_cast<Eigen::Index>(i)) = of_file(*measured_[i]);
    return values;
  }

  void check_count(const std::vector<double>& given, const std::string& key) const {
    if (static_cast<Eigen::Index>(given.size()) == num_given_) return;
    throw ConfigError(Refusal::wrong_size, key,
                      fmt::format("has {} numbers; expected one for each of the {} modes",
                                  given.size(), num_given_));
  }

  void find_drawn() {
    if (!parameters_.test) return;
    std::map<std::int64_t, std::size_t> ports;
    for (std::size_t p = 0; p < names_.size(); ++p)
      if (const auto& node = parameters_.ports.at(names_[p]).node) ports.emplace(*node, p);
    drawn_ = drawn_test(*parameters_.test, measured_, std::move(ports), names_.size());
    for (const std::int64_t label : drawn_.labels)
      places_.push_back(parameters_.test->nodes.at(label));
    for (const TestMode* mode : measured_) turns_.push_back(std::polar(1.0, -realise(*mode).phase));
  }

  void fill_shapes() {
    shapes_ = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(places_.size()), num_given_);
    moves_.assign(3 * places_.size(), false);
    for (std::size_t i = 0; i < drawn_.labels.size(); ++i)
      take_values(names_.size() + i, drawn_.labels[i]);
    for (std::size_t p = 0; p < names_.size(); ++p) {
      const ModesPortParameters& port = parameters_.ports.at(names_[p]);
      const std::array<const std::vector<double>*, 3> given{&port.x, &port.y, &port.z};
      if (port.node) {
        take_measured(p, *port.node);
        continue;
      }
      for (std::size_t d = 0; d < 3; ++d) {
        if (given[d]->empty()) continue;
        check_count(*given[d], fmt::format("ports.{}.{}", names_[p], direction_names[d]));
        moves_[3 * p + d] = true;
        shapes_.row(row_of(p, d)) =
            Eigen::Map<const Eigen::RowVectorXd>(given[d]->data(), num_given_);
      }
    }
    shapes_ *= masses_.array().rsqrt().matrix().asDiagonal();
  }

  static Eigen::Index row_of(std::size_t port, std::size_t direction) {
    return static_cast<Eigen::Index>(3 * port + direction);
  }

  void take_measured(std::size_t p, std::int64_t node) {
    const std::string key = "ports." + names_[p] + ".node";
    (void)test(key);
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      const TestMode& mode = *measured_[i];
      const auto found = mode.shape.find(node);
      if (found == mode.shape.end()) {
        throw ConfigError(Refusal::missing, key,
                          fmt::format("{} has no values at node {}",
                                      source_of(static_cast<Eigen::Index>(i)), node));
      }
      require_real(mode, parameters_.complexity, source_of(static_cast<Eigen::Index>(i)));
    }
    take_values(p, node);
  }

  /// The values of every mode at a node that has them, turned to be as real as they can be.
  void take_values(std::size_t p, std::int64_t node) {
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      const auto& values = measured_[i]->shape.at(node);
      for (std::size_t d = 0; d < 3; ++d)
        shapes_(row_of(p, d), static_cast<Eigen::Index>(i)) = (turns_[i] * values[d]).real();
    }
    // A direction that no mode moves was not measured.
    for (std::size_t d = 0; d < 3; ++d) moves_[3 * p + d] = !shapes_.row(row_of(p, d)).isZero(0.0);
  }

  void append_mode(double omega, double ratio, const Eigen::VectorXd& shape) {
    const Eigen::Index n = omega_.size();
    omega_.conservativeResize(n + 1);
    ratio_.conservativeResize(n + 1);
    shapes_.conservativeResize(Eigen::NoChange, n + 1);
    omega_(n) = omega;
    ratio_(n) = ratio;
    shapes_.col(n) = shape;
  }

  /// Translations and rotations about the centre of mass, u = e and u = e × (x − c).
  void add_rigid() {
    if (!parameters_.rigid) return;
    const RigidMotionParameters& rigid = *parameters_.rigid;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rigid.centre.size(); ++i)
      centre(static_cast<Eigen::Index>(i)) = rigid.centre[i];
    const bool is_planar = rigid.inertia.size() == 1;
    const auto add = [&](double inertia, const auto& motion) {
      Eigen::VectorXd shape(shapes_.rows());
      for (std::size_t p = 0; p < places_.size(); ++p)
        shape.segment<3>(row_of(p, 0)) = motion(places_[p]) / std::sqrt(inertia);
      // Directions in which ports do not move stay so.
      for (std::size_t r = 0; r < moves_.size(); ++r)
        if (!moves_[r]) shape(static_cast<Eigen::Index>(r)) = 0.0;
      append_mode(0.0, 0.0, shape);
    };
    if (num_given_ == 0) allow_rigid_directions(is_planar);
    for (Eigen::Index d = 0; d < (is_planar ? 2 : 3); ++d)
      add(rigid.mass, [&](const Eigen::Vector3d&) { return Eigen::Vector3d(Eigen::Vector3d::Unit(d)); });
    for (Eigen::Index d = is_planar ? 2 : 0; d < 3; ++d) {
      const double inertia = rigid.inertia[is_planar ? 0 : static_cast<std::size_t>(d)];
      add(inertia, [&](const Eigen::Vector3d& at) {
        return Eigen::Vector3d(Eigen::Vector3d::Unit(d).cross(at - centre));
      });
    }
  }

  /// A rigid body moves everywhere.
  void allow_rigid_directions(bool is_planar) {
    for (std::size_t p = 0; p < places_.size(); ++p)
      for (std::size_t d = 0; d < (is_planar ? 2u : 3u); ++d) moves_[3 * p + d] = true;
  }

  void add_residual() {
    if (!parameters_.residual) return;
    const ResidualParameters& residual = *parameters_.residual;
    if (!parameters_.residual_flexibility)
      throw std::invalid_argument("ModesBodyParameters: the residual flexibility has not been read");
    const Eigen::MatrixXd F = *parameters_.residual_flexibility;
    const auto count = static_cast<Eigen::Index>(residual.on.size());
    if (F.rows() != count || F.cols() != count) {
      throw ConfigError(Refusal::wrong_size, "residual.flexibility",
                        fmt::format("is {} x {}; expected a row for each of the {} of `on`",
                                    F.rows(), F.cols(), count));
    }
    if ((F - F.transpose()).norm() > 1e-8 * F.norm())
      throw ConfigError(Refusal::wrong_matrix, "residual.flexibility", "must be symmetric");
    const double highest = omega_.size() > 0 ? omega_.maxCoeff() : 0.0;
    const double omega = residual.frequency ? two_pi * *residual.frequency : 10.0 * highest;
    if (!(omega > highest)) {
      throw ConfigError(Refusal::wrong_value, "residual.frequency",
                        fmt::format("must lie above the highest mode, {:g} Hz", highest / two_pi));
    }
    const SymmetricEigenpairs pairs = symmetric_eigenpairs(F, "residual flexibility");
    const double largest = pairs.values.cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < count; ++k) {
      const double f = pairs.values(k);
      if (f < -1e-8 * largest) {
        throw ConfigError(
            Refusal::wrong_matrix, "residual.flexibility",
            fmt::format("has the negative eigenvalue {:g} m/N: what is not among the modes must "
                        "yield to forces, not push back",
                        f));
      }
      if (f <= 1e-12 * largest) continue;
      Eigen::VectorXd shape = Eigen::VectorXd::Zero(shapes_.rows());
      for (Eigen::Index i = 0; i < count; ++i)
        shape(residual_row(residual.on[static_cast<std::size_t>(i)], static_cast<std::size_t>(i))) =
            omega * std::sqrt(f) * pairs.vectors(i, k);
      append_mode(omega, 0.0, shape);
    }
  }

  Eigen::Index residual_row(const std::string& name, std::size_t entry) const {
    const std::string key = fmt::format("residual.on.{}", entry);
    const std::size_t dot = name.rfind('.');
    const std::string port = name.substr(0, dot);
    const auto found = std::find(names_.begin(), names_.end(), port);
    const std::size_t d = dot + 2 == name.size() ? std::string("xyz").find(name.back()) : 3;
    if (dot == std::string::npos || d > 2)
      throw ConfigError(Refusal::wrong_value, key,
                        fmt::format("'{}' is not of the form <port>.<x|y|z>", name));
    if (found == names_.end()) {
      throw ConfigError(Refusal::unknown_name, key,
                        fmt::format("there is no port '{}'{} (there are: {})", port,
                                    did_you_mean(port, names_), fmt::join(names_, ", ")));
    }
    const auto p = static_cast<std::size_t>(found - names_.begin());
    if (!moves_[3 * p + d])
      throw ConfigError(Refusal::motion_is_held, key,
                        fmt::format("'{}' does not move along {}", port, direction_names[d]));
    return row_of(p, d);
  }

  void add_nodes(BodyMatrices& body) const {
    body.nodes.setZero(static_cast<Eigen::Index>(places_.size()), body.nodes.cols());
    bool moves_across = false;
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const auto node = static_cast<int>(p);
      body.nodes.row(node) = places_[p].head(body.nodes.cols()).transpose();
      body.node_dofs.push_back({BodyMatrices::held, BodyMatrices::held});
      std::array<DofSum, 3>& sums = body.dependent[node];
      for (std::size_t d = 0; d < 3; ++d) {
        for (Eigen::Index i = 0; i < omega_.size(); ++i) {
          const double weight = shapes_(row_of(p, d), i);
          if (weight != 0.0) sums[d].push_back({static_cast<int>(i), weight});
        }
      }
      moves_across = moves_across || !sums[2].empty();
      if (p < names_.size()) body.points[names_[p]] = node;
    }
    if (moves_across) body.across.assign(places_.size(), BodyMatrices::held);
  }

  void add_surfaces(BodyMatrices& body) const {
    for (const auto& [name, surface] : parameters_.surfaces) {
      const std::string key = "surfaces." + name;
      if (body.points.contains(name))
        throw ConfigError(Refusal::doubled_name, key, "a port has this name already; take another");
      std::vector<int>& nodes = body.surfaces[name];
      for (const std::string& point : surface.points) {
        const auto found = body.points.find(point);
        if (found == body.points.end()) {
          throw ConfigError(Refusal::unknown_name, key + ".points",
                            fmt::format("there is no port '{}'{} (there are: {})", point,
                                        did_you_mean(point, names_), fmt::join(names_, ", ")));
        }
        if (!nodes.empty() && (body.nodes.row(nodes.back()) - body.nodes.row(found->second)).norm() <= 0.0)
          throw ConfigError(Refusal::wrong_value, key + ".points",
                            fmt::format("'{}' stands where the port before it does", point));
        nodes.push_back(found->second);
      }
    }
  }

  const ModesBodyParameters& parameters_;
  std::vector<std::string> names_;  ///< of the ports
  DrawnTest drawn_;                 ///< of the file
  std::vector<Eigen::Vector3d> places_;    ///< of the ports, then of what is drawn besides
  std::vector<bool> moves_;                ///< by row of `shapes_`
  std::vector<const TestMode*> measured_;  ///< of the file; empty where the scene gives the modes
  std::vector<std::complex<double>> turns_;  ///< that make each of these as real as it can be
  Eigen::Index num_given_ = 0;             ///< modes of the scene or file
  Eigen::VectorXd omega_, ratio_, masses_;
  Eigen::MatrixXd shapes_;  ///< normalised to the mass
};

}  // namespace

BodyMatrices ModesBodyParameters::make() const {
  return ModesBody(*this).make();
}

}  // namespace stridor
