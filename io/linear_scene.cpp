#include "io/linear_scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/errors.hpp"
#include "io/disc_recorder.hpp"
#include "io/matrix_market.hpp"
#include "io/resolved_scene.hpp"
#include "io/scene_reader.hpp"
#include "substructures/sparse_cholesky.hpp"

namespace stridor {
namespace {

PlainKey format_key() {
  return {.doc = "Version of the scene language: 1.", .range = Range::between(1, 1)};
}

void check_recording(const DiscScene& scene, std::vector<Problem>& problems) {
  if (!scene.record) return;
  const std::size_t per_pad = contact_offsets(scene.model).size();
  if (!scene.record->channels.empty() && per_pad <= most_contact_points) {
    const std::vector<Problem> channels = channel_problems(scene.record->channels, per_pad);
    problems.insert(problems.end(), channels.begin(), channels.end());
  }
  if (!scene.time) return;
  const double ratio = scene.record->interval / scene.time->step;
  if (ratio < 1.0 - 1e-9 || std::abs(ratio - std::round(ratio)) > 1e-6 || std::round(ratio) > 1e5) {
    problems.push_back(
        {"record.interval",
         fmt::format("must be a whole multiple of time.step = {:g} s, up to 100000 of "
                     "them; got {:g} s",
                     scene.time->step, scene.record->interval),
         {},
         0,
         0});
  }
}

/// The matrices of one body, with checks that name their keys.
class MatrixLoader {
 public:
  /// @param key  path of the body
  /// @param tree of the scene; must live longer
  MatrixLoader(std::string key, const SceneNode& tree) : key_(std::move(key)), tree_(&tree) {}

  SceneMatrices load(const MatrixBodyParameters& body) const {
    SceneMatrices parts;
    parts.mass = matrix("mass", body.mass, 0);
    const Eigen::Index n = parts.mass.rows();
    expect_symmetry("mass", parts.mass, 1.0);
    try {
      SparseCholesky(parts.mass, "the mass");
    } catch (const NumericalError&) {
      fail("mass", "must be positive definite");
    }
    parts.damping = matrix("damping", body.damping, n);
    parts.gyroscopic = matrix("gyroscopic", body.gyroscopic, n);
    expect_symmetry("gyroscopic", parts.gyroscopic, -1.0);
    parts.stiffness = matrix("stiffness", body.stiffness, n);
    parts.circulatory = matrix("circulatory", body.circulatory, n);
    expect_symmetry("circulatory", parts.circulatory, -1.0);
    parts.load_damping = matrix("load_damping", body.load_damping, n);
    parts.load_stiffness = matrix("load_stiffness", body.load_stiffness, n);
    return parts;
  }

 private:
  [[noreturn]] void fail(const char* name, const std::string& message) const {
    throw ConfigError(key_ + "." + name, message);
  }

  /// @param size expected; 0: any
  SparseMatrix matrix(const char* name, const MatrixText& text, Eigen::Index size) const {
    if (text.empty() && size == 0) fail(name, "is empty, expected a matrix");
    if (text.empty()) return SparseMatrix(size, size);
    SparseMatrix read;
    const bool is_number =
        text.front().find_first_not_of("+-.eE0123456789 \t") == std::string::npos;
    if (text.size() == 1 && !is_number) {
      read = read_matrix_file(path_of_file(*tree_, key_ + "." + name, text.front()));
    } else {
      try {
        read = parse_matrix_rows(text);
      } catch (const std::invalid_argument& error) {
        fail(name, error.what());
      }
    }
    const bool is_square = read.rows() == read.cols();
    if (!is_square || (size > 0 && read.rows() != size)) {
      fail(name, fmt::format("is {} x {}, expected {}", read.rows(), read.cols(),
                             size > 0 ? fmt::format("{} x {} as `mass` is", size, size)
                                      : std::string("as many rows as columns")));
    }
    return read;
  }

  /// @param sign 1 symmetric, −1 skew-symmetric
  void expect_symmetry(const char* name, const SparseMatrix& matrix, double sign) const {
    const SparseMatrix transposed = matrix.transpose();
    const SparseMatrix difference = matrix - sign * transposed;
    if (difference.norm() > 1e-12 * matrix.norm())
      fail(name, sign > 0.0 ? "must be symmetric" : "must be skew-symmetric");
  }

  std::string key_;
  const SceneNode* tree_;
};

SparseSystem sum(const SceneMatrices& parts, const MatrixBodyParameters& body) {
  const MatrixFactors& factors = body.factors;
  SparseSystem system;
  system.mass = parts.mass;
  system.velocity = factors.damping * parts.damping + factors.gyroscopic * parts.gyroscopic +
                    body.load * parts.load_damping;
  system.position = factors.stiffness * parts.stiffness + factors.circulatory * parts.circulatory +
                    body.load * parts.load_stiffness;
  return system;
}

LinearSystem dense_system(const SparseSystem& sparse) {
  LinearSystem dense;
  dense.mass = sparse.mass;
  dense.velocity = sparse.velocity;
  dense.position = sparse.position;
  dense.gaps = dense.forces = Eigen::MatrixXd(0, sparse.size());
  return dense;
}

LinearModel model_of(const DiscScene& scene, const LoadedLinearScene&) {
  LinearModel model;
  model.disc = make_disc_model(scene.model);
  model.dense = model.disc->system;
  model.highest_frequency = model.disc->highest_frequency;
  return model;
}

/// @throws ConfigError with the key path
LinearModel model_of(const MatrixScene& scene, const LoadedLinearScene& loaded) {
  const auto& [name, variant] = *scene.substructures.begin();
  const auto& body = std::get<MatrixBodyParameters>(variant);
  if (!loaded.matrices) {
    loaded.matrices = std::make_shared<const SceneMatrices>(
        MatrixLoader("substructures." + name, loaded.tree).load(body));
  }
  SparseSystem sparse = sum(*loaded.matrices, body);
  LinearModel model;
  model.highest_frequency = std::numeric_limits<double>::infinity();
  if (sparse.size() > largest_dense_size) {
    model.sparse = std::move(sparse);
  } else {
    model.dense = dense_system(sparse);
  }
  return model;
}

}  // namespace

const Schema& DiscScene::schema() {
  static const Schema keys =
      SchemaOf<DiscScene>("disc_and_pads")
          .integer("format", &DiscScene::format, format_key())
          .include(&DiscScene::model)
          .section("time", &DiscScene::time, {.doc = "Steps of `run`.", .optional = true})
          .section("initial", &DiscScene::initial,
                   {.doc = "Where `run` starts, about steady sliding.", .optional = true})
          .section("record", &DiscScene::record, {.doc = "What `run` writes.", .optional = true})
          .section("checkpoint", &DiscScene::checkpoint,
                   {.doc = "When the state of a run is stored.", .optional = true})
          .section_list("expect", &DiscScene::expect,
                        {.doc = "Results that `run --verify` checks.", .optional = true})
          .check(check_recording);
  return keys;
}

const Schema& DiscTimeParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscTimeParameters>("disc_time")
          .real("step", &DiscTimeParameters::step,
                {.doc = "Time step. What is linear is exact at any step; a contact that opens or "
                        "sticks is of second order in it.",
                 .unit = "s",
                 .range = Range::positive()})
          .real("end", &DiscTimeParameters::end,
                {.doc = "End of the run.", .unit = "s", .range = Range::positive()});
  return keys;
}

const Schema& DiscInitialParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscInitialParameters>("disc_initial")
          .section(
              "perturbation", &DiscInitialParameters::perturbation,
              {.doc = "An eigenvector of the motion about steady sliding; its amplitude is the "
                      "largest displacement of a pad."});
  return keys;
}

const Schema& DiscRecordParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscRecordParameters>("disc_record")
          .real("interval", &DiscRecordParameters::interval,
                {.doc = "Time between samples, a multiple of time.step; motions and forces are "
                        "low-passed before they are thinned to it.",
                 .unit = "s",
                 .range = Range::positive()})
          .text_list("channels", &DiscRecordParameters::channels,
                     {.doc = "What is recorded: pad.<contact>.<r|phi|z>.<displacement|velocity|"
                             "acceleration>, disc.<contact>.z.<...>, <contact>.<force|"
                             "friction_force|gap|slip_velocity|state>, with the contacts upper and "
                             "lower, or upper_0, upper_1, ... where a pad has several points. "
                             "Default: all.",
                      .optional = true});
  return keys;
}

const Schema& MatrixScene::schema() {
  static const Schema keys =
      SchemaOf<MatrixScene>("matrix_scene")
          .integer("format", &MatrixScene::format, format_key())
          .named_variants("substructures", &MatrixScene::substructures, "type", {"matrices"},
                          {.doc = "One body, given by its matrices."})
          .check([](const MatrixScene& scene, std::vector<Problem>& problems) {
            if (scene.substructures.size() != 1) {
              problems.push_back({"substructures",
                                  "a body given by matrices stands alone; put several into the "
                                  "blocks of one",
                                  {},
                                  0,
                                  0});
            }
          });
  return keys;
}

bool is_disc_scene(const SceneNode& tree) {
  return tree.entry("disc") != nullptr && tree.entry("substructures") == nullptr;
}

bool is_matrix_scene(const SceneNode& tree) {
  const SceneEntry* bodies = tree.entry("substructures");
  if (bodies == nullptr) return false;
  for (const SceneEntry& body : bodies->value.entries) {
    const SceneEntry* type = body.value.entry("type");
    if (type != nullptr && type->value.text == "matrices") return true;
  }
  return false;
}

bool is_linear_scene(const SceneNode& tree) {
  return is_disc_scene(tree) || is_matrix_scene(tree);
}

LinearScene read_linear_scene(const SceneNode& tree) {
  if (is_disc_scene(tree)) return read_as<DiscScene>(tree);
  return read_as<MatrixScene>(tree);
}

const Schema& schema_of(const LinearScene& scene) {
  return std::visit(
      [](const auto& one) -> const Schema& { return std::decay_t<decltype(one)>::schema(); },
      scene);
}

const void* object_of(const LinearScene& scene) {
  return std::visit([](const auto& one) -> const void* { return &one; }, scene);
}

std::string LoadedLinearScene::resolved() const {
  return resolved_yaml(schema_of(scene), object_of(scene));
}

std::string LoadedLinearScene::hash() const {
  return scene_hash(resolved());
}

LinearModel LoadedLinearScene::model() const {
  try {
    return std::visit([&](const auto& one) { return model_of(one, *this); }, scene);
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    locate(problems, tree);
    throw ConfigError(std::move(problems));
  }
}

LinearModel LoadedLinearScene::model(const std::vector<NumericKey>& keys,
                                     std::span<const double> values) const {
  LoadedLinearScene changed = *this;
  for (std::size_t i = 0; i < keys.size(); ++i)
    set_value(changed.tree, fmt::format("{}={}", keys[i].path, values[i]));
  changed.scene = read_linear_scene(changed.tree);
  LinearModel made = changed.model();
  matrices = changed.matrices;
  return made;
}

bool is_linear_scene_file(const std::string& path) {
  return is_linear_scene(read_scene_file(path));
}

LoadedLinearScene load_resolved_linear_scene(const std::string& text, const std::string& source) {
  LoadedLinearScene loaded;
  loaded.path = source;
  loaded.tree = read_scene_text(text, source);
  loaded.scene = read_linear_scene(loaded.tree);
  return loaded;
}

LoadedLinearScene load_linear_scene(const std::string& path, const std::vector<std::string>& sets) {
  LoadedLinearScene loaded;
  loaded.path = path;
  loaded.tree = read_scene_file(path);
  for (const std::string& assignment : sets) set_value(loaded.tree, assignment);
  loaded.scene = read_linear_scene(loaded.tree);
  return loaded;
}

}  // namespace stridor
