// Transients in steps of equal length.
#pragma once

#include "app/runs/run_driver.hpp"
#include "io/run_file/recorder.hpp"

namespace stridor {

class StepDriver : public RunDriver {
 public:
  /// @throws ConfigError, NumericalError
  StepDriver(const LoadedScene& loaded, const Model& model);

  std::vector<SeriesSpec> series() const override;
  void begin(RowSink& rows, std::function<void()> on_progress) override;
  MarchEnd run_until(double time) override;
  MarchEnd run_to_end() override { return run_to_step(last_step_); }
  double time() const override { return simulation_.time(); }
  const std::string& failure() const override { return simulation_.failure(); }
  Refusal refusal() const override { return simulation_.refusal(); }
  State save() const override;
  void load(const State& state) override;
  State present_motion() const override;
  State final_motion() const override { return final_motion_; }
  void keep_final_motion() override;
  Effort effort() const override;
  Json results(MarchEnd end, const std::optional<AccelerationSummary>& acceleration) const override;

 private:
  const Scene& scene() const { return loaded_->scene; }
  MarchEnd run_to_step(std::int64_t step);

  const LoadedScene* loaded_;
  const Model* model_;
  std::vector<Channel> channels_;
  double interval_;  ///< of the samples, s
  Simulation simulation_;
  std::optional<Recorder> recorder_;
  std::optional<March> march_;
  std::int64_t end_step_ = 0;
  std::int64_t last_step_ = 0;
  State final_motion_;
};

}  // namespace stridor
