// What a run says of its bursts, and of the unstable windows that were predicted for it.
#pragma once

#include <vector>

#include "analysis/bursts.hpp"
#include "app/terminal/command.hpp"
#include "io/results/locus_file.hpp"
#include "io/run_file/run_file.hpp"

namespace stridor {

/// Stores the bursts of a run in its file, one array per property, so that any reader of HDF5 can
/// take them; nothing where there are none.
void store_bursts(RunFileWriter& writer, const std::vector<Burst>& bursts);

/// Sets unstable windows beside the bursts of a run (match_bursts()): stores in its file every
/// window with the index of its burst, /windows/burst, and of every burst that of its window,
/// /bursts/window, −1 for none, and adds the same to the results: `prediction`, `unexplained`, and
/// `window` of each entry of `bursts`, numbered from 1, null for none.
void store_heard_windows(RunFileWriter& writer, const std::vector<TimedWindow>& windows,
                         const std::vector<Burst>& bursts, Json& results);

/// Writes such results: for every window whether it was heard, and every burst that none explains.
/// Nothing where no windows were given.
void print_heard_windows(const Json& results);

}  // namespace stridor
