#include "solvers/half_space/half_space_convolution.hpp"

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

/// Transforms of `num_rows` rows of length n into lines of n/2 + 1, or back.
fftw_plan plan_rows(int num_rows, int n, double* rows, fftw_complex* lines) {
  return fftw_plan_many_dft_r2c(1, &n, num_rows, rows, nullptr, 1, n, lines, nullptr, 1, n / 2 + 1,
                                FFTW_ESTIMATE);
}
fftw_plan plan_rows_back(int num_rows, int n, fftw_complex* lines, double* rows) {
  return fftw_plan_many_dft_c2r(1, &n, num_rows, lines, nullptr, 1, n / 2 + 1, rows, nullptr, 1, n,
                                FFTW_ESTIMATE);
}

/// Transforms of all columns of `num_rows` rows of `num_columns` numbers.
fftw_plan plan_columns(int num_rows, int num_columns, fftw_complex* data, int sign) {
  return fftw_plan_many_dft(1, &num_rows, num_columns, data, nullptr, num_columns, 1, data, nullptr,
                            num_columns, 1, sign, FFTW_ESTIMATE);
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
  const auto all = static_cast<int>(num_cells + 1);
  const auto lines = static_cast<int>(num_lines_);
  const auto num_even = static_cast<int>(num_even_rows());
  const auto num_odd = static_cast<int>(num_cells / 2) - num_even;
  double* const odd_rows = rows_.get() + static_cast<std::size_t>(num_even) * length;
  fftw_complex* const odd_lines =
      as_fftw(lines_) + (num_cells - static_cast<std::size_t>(num_odd)) * num_lines_;
  auto* const reals = reinterpret_cast<double*>(lines_.get());
  const fftw_r2r_kind even = FFTW_REDFT00;
  std::unique_lock lock(fftw_planner_mutex());
  even_along_x_.reset(plan_rows(num_even, n, rows_.get(), as_fftw(lines_)));
  odd_along_x_.reset(plan_rows(num_odd, n, odd_rows, odd_lines));
  along_y_.reset(plan_columns(all - 1, lines, as_fftw(lines_), FFTW_FORWARD));
  back_along_y_.reset(plan_columns(all - 1, lines, as_fftw(lines_), FFTW_BACKWARD));
  even_back_along_x_.reset(plan_rows_back(num_even, n, as_fftw(lines_), rows_.get()));
  odd_back_along_x_.reset(plan_rows_back(num_odd, n, odd_lines, odd_rows));
  table_along_x_.reset(plan_rows(all, n, rows_.get(), as_fftw(lines_)));
  table_along_y_.reset(fftw_plan_many_r2r(1, &all, 2 * lines, reals, nullptr, 2 * lines, 1, reals,
                                          nullptr, 2 * lines, 1, &even, FFTW_ESTIMATE));
  for (const auto* plan :
       {&even_along_x_, &odd_along_x_, &along_y_, &back_along_y_, &even_back_along_x_,
        &odd_back_along_x_, &table_along_x_, &table_along_y_}) {
    if (!*plan) throw std::bad_alloc();
  }
  lock.unlock();
  for (std::size_t k = 0; k <= num_cells / 2; ++k) {
    turns_.push_back(std::polar(
        1.0, -0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(num_cells)));
  }

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

void HalfSpaceConvolution::multiply_cosine_lines(const std::vector<std::complex<double>>& factors) {
  // The cosine transform of x_0 … x_{N−1} is, from the Fourier transform C of x_0, x_2, … x_3, x_1,
  //   X_k = w C_k + w̄ C_{N−k},  X_{N−k} = i (w C_k − w̄ C_{N−k}),  w = exp(−iπ k/(2N)),
  // and the transform back takes w̄ (P − i Q) and w (P + i Q) where P, Q are X_k, X_{N−k} times
  // their factors. Written out in reals, since the product of std::complex looks for infinities.
  const std::size_t n = num_cells();
  const auto* const factor = reinterpret_cast<const double*>(factors.data());
  auto* const value = reinterpret_cast<double*>(lines_.get());
  const std::size_t length = 2 * num_lines_;
  for (std::size_t k = 0; k <= n / 2; ++k) {
    const double wr = turns_[k].real();
    const double wi = turns_[k].imag();
    const std::size_t mirror = k == 0 ? 0 : n - k;
    const bool is_alone = mirror == k;
    const double* const f = &factor[k * length];
    const double* const g = &factor[mirror * length];
    double* const low = &value[k * length];
    double* const high = &value[mirror * length];
    if (is_alone) {
      // X = 2 Re(w) C, and back the same, but for k = 0, which counts once.
      const double scale = k == 0 ? 2.0 : 4.0 * wr * wr;
      for (std::size_t i = 0; i < length; i += 2) {
        const double re = scale * (f[i] * low[i] - f[i + 1] * low[i + 1]);
        low[i + 1] = scale * (f[i] * low[i + 1] + f[i + 1] * low[i]);
        low[i] = re;
      }
      continue;
    }
    for (std::size_t i = 0; i < length; i += 2) {
      const double ar = wr * low[i] - wi * low[i + 1];
      const double ai = wr * low[i + 1] + wi * low[i];
      const double br = wr * high[i] + wi * high[i + 1];
      const double bi = wr * high[i + 1] - wi * high[i];
      const double xr = ar + br;
      const double xi = ai + bi;
      const double yr = bi - ai;
      const double yi = ar - br;
      const double pr = f[i] * xr - f[i + 1] * xi;
      const double pi = f[i] * xi + f[i + 1] * xr;
      const double qr = g[i] * yr - g[i + 1] * yi;
      const double qi = g[i] * yi + g[i + 1] * yr;
      low[i] = wr * (pr + qi) + wi * (pi - qr);
      low[i + 1] = wr * (pi - qr) - wi * (pr + qi);
      high[i] = wr * (pr - qi) - wi * (pi + qr);
      high[i + 1] = wr * (pi + qr) + wi * (pr - qi);
    }
  }
}

void HalfSpaceConvolution::transform_with(const std::vector<std::complex<double>>& factors,
                                          std::span<const double> from, std::span<double> to) {
  const std::size_t n = num_cells();
  const std::size_t num_rows = n / 2;
  // Even rows ascending, then odd rows descending, as the transform along y wants them.
  const auto place_of = [&](std::size_t row) {
    return row % 2 == 0 ? row / 2 : num_rows - 1 - row / 2;
  };
  for (std::size_t row = 0; row < num_rows; ++row) {
    double* const padded = &rows_[place_of(row) * 2 * n];
    std::copy_n(&from[row * n], n, padded);
    std::fill_n(padded + n, n, 0.0);
  }
  fftw_execute(even_along_x_.get());
  fftw_execute(odd_along_x_.get());
  std::fill(&lines_[num_even_rows() * num_lines_],
            &lines_[(num_rows + num_even_rows()) * num_lines_], std::complex<double>{});
  fftw_execute(along_y_.get());
  multiply_cosine_lines(factors);
  fftw_execute(back_along_y_.get());
  fftw_execute(even_back_along_x_.get());
  fftw_execute(odd_back_along_x_.get());
  for (std::size_t row = 0; row < num_rows; ++row)
    std::copy_n(&rows_[place_of(row) * 2 * n], n, &to[row * n]);
}

void HalfSpaceConvolution::apply(std::span<const double> pressure, std::span<double> displacement) {
  transform_with(symbol_, pressure, displacement);
}

void HalfSpaceConvolution::apply_inverse(std::span<const double> displacement,
                                         std::span<double> pressure) {
  transform_with(inverse_symbol_, displacement, pressure);
}

}  // namespace stridor
