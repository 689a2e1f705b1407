// Several runs a stretch at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace stridor {

/// Runs a stretch of each of several runs, then the next stretch of each and so on, so that
/// whatever else the machine does weighs on all of them alike. Progress goes to stderr.
///
/// @param title   of the progress
/// @param weights how long each run takes relative to the others, for the progress
/// @param turns   stretches
/// @param stretch runs stretch `turn`, 1 to `turns`, of a run and names it; may throw
void run_in_turns(const std::string& title, const std::vector<double>& weights, int turns,
                  const std::function<std::string(std::size_t run, int turn)>& stretch);

}  // namespace stridor
