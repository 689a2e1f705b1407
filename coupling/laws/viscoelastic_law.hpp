// Contact laws of a sliding indenter on a viscoelastic half-space: pure functions of indentation
// and speed.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace stridor {

/// A quantity of a contact law with its derivatives.
struct LawValue {
  double value = 0.0;
  double by_indentation = 0.0;  ///< ∂/∂ŷ
  double by_speed = 0.0;        ///< ∂/∂|v̂|
};

/// Range of a law in which a point lies.
enum class LawRange {
  inside,
  no_contact,   ///< ŷ ≤ 0: everything vanishes
  too_deep,     ///< ŷ above the range of the law: a continuation
  beyond_data,  ///< |v̂| or ŷ outside the data behind the law: a continuation or a limit
};

/// Values of a law for one contact, all dimensionless: F̃ = F/(E_0* R²), Ã = A/R², μ.
struct ViscoelasticContact {
  LawValue force;
  LawValue area;
  LawValue friction;
  LawRange range = LawRange::inside;
};

/// Force, area and viscoelastic friction of a contact that slides steadily (docs/theory.md, 8.4).
///
/// Never clamped: outside its range a law is continued and reports it.
class ViscoelasticContactLaw {
 public:
  virtual ~ViscoelasticContactLaw() = default;
  /// @param indentation ŷ = y/R; ≤ 0 out of contact
  /// @param speed       v̂ = v τ/R of either sign; only |v̂| matters, and friction is its magnitude.
  ///                    The derivative with respect to v̂ itself is by_speed times the sign of v̂.
  virtual ViscoelasticContact at(double indentation, double speed) const = 0;
};

/// Coefficients of the functional forms of PPH, equations (34), (36) and (38).
struct FitCoefficients {
  std::array<double, 5> force{};     ///< a_1 … a_5
  std::array<double, 5> area{};      ///< b_1 … b_5
  std::array<double, 4> friction{};  ///< c_1 … c_4
};

/// Those of PPH (35), (37), (39), as printed.
FitCoefficients published_coefficients();

/// The functional forms of PPH:
///
///     F̃ = a₁ ŷ^{3/2} ½ (a₂ + erf(a₃ lg v̂ + a₄ lg ŷ + a₅))
///     Ã = b₁ ŷ (b₂ − exp(−(lg v̂ − b₃ lg ŷ − b₄)²/(2 b₅²)))
///     μ = c₁ ŷ^{1/2} exp(−(lg v̂ − c₂ lg ŷ − c₃)²/(2 c₄²))
///
/// with lg the decimal logarithm; at v̂ = 0 their limits, with derivatives 0. Above ŷ = 0.3
/// `too_deep`.
class FittedLaw : public ViscoelasticContactLaw {
 public:
  explicit FittedLaw(const FitCoefficients& coefficients) : c_(coefficients) {}
  ViscoelasticContact at(double indentation, double speed) const override;

 private:
  FitCoefficients c_;
};

/// One contact of a paraboloid in the numbers on which all of them collapse:
/// β = v̂/ŷ^½, F̃ = ŷ^{3/2} f, Ã = ŷ g, μ = ŷ^{1/2} m.
struct MasterPoint {
  double beta = 0.0;
  double force = 0.0;            ///< f
  double area = 0.0;             ///< g
  double friction = 0.0;         ///< m
  double memory_in_cells = 0.0;  ///< v τ over the side of a cell of the grid behind it
};

/// Contacts of a paraboloid on a material with one creep time.
struct MasterCurve {
  double modulus_ratio = 0.0;       ///< e_0 = E_0/E_∞, in (0, 1)
  std::vector<MasterPoint> points;  ///< by ascending β
};

/// The curve for e_0 = 0.1 that comes with the program, made by `stridor contact --master-curve`.
const MasterCurve& shipped_master_curve();

/// A quantity over β ≥ 0: a cubic spline in ln β through points, and beyond them power laws to
/// known limits, q_0 + (q_1 − q_0)(β/β_1)^p and q_∞ + (q_n − q_∞) β_n/β, joined with continuous
/// slope.
class LimitedSpline {
 public:
  /// @param beta  > 0, ascending, at least 3
  /// @param q     as many
  /// @param power p of the lower end, 1 or 2
  /// @throws std::invalid_argument if they are not
  LimitedSpline(const std::vector<double>& beta, std::vector<double> q, double lower_limit,
                int power, double upper_limit);

  struct Value {
    double value = 0.0;
    double slope = 0.0;  ///< d/dβ
  };
  /// @param beta ≥ 0
  Value at(double beta) const;

 private:
  std::vector<double> x_;  ///< ln β
  std::vector<double> q_;
  std::vector<double> slopes_;  ///< dq/dx
  double lower_limit_;
  int power_;
  double upper_limit_;
};

/// The law of the boundary-element contacts of a paraboloid with one creep time: the collapse on β
/// is exact, so one curve gives all indentations and speeds, with analytic derivatives.
///
/// Limits: f → 4/3, g → π, m → (1 − e_0) β for β → 0 and f → 4/(3 e_0), g → π,
/// m → 0.8 (1/e_0 − 1)/β for β → ∞; friction is interpolated as its ratio to a function that has
/// both. Points whose edge layer v τ is below eight cells are left to the limits. Outside the
/// points in β `beyond_data`, though the limits hold there; above ŷ = 0.3 `too_deep`.
class BoundaryElementLaw : public ViscoelasticContactLaw {
 public:
  /// @throws std::invalid_argument if fewer than three points are resolved, or the modulus ratio is
  /// not
  ///         in (0, 1)
  explicit BoundaryElementLaw(const MasterCurve& curve);
  ViscoelasticContact at(double indentation, double speed) const override;

 private:
  /// m over its ratio to the function with both limits, β a/(1 + (a/b) β²).
  LimitedSpline::Value friction_scale(double beta) const;

  double first_beta_ = 0.0;
  double last_beta_ = 0.0;
  double slow_slope_ = 0.0;  ///< a = 1 − e_0
  double fast_slope_ = 0.0;  ///< b = 0.8 (1/e_0 − 1)
  std::unique_ptr<LimitedSpline> force_;
  std::unique_ptr<LimitedSpline> area_;
  std::unique_ptr<LimitedSpline> friction_ratio_;
};

/// Contacts of any indenter and material over a grid of speeds and indentations.
struct ContactTable {
  std::vector<double> speeds;        ///< v̂ > 0, ascending, at least 2
  std::vector<double> indentations;  ///< ŷ > 0, ascending, at least 2
  /// F̃, Ã and μ, a row per indentation; all > 0.
  std::vector<double> force;
  std::vector<double> area;
  std::vector<double> friction;
};

/// A law by interpolation in a table: monotone cubics in the logarithms, of the logarithms of F̃, Ã
/// and μ; for indenters other than a paraboloid and several creep times. Where the values along a
/// line of the table rise or fall, so does the law on it. Outside the table it gives `beyond_data`
/// and goes on: linearly in the logarithms, and below the smallest speed so that at rest friction
/// vanishes in proportion to the speed and force and area have limits.
class TabulatedLaw : public ViscoelasticContactLaw {
 public:
  /// @throws std::invalid_argument if the table is inconsistent
  explicit TabulatedLaw(const ContactTable& table);
  ViscoelasticContact at(double indentation, double speed) const override;

 private:
  /// Logarithms of a quantity with their slopes at the points.
  struct Surface {
    std::vector<double> value;
    std::vector<double> by_x;
    std::vector<double> by_y;
  };
  Surface make_surface(const std::vector<double>& values, const char* name) const;
  LawValue at(const Surface& surface, double x, double y) const;

  std::vector<double> x_;  ///< ln v̂
  std::vector<double> y_;  ///< ln ŷ
  Surface force_;
  Surface area_;
  Surface friction_;
};

}  // namespace stridor
