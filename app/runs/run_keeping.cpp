#include "app/runs/run_keeping.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/version.hpp"

namespace stridor {
namespace {

constexpr const char* checkpoint_group = "/checkpoint";

void store(RunFileWriter& writer, const std::string& prefix, const Json& object) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_object()) store(writer, prefix + name + ".", value);
    if (value.is_number()) writer.write_result(prefix + name, value.get<double>());
    if (value.is_string()) writer.write_result(prefix + name, value.get<std::string>());
  }
}

}  // namespace

bool is_done(const RunFileReader& reader) {
  const auto results = reader.results();
  const auto status = results.find("status");
  return status != results.end() && status->second == std::variant<std::string, double>("done");
}

Json stored_results(const RunFileReader& reader) {
  Json results = Json::object();
  for (const auto& [name, value] : reader.results()) {
    Json* place = &results;
    std::size_t begin = 0;
    for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', begin)) {
      place = &(*place)[name.substr(begin, dot - begin)];
      begin = dot + 1;
    }
    const std::string last = name.substr(begin);
    std::visit([&](const auto& one) { (*place)[last] = one; }, value);
  }
  return results;
}

InterruptedRun find_interrupted_run(const std::string& file) {
  const RunFileReader reader(file);
  const RunFileHeader& header = reader.header();
  if (header.version != version || header.commit != commit) {
    throw FileError(Refusal::other_kind_of_file, file, "",
                    fmt::format("was written by stridor {} ({}), this is {} ({}); only the program "
                                "that began a run goes on with it bitwise",
                                header.version, header.commit, version, commit));
  }
  const auto results = reader.results();
  const auto status = results.find("status");
  const std::string* text =
      status == results.end() ? nullptr : std::get_if<std::string>(&status->second);
  if (is_done(reader))
    throw FileError(Refusal::other_kind_of_file, file, "",
                    "holds a whole run, there is nothing to go on with");
  if (text != nullptr && *text == "failed") {
    throw FileError(Refusal::other_kind_of_file, file, "",
                    "holds a run that failed, and would again; change the scene and run it anew");
  }
  std::optional<Checkpoint> checkpoint = reader.checkpoint();
  if (!checkpoint) {
    throw FileError(Refusal::file_damaged, file, checkpoint_group,
                    "there is no whole checkpoint to go on from; run the scene anew");
  }
  check_unchanged(
      {header.scene_text, header.scene_resolved, header.scene_digests, header.scene_hash}, file);
  return {file, header.scene_resolved, *std::move(checkpoint)};
}

void throw_unfit_checkpoint(const std::string& file, const std::string& what) {
  throw FileError(Refusal::file_damaged, file, checkpoint_group,
                  fmt::format("does not fit the scene in the file: {}", what));
}

RunFileHeader run_header(const std::string& command_line, const std::string& text,
                         const std::string& resolved, const std::vector<SceneFile>& files) {
  return {std::string(version),
          std::string(commit),
          command_line,
          scene_hash(resolved, files),
          utc_now(),
          text,
          resolved,
          scene_digests(text, files)};
}

void store_results(RunFileWriter& writer, const Json& results) {
  store(writer, "", results);
}

double seconds_since(std::chrono::steady_clock::time_point moment) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - moment).count();
}

Json effort_json(std::int64_t steps, const Json& step, const Json& limit, const RunTimes& times) {
  return {{"steps", steps},
          {"step", step},
          {"step_limit", limit},
          {"wall_s", times.march},
          {"setup_s", times.setup},
          {"output_s", times.output},
          {"step_ns",
           steps > 0 ? number(times.march * 1e9 / static_cast<double>(steps)) : Json(nullptr)}};
}

bool RunKeeper::is_due() {
  const auto now = Clock::now();
  if (now < last_look_ + std::chrono::milliseconds(250)) return false;
  last_look_ = now;
  return true;
}

void RunKeeper::look_after(double time, double end, RunFileWriter& writer,
                           const std::function<State()>& save) {
  if (report_) report_(time / end, fmt::format("t = {:.4g} of {:.4g}", time, end));
  if (seconds_since(last_checkpoint_) > every_) {
    write_checkpoint(writer, save());
  } else if (seconds_since(last_flush_) > 2.0) {
    writer.flush();
    last_flush_ = Clock::now();
  }
  if (seconds() > wall_limit_) request_stop();
}

void RunKeeper::write_checkpoint(RunFileWriter& writer, const State& state) {
  writer.write_checkpoint(state);
  last_checkpoint_ = last_flush_ = Clock::now();
}

void throw_interrupted(double time, double end, const std::string& file) {
  throw Interrupted(
      fmt::format("at t = {:.6g} of {:.6g}; {} holds everything up to then. It can be resumed:\n"
                  "stridor run --resume '{}'",
                  time, end, file, file));
}

}  // namespace stridor
