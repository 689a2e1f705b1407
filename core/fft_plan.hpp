// Fourier transforms of real signals: plans of FFTW with their buffers.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>

struct fftw_plan_s;

namespace stridor {

/// The lock of the whole process under which plans of FFTW are made and destroyed.
///
/// FFTW executes plans from several threads concurrently, but its planner is one global object.
/// Whoever calls `fftw_plan_*` or `fftw_destroy_plan` holds this lock meanwhile; RealFft and
/// InverseRealFft do so themselves.
std::mutex& fftw_planner_mutex();

namespace detail {
struct FftwFree {
  void operator()(void* memory) const;
};
struct FftwDestroy {
  void operator()(fftw_plan_s* plan) const;  // takes the lock
};
using FftwReals = std::unique_ptr<double[], FftwFree>;
using FftwComplexes = std::unique_ptr<std::complex<double>[], FftwFree>;
using FftwPlan = std::unique_ptr<fftw_plan_s, FftwDestroy>;
using SharedFftwPlan = std::shared_ptr<fftw_plan_s>;
}  // namespace detail

/// Fourier transform of real samples.
///
///     X_k = Σ_i x_i exp(−2πi·ik/n),   k = 0 … n/2 (rounded down)
///
/// Write the samples into input(), call execute(), read output(). The input survives. The buffers
/// are aligned for SIMD and belong to the object, which may be moved and then keeps them in place.
///
/// Plans are made by FFTW_ESTIMATE, hence the same on every run. The last plan is kept for the next
/// transform of the same length: a plan costs as much as several transforms.
class RealFft {
 public:
  /// @param length n, 1 to 2³¹ − 1; the input starts as zeros
  /// @throws std::invalid_argument if the length is out of range; std::bad_alloc
  explicit RealFft(std::size_t length);

  std::size_t length() const { return length_; }
  std::span<double> input() { return {input_.get(), length_}; }
  std::span<const std::complex<double>> output() const { return {output_.get(), length_ / 2 + 1}; }

  /// Transforms input() into output(). Allocates nothing.
  void execute();

 private:
  std::size_t length_;
  detail::FftwReals input_;
  detail::FftwComplexes output_;
  detail::SharedFftwPlan plan_;
};

/// Inverse of RealFft but for the factor n.
///
///     x_i = Σ_k X_k exp(2πi·ik/n),   the sum over −n/2 … n/2 with X_{−k} = X_k*
///
/// Write the lines 0 … n/2 into input(), call execute(), read output(). The input is destroyed. The
/// imaginary part of line 0, and of line n/2 if n is even, counts as zero.
class InverseRealFft {
 public:
  /// @param length n, 1 to 2³¹ − 1
  /// @throws std::invalid_argument if the length is out of range; std::bad_alloc
  explicit InverseRealFft(std::size_t length);

  std::size_t length() const { return length_; }
  std::span<std::complex<double>> input() { return {input_.get(), length_ / 2 + 1}; }
  std::span<const double> output() const { return {output_.get(), length_}; }

  /// Transforms input() into output(). Allocates nothing.
  void execute();

 private:
  std::size_t length_;
  detail::FftwComplexes input_;
  detail::FftwReals output_;
  detail::SharedFftwPlan plan_;
};

/// The smallest even length ≥ n without prime factors above 7, for which FFTW is fast.
///
/// @throws std::invalid_argument if that exceeds 2³¹ − 1
std::size_t fast_fft_length(std::size_t n);

}  // namespace stridor
