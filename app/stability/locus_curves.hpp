// The eigenvalues of a locus as the curves of its pictures.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/locus.hpp"
#include "io/figures/locus_plot.hpp"

namespace stridor {

/// The branches as curves; samples connected where there are no branches.
/// @param highest frequency above which nothing is shown, Hz
std::vector<LocusCurve> curves_of(const Locus& locus, double highest);

/// The highest frequency of the eigenvalues asked for.
double highest_frequency(const Locus& locus);

}  // namespace stridor
