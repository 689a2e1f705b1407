#include "app/runs/run_frames.hpp"

#include <fmt/format.h>

#include <complex>

#include "core/errors.hpp"
#include "io/figures/shape_plot.hpp"

namespace stridor {

RunFrames::RunFrames(const Model& model, std::filesystem::path folder)
    : model_(&model), folder_(std::move(folder)), recovery_(model, cache_) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error)
    throw FileError(Refusal::cannot_write, folder_.string(), "",
                    "cannot be made: " + error.message());
}

std::filesystem::path RunFrames::name_of(int number) const {
  return folder_ / fmt::format("frame_{:05}.vtu", number);
}

void RunFrames::adopt(int number, double time) {
  if (std::filesystem::exists(name_of(number))) written_.push_back({time, name_of(number)});
}

void RunFrames::write(int number, const State& motion) {
  const System& system = model_->system;
  std::vector<double> driven(system.drives.size());
  motion.get("drive_displacement", driven);
  std::vector<double> displaced;
  std::vector<Eigen::VectorXd> still(system.bodies.size());
  std::vector<Eigen::VectorXcd> moving;
  for (const SystemBody& body : system.bodies) {
    displaced.push_back(body.drive < 0 ? 0.0 : driven[static_cast<std::size_t>(body.drive)]);
    const auto found = motion.arrays().find(body.name + "/displacement");
    Eigen::VectorXd now = Eigen::VectorXd::Zero(body.reduced.size());
    if (found != motion.arrays().end()) {
      now = Eigen::Map<const Eigen::VectorXd>(found->second.data(),
                                              static_cast<Eigen::Index>(found->second.size()));
    }
    moving.emplace_back(now.cast<std::complex<double>>());
  }
  const std::vector<BodyShape> bodies = recovery_.shapes(displaced, still, moving);
  VtkMesh mesh = vtk_mesh(bodies);
  const Eigen::MatrixX3d displacement = stacked_displacement(bodies, 0.0);
  mesh.vectors = {{"displacement", displacement}};
  const double time = motion.get("time");
  mesh.title = fmt::format("{:.9g} s", time);
  written_.push_back({time, name_of(number)});
  write_vtu(written_.back().file, mesh);
  write_pvd(collection(), written_);
}

}  // namespace stridor
