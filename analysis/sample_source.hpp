// Equidistant samples that are read a piece at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace stridor {

/// Samples of a signal that need not lie in memory as a whole.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// How many there are.
  virtual std::size_t size() const = 0;
  /// Copies the samples `begin` … `begin + target.size() − 1`, which exist.
  virtual void read(std::size_t begin, std::span<double> target) const = 0;
};

/// Samples in memory; they must live as long.
class SampleSpan final : public SampleSource {
 public:
  explicit SampleSpan(std::span<const double> samples) : samples_(samples) {}
  std::size_t size() const override { return samples_.size(); }
  void read(std::size_t begin, std::span<double> target) const override {
    std::copy_n(samples_.begin() + static_cast<std::ptrdiff_t>(begin), target.size(),
                target.begin());
  }

 private:
  std::span<const double> samples_;
};

}  // namespace stridor
