#include "solvers/transient/batch.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "solvers/transient/lane_group.hpp"

namespace stridor {

struct Batch::Implementation {
  struct Place {
    std::optional<std::size_t> group;
    std::size_t lane = 0;
    Simulation* alone = nullptr;
    StepOutcome outcome = StepOutcome::done;
  };
  std::vector<LaneGroup> groups;
  std::vector<Place> places;
};

Batch::Batch(std::vector<Simulation*> runs) : implementation_(std::make_unique<Implementation>()) {
  std::vector<std::pair<LaneShape, std::size_t>> open;  // groups with room
  std::vector<std::size_t> num_members;
  for (Simulation* simulation : runs) {
    Implementation::Place place;
    const std::optional<LaneShape> shape = lane_shape_of(simulation->implementation());
    if (!shape) {
      place.alone = simulation;
      implementation_->places.push_back(place);
      continue;
    }
    auto found = std::find_if(open.begin(), open.end(),
                              [&](const auto& group) { return group.first == *shape; });
    if (found == open.end()) {
      open.emplace_back(*shape, implementation_->groups.size());
      implementation_->groups.emplace_back(*shape);
      num_members.push_back(0);
      found = std::prev(open.end());
    }
    place.group = found->second;
    place.lane = num_members[found->second]++;
    LaneGroup& group = implementation_->groups[found->second];
    group.add(*simulation);
    if (group.is_full()) open.erase(found);
    implementation_->places.push_back(place);
  }
}

Batch::~Batch() = default;
Batch::Batch(Batch&&) noexcept = default;
Batch& Batch::operator=(Batch&&) noexcept = default;

void Batch::watch(std::size_t run, DisplacementSink& sink) {
  const Implementation::Place& place = implementation_->places.at(run);
  const std::optional<DisplacementSink::Row> row = sink.sole_row();
  if (!place.group || !row)
    throw std::invalid_argument("Batch: only a sole row of what steps in lanes can be watched");
  implementation_->groups[*place.group].watch(place.lane, sink, *row);
}

void Batch::step_until(std::int64_t target) {
  for (LaneGroup& group : implementation_->groups) group.step_until(target);
  for (Implementation::Place& place : implementation_->places) {
    if (place.alone != nullptr && place.outcome == StepOutcome::done)
      place.outcome = place.alone->step_until(target);
  }
}

void Batch::synchronise() {
  for (LaneGroup& group : implementation_->groups) group.synchronise();
}

StepOutcome Batch::outcome(std::size_t run) const {
  const Implementation::Place& place = implementation_->places.at(run);
  return place.group ? implementation_->groups[*place.group].outcome(place.lane) : place.outcome;
}

bool Batch::steps_in_lanes(std::size_t run) const {
  return implementation_->places.at(run).group.has_value();
}

}  // namespace stridor
