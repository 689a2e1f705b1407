// Keys of bodies given by their modes, and what the program asks of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "substructures/bodies/modes_body.hpp"
#include "substructures/bodies/realised_shape.hpp"

namespace stridor {
namespace {

void expect_place(const std::vector<double>& at, const char* key, std::vector<Problem>& problems) {
  if (at.empty() || at.size() == 2 || at.size() == 3) return;
  problems.push_back(
      {Refusal::wrong_size, key, fmt::format("must be two or three lengths, got {}", at.size())});
}

}  // namespace

const Schema& ModesPortParameters::schema() {
  using P = ModesPortParameters;
  const auto shape = [](const char* doc) { return RealKey{.doc = doc, .optional = true}; };
  static const Schema keys =
      SchemaOf<P>("modes_port")
          .real_list("at", &P::at,
                     {.doc = "Place in the frame of the body: x, y and perhaps z; default: that of "
                             "the node in the file.",
                      .unit = "m",
                      .optional = true})
          .integer("node", &P::node,
                   {.doc = "Number of a node in the file, whose measured shapes it has.",
                    .optional = true})
          .real_list("x", &P::x,
                     shape("Displacement along x in each mode, normalised to the modal mass (1/√kg for "
                           "a mass of 1 kg); absent: the port does not move along x."))
          .real_list("y", &P::y, shape("The same along y."))
          .real_list("z", &P::z, shape("The same along z."))
          .check([](const P& port, std::vector<Problem>& problems) {
            expect_place(port.at, "at", problems);
            for (const auto& [key, given] :
                 {std::pair("x", &port.x), std::pair("y", &port.y), std::pair("z", &port.z)}) {
              if (!port.node || given->empty()) continue;
              problems.push_back({Refusal::contradiction, key,
                                  "cannot stand beside `node`, whose shapes are in the file"});
            }
            if (!port.node && port.at.empty())
              problems.push_back(
                  {Refusal::missing, "at", "is missing; give it, or a `node` of the file"});
          });
  return keys;
}

const Schema& RigidMotionParameters::schema() {
  using P = RigidMotionParameters;
  static const Schema keys =
      SchemaOf<P>("rigid_motion")
          .real("mass", &P::mass, {.doc = "Of the body.", .unit = "kg", .range = Range::positive()})
          .real_list("centre", &P::centre,
                     {.doc = "Centre of mass in the frame of the body.", .unit = "m"})
          .real_list("inertia", &P::inertia,
                     {.doc = "Moments of inertia about the centre of mass: one number, about z, of a body "
                             "that moves in its plane; three, about x, y and z as principal axes.",
                      .unit = "kg m2",
                      .range = Range::positive()})
          .check([](const P& rigid, std::vector<Problem>& problems) {
            expect_place(rigid.centre, "centre", problems);
            if (rigid.inertia.size() != 1 && rigid.inertia.size() != 3)
              problems.push_back(
                  {Refusal::wrong_size, "inertia",
                   fmt::format("must be one or three numbers, got {}", rigid.inertia.size())});
          });
  return keys;
}

const Schema& ResidualParameters::schema() {
  using P = ResidualParameters;
  static const Schema keys =
      SchemaOf<P>("residual")
          .text_list("on", &P::on, {.doc = "Displacements of ports, `<port>.<x|y|z>`, in the order of the rows."})
          .text_rows("flexibility", &P::flexibility,
                     {.doc = "Static displacements by unit forces on these, less those of the modes given: "
                             "a symmetric matrix in m/N, rows or a Matrix Market file."})
          .real("frequency", &P::frequency,
                {.doc = "Frequency at which what is not among the modes is taken to vibrate; default: ten "
                        "times the highest mode.",
                 .unit = "Hz",
                 .range = Range::positive(),
                 .optional = true});
  return keys;
}

// Long because it is a table: one entry for each key.
const Schema& ModesBodyParameters::schema() {
  using P = ModesBodyParameters;
  static const Schema keys =
      SchemaOf<P>("modes_body")
          .real_list("frequencies", &P::frequencies,
                     {.doc = "Undamped natural frequency of each mode; default: those of the file.",
                      .unit = "Hz",
                      .range = Range::non_negative(),
                      .optional = true})
          .real_list("damping_ratios", &P::damping_ratios,
                     {.doc = "Of each mode, or one of all; default: those of the file, else 0.",
                      .range = Range::non_negative(),
                      .optional = true})
          .real_list(
              "modal_masses", &P::modal_masses,
              {.doc = "Of the shapes as they are given, of each mode or one of all; default: those "
                      "of the file, else 1 kg.",
               .unit = "kg",
               .range = Range::positive(),
               .optional = true})
          .text("file", &P::file,
                {.doc = "Universal file (UFF) of a modal test, from the folder of the scene: "
                        "datasets 55, "
                        "and 15 or 2411 for places, 164 for units.",
                 .optional = true})
          .real_list("take", &P::take,
                     {.doc = "Numbers of the modes of the file that are taken; default: all.",
                      .optional = true})
          .real("complexity", &P::complexity,
                {.doc = "Largest part of a complex shape that may be out of phase, and is left "
                        "out; more is "
                        "refused.",
                 .range = {0.0, 1.0, false, false},
                 .optional = true})
          .named_sections(
              "ports", &P::ports,
              {.doc = "Places at which the shapes are known: they touch others, carry loads "
                      "and are recorded."})
          .named_sections("surfaces", &P::surfaces,
                          {.doc = "Outlines of ports on which others slide.", .optional = true})
          .section(
              "rigid", &P::rigid,
              {.doc = "Rigid motions of a body that is free; absent: the modes hold all motions.",
               .optional = true})
          .section(
              "residual", &P::residual,
              {.doc = "Flexibility of the modes that are not given, at ports.", .optional = true})
          .real("complete_up_to", &P::complete_up_to,
                {.doc = "Frequency below which no mode of the body is missing; results above it "
                        "are marked.",
                 .unit = "Hz",
                 .range = Range::positive(),
                 .optional = true})
          .check([](const P& body, std::vector<Problem>& problems) {
            const auto problem = [&](Refusal refusal, const char* key, const std::string& text) {
              problems.push_back({refusal, key, text});
            };
            const bool has_file = !body.file.empty();
            if (body.frequencies.empty() && !has_file && !body.rigid)
              problem(Refusal::missing, "frequencies", "is missing; give it, a `file` or `rigid`");
            if (has_file && !body.frequencies.empty())
              problem(Refusal::contradiction, "frequencies",
                      "are in the file already; leave one of them out");
            if (!has_file && !body.take.empty())
              problem(Refusal::contradiction, "take", "is of a `file`; give one");
            if (body.ports.empty()) problem(Refusal::wrong_value, "ports", "must be at least one");
            for (const auto& [name, port] : body.ports) {
              if (has_file && !port.node)
                problem(Refusal::missing, ("ports." + name + ".node").c_str(),
                        "is missing: the shapes are in the file");
              if (!has_file && port.node)
                problem(Refusal::contradiction, ("ports." + name + ".node").c_str(),
                        "is of a `file`; give one");
            }
          });
  return keys;
}

std::vector<NamedFile> ModesBodyParameters::files() {
  std::vector<NamedFile> named;
  if (!file.empty()) named.push_back({"file", &file});
  if (residual && residual->flexibility.size() == 1 && !residual->flexibility.front().empty() &&
      residual->flexibility.front().find_first_not_of("0123456789+-.eEdD \t") != std::string::npos)
    named.push_back({"residual.flexibility", &residual->flexibility.front()});
  return named;
}

void ModesBodyParameters::read(const BodyFiles& read_by) {
  if (!file.empty()) test = std::make_shared<const ModalTest>(read_by.modal_test("file", file));
  if (!residual) return;
  try {
    const bool is_file = files().size() > (file.empty() ? 0u : 1u);
    residual_flexibility = std::make_shared<const SparseMatrix>(
        is_file ? read_by
                      .matrix("residual.flexibility", residual->flexibility.front(),
                              MatrixPurpose::any)
                      .matrix
                : read_by.matrix(residual->flexibility));
  } catch (const std::invalid_argument& error) {
    throw ConfigError(Refusal::wrong_value, "residual.flexibility", error.what());
  }
}

bool ModesBodyParameters::take_contents(const BodyParameters& other) {
  const auto* given = dynamic_cast<const ModesBodyParameters*>(&other);
  if (given == nullptr || given->file != file || given->residual.has_value() != residual.has_value())
    return false;
  if (residual && given->residual->flexibility != residual->flexibility) return false;
  const bool has_read = (file.empty() || given->test) && (!residual || given->residual_flexibility);
  if (!has_read) return false;
  test = given->test;
  residual_flexibility = given->residual_flexibility;
  return true;
}

double ModesBodyParameters::num_slave_nodes(const std::string& name) const {
  const auto surface = surfaces.find(name);
  return surface == surfaces.end() ? 1.0 : static_cast<double>(surface->second.points.size());
}

ReductionSize ModesBodyParameters::reduction_size(double /*interface_nodes*/) const {
  ReductionSize size;
  size.interface = static_cast<double>(!frequencies.empty() ? frequencies.size()
                                       : test               ? test->modes.size()
                                                            : 0);
  return size;
}

SizeKey ModesBodyParameters::size_key() const {
  return {".take", "take fewer modes"};
}

std::vector<Problem> ModesBodyParameters::warnings() const {
  std::vector<Problem> found;
  if (!test) return found;
  for (const std::string& remark : test->remarks)
    found.push_back({Refusal::wrong_value, "file", fmt::format("{} {}", file, remark)});
  double worst = 0.0;
  for (const TestMode& mode : test->modes) worst = std::max(worst, realise(mode).complexity);
  constexpr double rounding = 1e-3;
  if (worst > rounding) {
    found.push_back(
        {Refusal::wrong_value, "file",
         fmt::format("has complex shapes, of which real ones are made: up to {:.2g} % is "
                     "out of phase and left out",
                     100.0 * worst)});
  }
  return found;
}

}  // namespace stridor
