// The series of a run file as panels of a picture: choice, order and labels.
#pragma once

#include <string>
#include <vector>

#include "analysis/statistics.hpp"
#include "io/figures/history_plot.hpp"
#include "io/run_file/run_file.hpp"

namespace stridor {

/// The name of a series as users write it: "cantilever.free_end.y.acceleration" for
/// "/channels/cantilever.free_end.y.acceleration", "contact.force" for "/contact/contact/force".
std::string channel_name(const std::string& series);

/// The point or contact of a channel, and its quantity: "cantilever.free_end.y", "acceleration".
std::pair<std::string, std::string> split_name(const std::string& name);

/// "low-passed to 40 kHz"; empty for a series that is not filtered, or does not say.
std::string filter_note(const RunFileReader& file, const std::string& series);

/// The series of which a spectrum is taken instead of one that was thinned without a filter: the
/// low-passed series beside a contact force, else the series itself.
std::string spectral_series(const RunFileReader& file, const std::string& series);

enum class SeriesUse { history, spectrum };

/// The series of a run in the order in which they matter: the acceleration in which bursts are
/// sought, contact forces, slip velocities, states, other quantities, energies. Series that
/// accompany another one (extremes, shares, low-passed) are left out, for spectra also what has
/// none: states, positions, energies.
std::vector<std::string> series_by_use(const RunFileReader& file, SeriesUse use);

/// At most `most` of series_by_use(): of every quantity one, then the second of each and so on.
std::vector<std::string> chosen_series(const RunFileReader& file, SeriesUse use, std::size_t most);

/// A series over time: a contact force with the band of its extremes, a state with the names of its
/// values, a filtered series with a word about the filter.
/// @throws FileError as RunFileReader::series()
Panel panel_of(const RunFileReader& file, const std::string& series, IndexRange samples);

}  // namespace stridor
