#include "app/stability/growth_of_mass.hpp"

#include <array>
#include <limits>
#include <string>

#include "core/refusals.hpp"
#include "io/scene/oscillator_family.hpp"

namespace stridor {
namespace {

constexpr double first_guess = 1e-2;  ///< of ŷ
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

class GrowthOfMass : public GrowthField {
 public:
  GrowthOfMass(std::unique_ptr<OscillatorFamily> family, const KeptTerms& terms)
      : family_(std::move(family)), terms_(terms) {}

  void restart() override { last_ = first_guess; }
  std::complex<double> leading(double x, double y) override {
    if (!solve(x, y)) return {not_a_number, not_a_number};
    return leading_eigenvalue(motion_) / time_;
  }
  double margin(double x, double y) override {
    return solve(x, y) ? stability_margin(motion_) : not_a_number;
  }
  std::string failure() const override { return failure_; }

 private:
  bool solve(double x, double y) {
    const SlidingOscillator* of = family_->at(std::array{x, y});
    if (of == nullptr) {
      failure_ =
          with_code("the scene is no mass on a half-space with these values", Refusal::wrong_value);
      return false;
    }
    // The indentation over R changes less from point to point than that in units of length.
    const SubstrateOscillator& oscillator = of->oscillator;
    const double unit = oscillator.contact.indentation_unit;
    const SubstrateEquilibrium found = find_equilibrium(oscillator, last_ * unit);
    if (!found.converged) {
      failure_ =
          with_code("no sliding equilibrium: the search for the indentation did not converge",
                    Refusal::no_equilibrium);
      return false;
    }
    last_ = found.displacement.y() / unit;
    motion_ = small_motion(oscillator, found);
    if (!terms_.friction_damping) motion_.damping = oscillator.damping;
    if (!terms_.structural_damping && !terms_.friction_damping) motion_.damping.setZero();
    if (!terms_.structural_damping && terms_.friction_damping) motion_.damping -= oscillator.damping;
    time_ = of->time;
    return true;
  }

  std::unique_ptr<OscillatorFamily> family_;
  KeptTerms terms_;
  SmallMotion motion_;
  std::string failure_;  ///< of the last call that failed
  double time_ = 1.0;   ///< unit, s
  double last_ = first_guess;  ///< ŷ
};

}  // namespace

std::unique_ptr<GrowthField> make_growth_field(const LoadedScene& loaded,
                                               const std::vector<NumericKey>& keys) {
  std::unique_ptr<OscillatorFamily> family = OscillatorFamily::make(loaded, keys);
  if (family == nullptr) return nullptr;
  return std::make_unique<GrowthOfMass>(std::move(family), kept_terms(loaded.scene));
}

}  // namespace stridor
