// Arrays for vectorised loops.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>

namespace stridor {

/// Doubles, 64-byte aligned, zero at first.
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) : size_(size), data_(allocate(size)) {
    std::fill_n(data_.get(), size, 0.0);
  }

  std::size_t size() const { return size_; }
  double* data() { return data_.get(); }
  const double* data() const { return data_.get(); }
  double& operator[](std::size_t i) { return data_.get()[i]; }
  double operator[](std::size_t i) const { return data_.get()[i]; }
  std::span<const double> first(std::size_t count) const { return {data_.get(), count}; }
  std::span<double> first(std::size_t count) { return {data_.get(), count}; }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Release {
    void operator()(double* pointer) const { ::operator delete(pointer, alignment); }
  };
  static double* allocate(std::size_t size) {
    return static_cast<double*>(
        ::operator new(std::max<std::size_t>(size, 1) * sizeof(double), alignment));
  }

  std::size_t size_ = 0;
  std::unique_ptr<double, Release> data_;
};

}  // namespace stridor
