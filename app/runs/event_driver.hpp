// Transients from event to event: one mass on a half-space, steps that end where it begins or
// ceases to stick, slip or fly.
#pragma once

#include <chrono>
#include <limits>

#include "analysis/cycle_meter.hpp"
#include "app/runs/run_driver.hpp"
#include "io/run_file/event_recorder.hpp"

namespace stridor {

class EventDriver : public RunDriver {
 public:
  /// @throws ConfigError, NumericalError if there is no sliding equilibrium
  EventDriver(const LoadedScene& loaded, const Model& model);
  EventDriver(const EventDriver&) = delete;
  EventDriver& operator=(const EventDriver&) = delete;

  std::vector<SeriesSpec> series() const override;
  void begin(RowSink& rows, std::function<void()> on_progress) override;
  MarchEnd run_until(double time) override;
  MarchEnd run_to_end() override;
  double time() const override { return oscillator_.time * motion_.time(); }
  const std::string& failure() const override { return failure_; }
  Refusal refusal() const override { return Refusal::no_convergence; }
  State save() const override;
  void load(const State& state) override;
  State present_motion() const override;
  State final_motion() const override { return final_motion_; }
  void keep_final_motion() override;
  Effort effort() const override {
    return {steps_before_ + motion_.statistics().steps, nullptr, nullptr};
  }
  Json results(MarchEnd end, const std::optional<AccelerationSummary>& acceleration) const override;

 private:
  const Scene& scene() const { return loaded_->scene; }
  /// The window of `measure`, in which x is followed.
  enum class Window { ahead, open, closed };

  double measure_to() const { return scene().measure.to.value_or(scene().time->end); }
  bool is_to_stop();
  MarchEnd advance_to(double time);
  MarchEnd go_to(double time);
  CycleMeter with_extremes() const;
  void sample();

  const LoadedScene* loaded_;
  const Model* model_;
  std::vector<Channel> channels_;
  double interval_;  ///< of the samples, s
  SlidingOscillator oscillator_;
  SubstrateMotion motion_;
  EventRecorder recorder_;
  CycleMeter meter_;
  Window window_ = Window::ahead;
  std::int64_t steps_before_ = 0;  ///< the window opened
  RowSink* rows_ = nullptr;
  std::function<void()> on_progress_;
  std::chrono::steady_clock::time_point last_report_ = std::chrono::steady_clock::now();
  std::int64_t next_sample_ = 0;
  double force_min_ = std::numeric_limits<double>::infinity();   ///< of the samples measured, N
  double force_max_ = -std::numeric_limits<double>::infinity();  ///< likewise
  State final_motion_;
  std::string failure_;
};

}  // namespace stridor
