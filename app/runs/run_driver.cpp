#include "app/runs/run_driver.hpp"

#include "app/runs/event_driver.hpp"
#include "app/runs/step_driver.hpp"

namespace stridor {

std::unique_ptr<RunDriver> make_run_driver(const LoadedScene& loaded, const Model& model) {
  try {
    if (loaded.scene.time->is_event_driven()) return std::make_unique<EventDriver>(loaded, model);
    return std::make_unique<StepDriver>(loaded, model);
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
}

}  // namespace stridor
