#include "app/runs/turns.hpp"

#include <numeric>

#include "app/terminal/progress.hpp"

namespace stridor {

void run_in_turns(const std::string& title, const std::vector<double>& weights, int turns,
                  const std::function<std::string(std::size_t run, int turn)>& stretch) {
  const double whole = std::accumulate(weights.begin(), weights.end(), 0.0) * turns;
  double done = 0.0;
  Progress progress(title);
  for (int turn = 1; turn <= turns; ++turn) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const std::string name = stretch(i, turn);
      done += weights[i];
      progress.report(done / whole, name);
    }
  }
  progress.finish();
}

}  // namespace stridor
