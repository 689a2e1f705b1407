#include "substructures/bodies/spring_stiffness.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>


namespace stridor {
namespace {

/// Refuses a matrix that gives energy away in some direction.
template <class Parameters>
void check_spring_matrix(const Parameters& given, std::vector<Problem>& problems) {
  const auto refuse = [&](Refusal refusal, const char* text) {
    problems.push_back({refusal, "", text});
  };
  if (!given.is_given()) {
    refuse(
        Refusal::missing,
        "is empty; give a number, which acts along a direction, or some of xx, yy, zz, xy, yz, zx");
    return;
  }
  if (given.along) {
    for (const auto& [key, entry] :
         {std::pair("xx", given.xx), std::pair("yy", given.yy), std::pair("zz", given.zz),
          std::pair("xy", given.xy), std::pair("yz", given.yz), std::pair("zx", given.zx)}) {
      if (entry)
        problems.push_back(
            {Refusal::contradiction, key, "does not go with a number along a direction"});
    }
    return;
  }
  const Eigen::Matrix3d matrix = spring_matrix(given, Eigen::Vector3d::Zero());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pairs(matrix, Eigen::EigenvaluesOnly);
  constexpr double rounding = 1e-12;
  if (pairs.eigenvalues()(0) < -rounding * matrix.cwiseAbs().maxCoeff()) {
    refuse(
        Refusal::wrong_value,
        "is negative in some direction, so that it would be unstable by itself; the square of xy "
        "must not exceed xx yy, and so on");
  }
}

template <class Parameters>
Schema keys_of_matrix(const char* name, const char* unit) {
  const auto direct = [&](const char* doc) {
    return RealKey{
        .doc = doc, .unit = unit, .range = Range::non_negative(), .optional = true};
  };
  const auto coupling = [&](const char* doc) {
    return RealKey{.doc = doc, .unit = unit, .optional = true};
  };
  using P = SpringMatrixParameters;
  const auto of = [](std::optional<double> P::*member) {
    return static_cast<std::optional<double> Parameters::*>(member);
  };
  return SchemaOf<Parameters>(name)
      .real("along", of(&P::along), direct("Along the direction of the spring."))
      .real("xx", of(&P::xx), direct("Along x."))
      .real("yy", of(&P::yy), direct("Along y."))
      .real("zz", of(&P::zz), direct("Along z."))
      .real("xy", of(&P::xy), coupling("Between x and y."))
      .real("yz", of(&P::yz), coupling("Between y and z."))
      .real("zx", of(&P::zx), coupling("Between z and x."))
      .check(check_spring_matrix<Parameters>);
}

}  // namespace

const Schema& SpringMatrixParameters::schema() {
  static const Schema keys = keys_of_matrix<SpringMatrixParameters>("spring_matrix", "N m-1");
  return keys;
}

const Schema& DamperMatrixParameters::schema() {
  static const Schema keys = keys_of_matrix<DamperMatrixParameters>("damper_matrix", "N s m-1");
  return keys;
}

const Schema& SpringDirectionParameters::schema() {
  using P = SpringDirectionParameters;
  static const Schema keys =
      SchemaOf<P>("spring_direction")
          .real("angle", &P::angle,
                {.doc = "In the plane of x and y, against +x.", .unit = "rad", .optional = true})
          .real_list("vector", &P::vector,
                     {.doc = "Its components along x and y, or x, y and z.", .optional = true})
          .check([](const P& given, std::vector<Problem>& problems) {
            if (given.angle.has_value() == !given.vector.empty()) {
              problems.push_back({Refusal::contradiction, "",
                                  "is either an angle in the plane or a vector, [1, 0, 1]"});
              return;
            }
            if (given.angle) return;
            const auto size = given.vector.size();
            double square = 0.0;
            for (const double component : given.vector) square += component * component;
            if ((size != 2 && size != 3) || square == 0.0) {
              problems.push_back(
                  {Refusal::wrong_size, "", "must be two or three components, not all of them 0"});
            }
          });
  return keys;
}

Eigen::Vector3d SpringDirectionParameters::unit() const {
  if (angle) return {std::cos(*angle), std::sin(*angle), 0.0};
  return Eigen::Vector3d(vector[0], vector[1], vector.size() > 2 ? vector[2] : 0.0).normalized();
}

Eigen::Matrix3d spring_matrix(const SpringMatrixParameters& given, const Eigen::Vector3d& along) {
  if (given.along) return *given.along * along * along.transpose();
  const auto value = [](const std::optional<double>& entry) { return entry.value_or(0.0); };
  Eigen::Matrix3d matrix;
  matrix << value(given.xx), value(given.xy), value(given.zx),  //
      value(given.xy), value(given.yy), value(given.yz),        //
      value(given.zx), value(given.yz), value(given.zz);
  return matrix;
}

std::vector<Eigen::Vector3d> spring_directions(const SpringMatrixParameters& given,
                                               const Eigen::Vector3d& along) {
  if (given.along) return {along};
  const Eigen::Matrix3d matrix = spring_matrix(given, along);
  std::vector<Eigen::Vector3d> directions;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (matrix(axis, axis) != 0.0) directions.emplace_back(Eigen::Vector3d::Unit(axis));
  return directions;
}

}  // namespace stridor
