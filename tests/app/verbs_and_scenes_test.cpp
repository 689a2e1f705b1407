// Every verb on every sort of system: docs/verbs.md says what is done and why the rest is refused.
#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;

using Words = std::vector<std::string>;

/// A key and two of its values.
struct Axis {
  std::string key, from, to;
};

/// A scene, with settings that keep it short and give it the sections that a verb needs.
struct System {
  std::string scene;
  std::string what;
  std::string channel;
  std::string force;  ///< where and along what a force acts for frequency responses
  Words sets;
  Axis x, y;
};

const std::vector<System>& systems() {
  static const Axis friction{"contact.friction.coefficient", "0.1", "0.4"};
  static const Axis place{"contact.start", "0.04", "0.06"};
  static const Words short_ramp{"drive.ramp=1e-3", "time.end=4e-3", "measure={from: 2e-3}"};
  static const auto with = [](Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  static const std::vector<System> all{
      {"beam_on_beam", "two beams, sliding persistently", "contact.force", "cantilever.free_end.y",
       with(short_ramp,
            {"contact.armed_from=1", "substructures.cantilever.reduction.fixed_interface_modes=5",
             "substructures.oblique.reduction.fixed_interface_modes=5"}),
       friction, place},
      {"examples/two_pairs",
       "two pairs on one beam",
       "front.force",
       "cantilever.free_end.y",
       with(short_ramp, {"contacts.front.armed_from=1", "contacts.rear.armed_from=1"}),
       {"contacts.rear.friction.coefficient", "0.1", "0.4"},
       {"drive.load", "-0.2", "-0.1"}},
      {"examples/frozen_growth",
       "a beam held at its place",
       "contact.force",
       "cantilever.free_end.y",
       {"time.end=4e-3", "measure={from: 2e-3}"},
       friction,
       place},
      {"examples/rotating_support",
       "a beam on a turning support",
       "contact.force",
       "support.middle.y",
       {"time.end=0.05", "measure={from: 0.03}"},
       {"parameters.spin", "500", "600"},
       {"drive.load", "-2", "-1"}},
      {"examples/beam_on_substrate",
       "a beam on rubber",
       "contact.force",
       "reed.tip.x",
       {"time.end=0.04", "measure={from: 0.02}"},
       {"drive.load", "-0.03", "-0.01"},
       {"drive.velocity", "0.1", "0.2"}},
      {"examples/mass_on_belt",
       "a mass on a belt",
       "contact.friction_force",
       "slider.mass.x",
       {"time.end=1", "measure={from: 0.5}"},
       {"parameters.mu_d", "0.1", "0.3"},
       {"drive.velocity", "0.1", "0.2"}},
      {"viscoelastic_sphere",
       "a sphere on rubber, from event to event",
       "contact.force",
       "sphere.center.x",
       {"time.end=2"},
       {"parameters.F", "1e-3", "2e-3"},
       {"parameters.v", "0.1", "0.2"}},
      {"examples/flutter",
       "matrices that nothing touches",
       "oscillator.point.x.displacement",
       "oscillator.point.x",
       {"time={integrator: exact, step: 1e-2, end: 20}", "parameters={load: 0.3, k: 1.4}",
        "substructures.oscillator.stiffness=[[1, 0], [0, =k]]",
        "substructures.oscillator.points={point: {at: [0, 0], x: 1, y: 2}}",
        "initial={state: equilibrium, perturbation: {eigenvalue: 1, amplitude: 1e-3}}",
        "record={interval: 0.1, channels: [oscillator.point.x.displacement]}"},
       {"parameters.load", "0.1", "0.3"},
       {"parameters.k", "1.2", "1.6"}},
      {"viscoelastic_contact",
       "a normal law by itself",
       "contact.force",
       "none.none.x",
       {"time={step: 1e-3, end: 0.1}"},
       {"contacts.tip.normal.profile.radius", "0.01", "0.02"},
       {"contacts.tip.normal.material.poissons_ratio", "0.4", "0.5"}},
      {"disc_and_pads",
       "a disc and pads",
       "upper.force",
       "upper.block.y",
       {"time.end=1e-3"},
       {"parameters.mu", "0.2", "0.5"},
       {"substructures.disc.spin", "5", "10"}},
      {"examples/elastic_pads",
       "a disc and elastic pads",
       "upper[0].force",
       "upper.p0.y",
       {"time.end=1e-3"},
       {"parameters.mu", "0.2", "0.5"},
       {"substructures.disc.spin", "5", "10"}},
  };
  return all;
}

/// Why a verb may refuse a system: what the message says, and the same in a line.
struct Reason {
  std::string message;  ///< a part of it
  std::string text;
};

const std::vector<Reason>& reasons() {
  static const std::vector<Reason> all{
      {"comes to its end",
       "the contact moves along a master that ends, so that nothing repeats "
       "itself (`sliding: frozen` holds its place)"},
      {"nothing touches its bodies",
       "nothing touches the bodies, so that nothing keeps them moving"},
      {"no contact with the normal law viscoelastic",
       "there is no viscoelastic normal law, the one that is evaluated"},
      {"the step of a contact with a substrate has no frozen form",
       "a force law closes the contact, whose step cannot be written with it closed"},
      {"the others slide on a rigid constraint",
       "the other contact assumptions slide on a rigid constraint, which rubber is not"},
      {"event_driven",
       "the integrator goes from event to event and has no steps of a given length"},
      {"without bodies", "there are no bodies, which could move"},
      {"`compare` needs this section", "there is no contact, whose assumptions could be compared"},
      {"contacts stay at their place, so that no motion is prescribed",
       "two of the four assumptions prescribe the motion of a contact along its master, and on the "
       "face of a plate it stays at its place"}};
  return all;
}

struct Verb {
  std::string name;
  std::string what;
  Words (*arguments)(const System&, const std::string& scene, const std::string& folder);
  bool makes_runs = false;
};

Words along(const std::string& verb, const System& system, const std::string& scene,
            const Words& more) {
  Words words{verb,     scene,         "--parameter", system.x.key,
              "--from", system.x.from, "--to",        system.x.to};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

const std::vector<Verb>& verbs() {
  using S = const System&;
  using T = const std::string&;
  static const std::vector<Verb> all{
      {"check", "the keys",
       [](S, T scene, T) {
         return Words{"check", scene};
       }},
      {"check --stability", "growth by the step itself",
       [](S, T scene, T) {
         return Words{"check", "--stability", scene};
       }},
      {"draw", "a picture before anything is run",
       [](S, T scene, T folder) {
         return Words{"draw", scene, "-o", folder + "/scene.svg"};
       }},
      {"run", "the motion in time",
       [](S, T scene, T folder) {
         return Words{"run", scene, "-o", folder + "/run.h5"};
       }},
      {"run --error", "and its error",
       [](S, T scene, T folder) {
         return Words{"run", scene, "-o", folder + "/error.h5", "--error"};
       },
       true},
      {"plot", "a run drawn",
       [](S, T, T folder) {
         return Words{"plot", folder + "/run.h5", "--kind", "history", "-o", folder + "/run.png"};
       }},
      {"spectrogram", "frequencies of a run over time",
       [](S system, T, T folder) {
         return Words{"spectrogram", folder + "/run.h5",         "--channel", system.channel,
                      "-o",          folder + "/spectrogram.png"};
       }},
      {"sound", "a run heard",
       [](S system, T, T folder) {
         return Words{"sound", folder + "/run.h5",  "--channel", system.channel,
                      "-o",    folder + "/run.wav"};
       }},
      {"report", "a page of a run",
       [](S, T, T folder) {
         return Words{"report", folder + "/run.h5", "-o", folder + "/run.html"};
       }},
      {"eig", "eigenvalues and what explains them",
       [](S, T scene, T) {
         return Words{"eig", scene, "--explain"};
       }},
      {"locus", "eigenvalues along a key",
       [](S system, T scene, T) {
         return along("locus", system, scene, {"--points", "2"});
       }},
      {"frf", "frequency responses",
       [](S system, T scene, T folder) {
         return Words{"frf",  scene,  "--input",  system.force, "--from", "10",
                      "--to", "1000", "--points", "20",         "-o",     folder + "/frf.h5"};
       }},
      {"threshold", "where one becomes unstable",
       [](S system, T scene, T) { return along("threshold", system, scene, {}); }},
      {"map", "stability over two keys",
       [](S system, T scene, T folder) {
         return Words{"map",       scene, "--x", system.x.key,      system.x.from,
                      system.x.to, "2",   "--y", system.y.key,      system.y.from,
                      system.y.to, "2",   "-o",  folder + "/map.h5"};
       }},
      {"cycle", "periodic motions",
       [](S, T scene, T) {
         return Words{"cycle", scene, "--set", "cycle.settle=0.02"};
       }},
      {"sweep", "runs along a key",
       [](S system, T scene, T) {
         return along("sweep", system, scene, {"--points", "2"});
       }},
      {"compare", "contact assumptions",
       [](S, T scene, T folder) {
         return Words{"compare", scene, "-o", folder + "/compare"};
       },
       true},
      {"precision", "errors of steps and modes",
       [](S, T scene, T folder) {
         return Words{"precision", scene, "-o", folder + "/precision"};
       },
       true},
      {"contact", "the normal law",
       [](S, T scene, T) {
         return Words{"contact", scene, "--speed", "0.1", "--indentation", "0.01"};
       }},
  };
  return all;
}

/// The reason that a message gives; null, and a failure, where it is none of the list.
const Reason* reason_of(const std::string& message, const std::string& where) {
  for (const Reason& reason : reasons()) {
    if (message.find(reason.message) == std::string::npos) continue;
    const std::regex kind("scenes? of|kind of scene", std::regex::icase);
    EXPECT_FALSE(std::regex_search(message, kind))
        << where << " says what kind of scene it is, in the place of a physical reason:\n"
        << message;
    return &reason;
  }
  ADD_FAILURE() << where << " is refused for none of the reasons allowed:\n" << message;
  return nullptr;
}

/// Whether each verb takes a system: null where it does.
std::vector<const Reason*> outcomes_of(const System& system) {
  const TemporaryFolder folder;
  std::vector<const Reason*> outcomes;
  const Reason* of_run = nullptr;
  for (const Verb& verb : verbs()) {
    const bool reads_run =
        verb.name == "plot" || verb.name == "spectrogram" || verb.name == "sound" ||
        verb.name == "report";
    if (reads_run && of_run != nullptr) {
      outcomes.push_back(of_run);
      continue;
    }
    Words words = verb.arguments(system, scene_path(system.scene + ".yaml"), folder.path());
    if (!reads_run) {
      for (const std::string& set : system.sets) words.insert(words.end(), {"--set", set});
    }
    const ProgramResult result = Program(words).run();
    const std::string where = verb.name + " of " + system.scene;
    EXPECT_THAT(result.exit_code, ::testing::AnyOf(0, 2)) << where << '\n' << result.err;
    // What makes runs of its own may miss channels first; it is refused for the reason of `run`.
    const bool is_of_run = verb.makes_runs && of_run != nullptr && result.exit_code == 2;
    outcomes.push_back(is_of_run               ? of_run
                       : result.exit_code == 0 ? nullptr
                                               : reason_of(result.err, where));
    if (verb.name == "run") of_run = outcomes.back();
  }
  return outcomes;
}

std::string page() {
  std::vector<std::string> given;  // reasons, in the order of their numbers
  const auto number_of = [&](const Reason& reason) {
    std::size_t i = 0;
    while (i < given.size() && given[i] != reason.text) ++i;
    if (i == given.size()) given.push_back(reason.text);
    return std::to_string(i + 1);
  };
  std::string head = "| |";
  std::string line = "|---|";
  Words rows;
  for (const Verb& verb : verbs()) rows.push_back("| `" + verb.name + "`: " + verb.what + " |");
  Words legend;
  for (std::size_t k = 0; k < systems().size(); ++k) {
    const System& system = systems()[k];
    const std::string letter(1, static_cast<char>('A' + k));
    head += " " + letter + " |";
    line += "---|";
    legend.push_back("- " + letter + ": " + system.what + ", [`scenes/" + system.scene +
                     ".yaml`](../scenes/" + system.scene + ".yaml)");
    const auto outcomes = outcomes_of(system);
    for (std::size_t v = 0; v < outcomes.size(); ++v)
      rows[v] += outcomes[v] != nullptr ? " " + number_of(*outcomes[v]) + " |" : " ✓ |";
  }
  std::string text =
      "# What each verb does with each system\n\n"
      "A verb takes every system for which what it computes exists (✓); else the number is that of "
      "the\n"
      "reason below. The table is written by `STRIDOR_WRITE_PAGES=1 verbs_and_scenes_test`, which "
      "runs every\n"
      "verb on every scene, shortened, and which compares it where that is not set. `info`, `fit` "
      "and\n"
      "`schema` take no scenes.\n\n" +
      head + "\n" + line + "\n";
  for (const std::string& row : rows) text += row + "\n";
  text += "\nSystems:\n\n";
  for (const std::string& one : legend) text += one + "\n";
  text += "\nReasons:\n\n";
  for (std::size_t i = 0; i < given.size(); ++i)
    text += std::to_string(i + 1) + ". " + given[i] + "\n";
  return text;
}

TEST(VerbsAndScenes, PageSaysWhatEveryVerbDoesWithEverySystem) {
  const std::filesystem::path path = STRIDOR_SOURCE_DIR "/docs/verbs.md";
  const std::string made = page();
  if (std::getenv("STRIDOR_WRITE_PAGES") != nullptr && !HasFailure()) write_file(path, made);
  EXPECT_EQ(contents_of(path), made)
      << "write it again: STRIDOR_WRITE_PAGES=1 verbs_and_scenes_test";
}

TEST(VerbsAndScenes, ReasonsArePhysical) {
  EXPECT_NONFATAL_FAILURE((void)reason_of("takes a scene of a violin", "run"),
                          "none of the reasons");
  EXPECT_NONFATAL_FAILURE((void)reason_of("a scene of beams, without bodies", "run"),
                          "what kind of scene");
  EXPECT_EQ(reason_of("without bodies nothing moves", "run"), &reasons()[6]);
}

}  // namespace
}  // namespace stridor
