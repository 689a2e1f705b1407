#include "io/figures/window_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "io/figures/axes.hpp"

namespace stridor {
namespace {

/// Positions moved apart to at least `spacing` within 0 to `length`, in their order; there must be
/// room for them.
void spread(std::vector<double*> positions, double length, double spacing) {
  for (std::size_t i = 1; i < positions.size(); ++i)
    *positions[i] = std::max(*positions[i], *positions[i - 1] + spacing);
  for (std::size_t i = positions.size(); i-- > 0;) {
    const double limit = i + 1 == positions.size() ? length : *positions[i + 1] - spacing;
    *positions[i] = std::min(*positions[i], limit);
  }
}

}  // namespace

std::vector<WindowLabel> place_window_labels(const std::vector<LocusWindow>& windows, double from,
                                             double to, double width, double spacing) {
  std::vector<std::size_t> order(windows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return windows[a].growth_max > windows[b].growth_max;
  });
  const auto most = static_cast<std::size_t>(width / spacing) + 1;
  if (order.size() > most) order.resize(most);
  std::vector<WindowLabel> labels;
  for (const std::size_t i : order) {
    const double middle = 0.5 * (windows[i].from + windows[i].to);
    const double x = to == from ? 0.5 * width : width * (middle - from) / (to - from);
    labels.push_back({i, quantity_text(windows[i].frequency, "Hz"), x});
  }
  std::stable_sort(labels.begin(), labels.end(),
                   [](const WindowLabel& a, const WindowLabel& b) { return a.x < b.x; });
  std::vector<double*> positions;
  for (WindowLabel& label : labels) positions.push_back(&label.x);
  spread(positions, width, spacing);
  return labels;
}

std::vector<BranchLabel> place_branch_labels(const std::vector<LocusWindow>& windows,
                                             double frequency_limit, double height, double spacing,
                                             std::vector<std::string>& unlabelled) {
  std::vector<LocusWindow> strongest = windows;
  std::stable_sort(strongest.begin(), strongest.end(),
                   [](const auto& a, const auto& b) { return a.growth_max > b.growth_max; });
  const auto most = static_cast<std::size_t>(height / spacing) + 1;
  std::vector<BranchLabel> labels;
  for (const LocusWindow& window : strongest) {
    const std::string text = quantity_text(window.frequency, "Hz");
    const auto says_it = [&](const BranchLabel& other) { return other.text == text; };
    if (std::any_of(labels.begin(), labels.end(), says_it)) continue;
    if (labels.size() == most) {
      unlabelled.push_back(text);
      continue;
    }
    labels.push_back(
        {text, window.growth_max, window.frequency, height * window.frequency / frequency_limit});
  }
  std::stable_sort(labels.begin(), labels.end(),
                   [](const auto& a, const auto& b) { return a.frequency < b.frequency; });
  std::vector<double*> heights;
  for (BranchLabel& label : labels) heights.push_back(&label.height);
  spread(heights, height, spacing);
  return labels;
}

std::string unlabelled_text(const std::vector<std::string>& labels) {
  if (labels.empty()) return "";
  return fmt::format(" Without room for a label: {}.", fmt::join(labels, ", "));
}

}  // namespace stridor
