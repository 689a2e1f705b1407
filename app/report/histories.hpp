// Histories of a run in a report: as many samples as the budget allows.
#pragma once

#include "app/report/report_section.hpp"
#include "app/results/pictures.hpp"

namespace stridor {

/// The series of a run as a view of the page, with the times of its samples.
///
/// Where all samples do not fit into the budget, each series gets the least and largest of every
/// 2^k of them instead, k the least that fits; states are kept whole.
/// @param budget bytes of the page
Json histories_view(const RecordedStretch& run, const ReportContext& context, double budget);

/// Samples of a column of any file, by time.
/// @param times s, ascending
Json column_histories(const ResultFile& file, const std::vector<std::string>& columns,
                      const std::vector<double>& times, ReportPage& page);

}  // namespace stridor
