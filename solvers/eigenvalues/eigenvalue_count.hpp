// Number of eigenvalues in a rectangle by the argument principle.
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

namespace stridor {

/// Zeros of an analytic function with f(s̄) = f̄(s) in a rectangle about the real axis, by the turns
/// of its phase around the upper half, where it is real at both ends:
///
///   N = (1/π) ∫ d arg f,   s = right → right + j height → left + j height → left
///
/// Followed is the quotient
///
///   h(s) = f(s) / (∏ (s − s_k) exp g(s)),   g a polynomial with real coefficients:
///
/// neither exp g, which has no zeros, nor a known zero s_k, which is added afterwards, changes the
/// count, however wrong they are. g is fitted to what log h has at the places looked at, so that h
/// turns slowly even where zeros outside make f turn fast, and a step may be long. It is halved,
/// and g fitted anew, until log h changes by less than 1/2 in every step, in size and in phase, and
/// no step is twice as long as one beside it: zeros close to a step that together turn the phase by
/// a whole turn show in the size beside them.
///
/// @param logarithm log f(s), any of its branches; real part −∞ where f(s) is zero
/// @param known with Im s >= 0, those with Im s > 0 together with their conjugates
/// @return conjugates counted, the known ones within included; nothing where a zero lies on the
///         rectangle as good as
/// Cost: 17 values of f where g does its work; what lies between zeros near the rectangle more.
std::optional<int> count_in_rectangle(
    const std::function<std::complex<double>(std::complex<double>)>& logarithm, double left,
    double right, double height, const std::vector<std::complex<double>>& known);

}  // namespace stridor
