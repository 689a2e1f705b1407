// Number of eigenvalues in a rectangle by the argument principle.
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

namespace stridor {

/// Zeros of a function with f(s̄) = f̄(s) in a rectangle about the real axis, by the turns of its
/// phase around the upper half, where it is real at both ends:
///
///   N = (1/π) ∫ d arg f,   s = right → right + j height → left + j height → left
///
/// The known zeros s_k are divided out, so that the quotient turns slowly as long as none is
/// missing; a step is halved until the phase changes by less than 1 in it.
///
/// @param phase f(s)/|f(s)|
/// @param known with Im s >= 0, those with Im s > 0 together with their conjugates
/// @return conjugates counted, the known ones within included; nothing where a zero lies on the
///         rectangle as good as
std::optional<int> count_in_rectangle(
    const std::function<std::complex<double>(std::complex<double>)>& phase, double left,
    double right, double height, const std::vector<std::complex<double>>& known);

}  // namespace stridor
