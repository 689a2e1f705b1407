#include "analysis/order_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>

namespace stridor {
namespace {

constexpr int bits_per_pass = 18;

/// Bits of numbers that are not negative, which stand in the order of these.
std::uint64_t key_of(double value) {
  return std::bit_cast<std::uint64_t>(value + 0.0);  // of -0 as of 0
}

/// The interval of keys in which a rank was found to lie.
class Narrowing {
 public:
  Narrowing(std::size_t count, std::size_t rank) : count_(count), rank_(rank) {}

  bool is_found() const { return is_found_; }
  double value() const { return value_; }

  /// Prepares the next pass: to keep the values of the interval, or to count them.
  void begin(std::size_t room) {
    keeps_ = count_ <= room;
    kept_.clear();
    if (keeps_) {
      kept_.reserve(count_);
    } else {
      counts_.assign(std::size_t{1} << std::min(bits_per_pass, shift_), 0);
    }
  }

  void take(std::span<const double> values) {
    if (keeps_ && shift_ == 64) {
      kept_.insert(kept_.end(), values.begin(), values.end());
      return;
    }
    const int next = next_shift();
    for (const double value : values) {
      const std::uint64_t key = key_of(value);
      if (shift_ < 64 && key >> shift_ != prefix_) continue;
      if (keeps_) {
        kept_.push_back(value);
      } else {
        ++counts_[(key >> next) - (shift_ < 64 ? prefix_ << (shift_ - next) : 0)];
      }
    }
  }

  void end() {
    if (keeps_) {
      const auto place = kept_.begin() + static_cast<std::ptrdiff_t>(rank_);
      std::nth_element(kept_.begin(), place, kept_.end());
      found(*place);
      return;
    }
    const int next = next_shift();
    std::uint64_t bin = 0;
    while (rank_ >= counts_[bin]) rank_ -= counts_[bin++];
    count_ = counts_[bin];
    prefix_ = (shift_ < 64 ? prefix_ << (shift_ - next) : 0) + bin;
    shift_ = next;
    counts_ = {};
    if (shift_ == 0) found(std::bit_cast<double>(prefix_));
  }

 private:
  int next_shift() const { return shift_ - std::min(bits_per_pass, shift_); }
  void found(double value) {
    is_found_ = true;
    value_ = value;
    kept_ = {};
  }

  std::size_t count_;         ///< values in the interval
  std::size_t rank_;          ///< among them
  std::uint64_t prefix_ = 0;  ///< of their keys
  int shift_ = 64;            ///< bits of a key that follow on the prefix
  bool keeps_ = false;
  bool is_found_ = false;
  double value_ = 0.0;
  std::vector<std::size_t> counts_;
  std::vector<double> kept_;
};

}  // namespace

std::vector<double> order_statistics(const EachValue& each, std::size_t count,
                                     const std::vector<std::size_t>& ranks, std::size_t room) {
  std::vector<Narrowing> all;
  for (const std::size_t rank : ranks) {
    if (rank >= count) throw std::invalid_argument("order_statistics: a rank is out of range");
    all.emplace_back(count, rank);
  }
  const auto is_open = [](const Narrowing& one) { return !one.is_found(); };
  while (std::any_of(all.begin(), all.end(), is_open)) {
    for (Narrowing& one : all)
      if (is_open(one)) one.begin(room);
    each([&](std::span<const double> values) {
      for (Narrowing& one : all)
        if (is_open(one)) one.take(values);
    });
    for (Narrowing& one : all)
      if (is_open(one)) one.end();
  }
  std::vector<double> values;
  for (const Narrowing& one : all) values.push_back(one.value());
  return values;
}

}  // namespace stridor
