#include "core/fft_plan.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

namespace stridor {
namespace {

constexpr std::size_t longest = std::numeric_limits<int>::max();

int checked(std::size_t length) {
  if (length == 0 || length > longest) {
    throw std::invalid_argument(
        fmt::format("Fourier transform: the length {} is not 1 to {}", length, longest));
  }
  return static_cast<int>(length);
}

detail::FftwReals make_reals(std::size_t count) {
  detail::FftwReals memory(fftw_alloc_real(count));
  if (!memory) throw std::bad_alloc();
  std::fill_n(memory.get(), count, 0.0);
  return memory;
}

detail::FftwComplexes make_complexes(std::size_t count) {
  // FFTW documents that its complex type and that of C++ have the same layout.
  detail::FftwComplexes memory(reinterpret_cast<std::complex<double>*>(fftw_alloc_complex(count)));
  if (!memory) throw std::bad_alloc();
  std::fill_n(memory.get(), count, 0.0);
  return memory;
}

fftw_complex* as_fftw(const detail::FftwComplexes& memory) {
  return reinterpret_cast<fftw_complex*>(memory.get());
}

enum class Direction { forward, backward };

/// The plans used last, by direction and length. Their tables are as long as the data.
///
/// FFTW executes a plan on any arrays of the same alignment, in several threads concurrently.
class Plans {
 public:
  static Plans& of_process() {
    static Plans plans;
    return plans;
  }

  /// @throws std::bad_alloc
  detail::SharedFftwPlan find(Direction direction, int n, double* reals, fftw_complex* complexes) {
    // A plan destroyed at the end, or by an exception, takes the lock when it is free again.
    detail::FftwPlan made;
    detail::SharedFftwPlan plan;
    detail::SharedFftwPlan forgotten;
    const std::scoped_lock lock(fftw_planner_mutex());
    const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return entry.direction == direction && entry.length == n;
    });
    if (known != entries_.end()) {
      std::rotate(entries_.begin(), known, known + 1);
      return entries_.front().plan;
    }
    made.reset(direction == Direction::forward
                   ? fftw_plan_dft_r2c_1d(n, reals, complexes, FFTW_ESTIMATE | FFTW_PRESERVE_INPUT)
                   : fftw_plan_dft_c2r_1d(n, complexes, reals, FFTW_ESTIMATE));
    if (!made) throw std::bad_alloc();
    plan = std::move(made);
    if (n > longest_kept) return plan;
    if (entries_.size() == most_kept) {
      forgotten = std::move(entries_.back().plan);
      entries_.pop_back();
    }
    entries_.insert(entries_.begin(), {direction, n, plan});
    return plan;
  }

 private:
  struct Entry {
    Direction direction;
    int length;
    detail::SharedFftwPlan plan;
  };
  static constexpr std::size_t most_kept = 32;
  static constexpr int longest_kept = 1 << 22;

  Plans() { fftw_planner_mutex(); }  // which is to outlive it

  std::vector<Entry> entries_;  ///< last used first
};

}  // namespace

std::mutex& fftw_planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

void detail::FftwFree::operator()(void* memory) const {
  fftw_free(memory);
}

void detail::FftwDestroy::operator()(fftw_plan_s* plan) const {
  const std::scoped_lock lock(fftw_planner_mutex());
  fftw_destroy_plan(plan);
}

RealFft::RealFft(std::size_t length) : length_(length) {
  const int n = checked(length);
  input_ = make_reals(length);
  output_ = make_complexes(length / 2 + 1);
  plan_ = Plans::of_process().find(Direction::forward, n, input_.get(), as_fftw(output_));
}

void RealFft::execute() {
  fftw_execute_dft_r2c(plan_.get(), input_.get(), as_fftw(output_));
}

InverseRealFft::InverseRealFft(std::size_t length) : length_(length) {
  const int n = checked(length);
  input_ = make_complexes(length / 2 + 1);
  output_ = make_reals(length);
  plan_ = Plans::of_process().find(Direction::backward, n, output_.get(), as_fftw(input_));
}

void InverseRealFft::execute() {
  fftw_execute_dft_c2r(plan_.get(), as_fftw(input_), output_.get());
}

std::size_t fast_fft_length(std::size_t n) {
  if (n > longest) {
    throw std::invalid_argument(
        fmt::format("Fourier transform: {} samples are more than {}", n, longest));
  }
  std::size_t best = 2;
  while (best < n) best *= 2;
  for (std::size_t p7 = 2; p7 < best; p7 *= 7) {
    for (std::size_t p5 = p7; p5 < best; p5 *= 5) {
      for (std::size_t p3 = p5; p3 < best; p3 *= 3) {
        std::size_t p = p3;
        while (p < n) p *= 2;
        best = std::min(best, p);
      }
    }
  }
  if (best > longest) {
    throw std::invalid_argument(
        fmt::format("Fourier transform: {} samples are more than {}", best, longest));
  }
  return best;
}

}  // namespace stridor
