#include "solvers/half_space_convolution.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <mutex>
#include <new>
#include <numbers>
#include <stdexcept>

namespace stridor {
namespace {

fftw_complex* as_fftw(const detail::FftwComplexes& memory) {
  return reinterpret_cast<fftw_complex*>(memory.get());
}

/// A cosine transform of every column of `num_rows` rows of `num_columns` numbers.
fftw_plan plan_columns(int num_rows, int num_columns, double* data, fftw_r2r_kind kind) {
  return fftw_plan_many_r2r(1, &num_rows, num_columns, data, nullptr, num_columns, 1, data, nullptr,
                            num_columns, 1, &kind, FFTW_ESTIMATE);
}

}  // namespace

HalfSpaceConvolution::HalfSpaceConvolution(std::size_t num_cells)
    : influence_(num_cells), num_lines_(num_cells + 1) {
  if (num_cells % 2 != 0) {
    throw std::invalid_argument(
        fmt::format("HalfSpaceConvolution: {} cells a side are not even", num_cells));
  }
  const std::size_t length = 2 * num_cells;
  rows_.reset(fftw_alloc_real((num_cells + 1) * length));
  lines_.reset(
      reinterpret_cast<std::complex<double>*>(fftw_alloc_complex((num_cells + 1) * num_lines_)));
  if (!rows_ || !lines_) throw std::bad_alloc();
  symbol_.resize(num_cells * num_lines_);
  inverse_symbol_.resize(num_cells * num_lines_);
  elastic_symbol_.resize(num_cells * num_lines_);

  const auto n = static_cast<int>(length);
  const auto half = static_cast<int>(num_cells / 2);
  const auto all = static_cast<int>(num_cells + 1);
  const auto lines = static_cast<int>(num_lines_);
  auto* const reals = reinterpret_cast<double*>(lines_.get());
  std::unique_lock lock(fftw_planner_mutex());
  along_x_.reset(fftw_plan_many_dft_r2c(1, &n, half, rows_.get(), nullptr, 1, n, as_fftw(lines_),
                                        nullptr, 1, lines, FFTW_ESTIMATE));
  back_along_x_.reset(fftw_plan_many_dft_c2r(1, &n, half, as_fftw(lines_), nullptr, 1, lines,
                                             rows_.get(), nullptr, 1, n, FFTW_ESTIMATE));
  table_along_x_.reset(fftw_plan_many_dft_r2c(1, &n, all, rows_.get(), nullptr, 1, n,
                                              as_fftw(lines_), nullptr, 1, lines, FFTW_ESTIMATE));
  along_y_.reset(plan_columns(all - 1, 2 * lines, reals, FFTW_REDFT10));
  back_along_y_.reset(plan_columns(all - 1, 2 * lines, reals, FFTW_REDFT01));
  table_along_y_.reset(plan_columns(all, 2 * lines, reals, FFTW_REDFT00));
  if (!along_x_ || !back_along_x_ || !table_along_x_ || !along_y_ || !back_along_y_ ||
      !table_along_y_) {
    throw std::bad_alloc();
  }
  lock.unlock();

  // A table that is even in both directions: its transform is real.
  transform(influence_.table({}, 1.0));
  for (std::size_t k = 0; k < elastic_symbol_.size(); ++k) elastic_symbol_[k] = lines_[k].real();
  set_creep({}, 1.0);
}

void HalfSpaceConvolution::transform(const InfluenceTable& table) {
  std::copy(table.values.begin(), table.values.end(), rows_.get());
  fftw_execute(table_along_x_.get());
  fftw_execute(table_along_y_.get());
}

void HalfSpaceConvolution::set_creep(std::span<const SlidingCreep> creep, double cell_side) {
  transform(influence_.table(creep, cell_side));
  const auto n = static_cast<double>(num_cells());
  std::vector<std::complex<double>> memory(num_lines_, 1.0);
  for (std::size_t line = 0; line < num_lines_; ++line) {
    const double wave_number = std::numbers::pi * static_cast<double>(line) / n / cell_side;
    for (const SlidingCreep& one : creep) {
      const std::complex<double> fading(1.0, -wave_number * one.length);
      memory[line] += one.share * (1.0 / fading - 1.0);
    }
  }
  const double scale = 1.0 / (4.0 * n * n);
  for (std::size_t k = 0; k < symbol_.size(); ++k) {
    symbol_[k] = scale * lines_[k];
    inverse_symbol_[k] = scale / (elastic_symbol_[k] * memory[k % num_lines_]);
  }
}

void HalfSpaceConvolution::transform_with(const std::vector<std::complex<double>>& factors,
                                          std::span<const double> from, std::span<double> to) {
  const std::size_t num_cells = this->num_cells();
  const std::size_t num_rows = num_cells / 2;
  for (std::size_t row = 0; row < num_rows; ++row) {
    double* const padded = &rows_[row * 2 * num_cells];
    std::copy_n(&from[row * num_cells], num_cells, padded);
    std::fill_n(padded + num_cells, num_cells, 0.0);
  }
  fftw_execute(along_x_.get());
  std::fill(&lines_[num_rows * num_lines_], &lines_[num_cells * num_lines_],
            std::complex<double>{});
  fftw_execute(along_y_.get());
  // Written out, since the product of std::complex looks for infinities first.
  auto* const line = reinterpret_cast<double*>(lines_.get());
  const auto* const factor = reinterpret_cast<const double*>(factors.data());
  for (std::size_t k = 0; k < 2 * factors.size(); k += 2) {
    const double real = line[k] * factor[k] - line[k + 1] * factor[k + 1];
    line[k + 1] = line[k] * factor[k + 1] + line[k + 1] * factor[k];
    line[k] = real;
  }
  fftw_execute(back_along_y_.get());
  fftw_execute(back_along_x_.get());
  for (std::size_t row = 0; row < num_rows; ++row)
    std::copy_n(&rows_[row * 2 * num_cells], num_cells, &to[row * num_cells]);
}

void HalfSpaceConvolution::apply(std::span<const double> pressure, std::span<double> displacement) {
  transform_with(symbol_, pressure, displacement);
}

void HalfSpaceConvolution::apply_inverse(std::span<const double> displacement,
                                         std::span<double> pressure) {
  transform_with(inverse_symbol_, displacement, pressure);
}

}  // namespace stridor
