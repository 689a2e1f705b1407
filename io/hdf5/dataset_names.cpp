#include "io/hdf5/dataset_names.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stridor {
namespace {

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string spaced(std::string words) {
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

/// "cantilever.free_end.y.acceleration"; a name of the body may hold dots of its own.
std::string channel_text(const std::string& channel) {
  std::vector<std::string> parts = parts_of(channel, '.');
  if (parts.size() < 2) return spaced(channel);
  const std::string quantity = spaced(parts.back());
  parts.pop_back();
  std::string along;
  if (parts.size() > 1 && (parts.back() == "x" || parts.back() == "y" || parts.back() == "z")) {
    along = " along " + parts.back();
    parts.pop_back();
  }
  std::string place;
  for (const std::string& part : parts) place += (place.empty() ? "" : ".") + part;
  return quantity + " of " + place + along;
}

/// The long name of a dataset; a name in the path is `*`, its place in the text `{}`.
struct DatasetName {
  const char* path;
  const char* text;
};

constexpr std::array dataset_names{
    // Runs.
    DatasetName{"/time", "time since the start"},
    DatasetName{"/contact/*/force", "contact force of {}"},
    DatasetName{"/contact/*/friction_force", "friction force of {} along the first tangent"},
    DatasetName{"/contact/*/friction_across", "friction force of {} along the second tangent"},
    DatasetName{"/contact/*/gap", "gap of the contact {}"},
    DatasetName{"/contact/*/slip_velocity",
                "slip velocity of the contact {} along the first tangent"},
    DatasetName{"/contact/*/slip_across",
                "slip velocity of the contact {} along the second tangent"},
    DatasetName{"/contact/*/position", "position of the contact {} along the master"},
    DatasetName{"/contact/*/state", "state of the contact {}: open, stick or slip"},
    DatasetName{"/contact/*/area", "area of the contact {}"},
    DatasetName{"/energy/*", "{} in the balance of energy"},
    DatasetName{"/bursts/number", "number of the burst"},
    DatasetName{"/bursts/start", "time at which the burst begins"},
    DatasetName{"/bursts/end", "time at which the burst ends"},
    DatasetName{"/bursts/frequency", "frequency of the burst where it rises most steeply"},
    DatasetName{"/bursts/peak", "largest amplitude of the acceleration in the burst"},
    DatasetName{"/bursts/gain", "natural logarithm of the rise of the burst"},
    DatasetName{"/bursts/start_frequency", "frequency at which the burst begins"},
    DatasetName{"/bursts/end_frequency", "frequency at which the burst ends"},
    DatasetName{"/bursts/harmonic_of",
                "index, from 0, of the louder burst of which this one is a harmonic; -1: none"},
    DatasetName{"/bursts/order", "multiple of the frequency of that louder burst; 1: none"},
    DatasetName{"/bursts/course/number", "number of the point of the courses"},
    DatasetName{"/bursts/course/burst", "index, from 0, of the burst to which the point belongs"},
    DatasetName{"/bursts/course/time", "time at the point of the course of the burst"},
    DatasetName{"/bursts/course/frequency", "frequency at the point of the course of the burst"},
    DatasetName{"/bursts/course/level", "r.m.s. value of the burst at the point of its course"},
    DatasetName{"/bursts/window",
                "index, from 0, of the predicted window that explains the burst; -1: none"},
    DatasetName{"/bursts/value", "value of the parameter in whose run the burst was"},
    DatasetName{"/windows/number", "number of the predicted window"},
    DatasetName{"/windows/from", "time at which the run comes into the unstable window"},
    DatasetName{"/windows/to", "time at which the run leaves the unstable window"},
    DatasetName{"/windows/frequency", "frequency of the mode that grows fastest in the window"},
    DatasetName{"/windows/growth_max", "growth rate of the mode that grows fastest in the window"},
    DatasetName{"/windows/gain", "integral of the growth rate over the time in the window"},
    DatasetName{"/windows/burst", "index, from 0, of the burst that the window explains; -1: none"},
    DatasetName{"/modal/*/number", "number of the mode of {}"},
    DatasetName{"/modal/*/frequency", "natural frequency of {} by itself"},
    DatasetName{"/modal/*/damping_ratio", "damping ratio of the mode of {} by itself"},
    DatasetName{"/final/time", "time at the end of the run"},
    DatasetName{"/final/drive", "number of the drive"},
    DatasetName{"/final/drive_displacement", "displacement of the drive at the end of the run"},
    DatasetName{"/final/*/coordinate", "number of the reduced coordinate of {}"},
    DatasetName{"/final/*/displacement",
                "displacement of {} at the end of the run, in reduced coordinates"},
    DatasetName{"/final/*/velocity",
                "velocity of {} at the end of the run, in reduced coordinates"},
    DatasetName{"/checkpoint/*", "state from which the run can go on, as bytes ({} of two)"},
    DatasetName{"/scene/text", "the scene as it was given"},
    DatasetName{"/scene/resolved", "the scene with every key and default written out"},
    DatasetName{"/scene/digests", "digests of the files that the scene names"},
    // Limit cycles.
    DatasetName{"/multipliers/number", "number of the multiplier, largest first"},
    DatasetName{"/multipliers/real", "real part of the multiplier of the limit cycle"},
    DatasetName{"/multipliers/imaginary", "imaginary part of the multiplier of the limit cycle"},
    // Loci and maps.
    DatasetName{"/values", "value of the parameter"},
    DatasetName{"/eigenvalues/number", "number of the eigenvalue in the order of frequencies"},
    DatasetName{"/eigenvalues/growth", "growth rate of the eigenvalue"},
    DatasetName{"/eigenvalues/frequency", "frequency of the eigenvalue"},
    DatasetName{"/eigenvalues/damping_ratio", "damping ratio of the eigenvalue"},
    DatasetName{"/eigenvalues/growing", "whether the motion grows, beyond rounding: 1 yes, 0 no"},
    DatasetName{"/eigenvalues/residual", "what is left of the equations of motion, of their terms"},
    DatasetName{"/eigenvalues/doubtful",
                "whether rounding may have made the eigenvalue up: 1 yes, 0 no"},
    DatasetName{"/equilibrium/number", "number of the contact"},
    DatasetName{"/equilibrium/contact", "name of the contact"},
    DatasetName{"/equilibrium/closed", "whether the contact is closed: 1 yes, 0 no"},
    DatasetName{"/equilibrium/force", "contact force in the sliding equilibrium"},
    DatasetName{"/equilibrium/friction_force",
                "friction force in the sliding equilibrium along the first tangent"},
    DatasetName{"/equilibrium/friction_across",
                "friction force in the sliding equilibrium along the second tangent"},
    DatasetName{"/equilibrium/slip_velocity", "slip velocity in the sliding equilibrium"},
    DatasetName{"/equilibrium/position", "position along the master in the sliding equilibrium"},
    DatasetName{"/equilibrium/gap", "gap in the sliding equilibrium"},
    DatasetName{"/frictionless_modes/number", "number of the mode without friction"},
    DatasetName{"/frictionless_modes/frequency", "frequency of the mode without friction"},
    DatasetName{"/frictionless_modes/share", "share that the mode has in the one explained"},
    DatasetName{"/branches/number", "number of the branch: an eigenvalue that was followed"},
    DatasetName{"/branches/point", "number of the point on its branch"},
    DatasetName{"/branches/value", "value of the parameter at the point of the branch"},
    DatasetName{"/branches/growth", "growth rate of the eigenvalue at the point of the branch"},
    DatasetName{"/branches/frequency", "frequency of the eigenvalue at the point of the branch"},
    DatasetName{"/unstable/number", "number of the unstable window"},
    DatasetName{"/unstable/from", "value of the parameter where the unstable window begins"},
    DatasetName{"/unstable/to", "value of the parameter where the unstable window ends"},
    DatasetName{"/unstable/value_max",
                "value of the parameter where the growth in the window is fastest"},
    DatasetName{"/unstable/growth_max", "growth rate of the mode that grows fastest in the window"},
    DatasetName{"/unstable/frequency", "frequency of the mode that grows fastest in the window"},
    DatasetName{"/unstable/growth_integral",
                "integral of the growth rate over the values in the window"},
    DatasetName{"/unstable/from_time", "time at which a run comes into the window"},
    DatasetName{"/unstable/to_time", "time at which a run leaves the window"},
    DatasetName{"/unstable/gain", "integral of the growth rate over the time in the window"},
    DatasetName{"/x", "value of the parameter along x"},
    DatasetName{"/y", "value of the parameter along y"},
    DatasetName{"/growth", "growth rate of the mode that grows fastest"},
    DatasetName{"/failure",
                "number of the reason in /failures why there is no growth rate; 0: there is one"},
    DatasetName{"/failures/number", "number of the reason"},
    DatasetName{"/failures/reason", "why points have no growth rate"},
    DatasetName{"/boundary/number", "number of the line where stability changes"},
    DatasetName{"/boundary/point", "number of the point on its line"},
    DatasetName{"/boundary/x", "value of the parameter along x where stability changes"},
    DatasetName{"/boundary/y", "value of the parameter along y where stability changes"},
    // Sweeps of transients.
    DatasetName{"/value", "value of the parameter"},
    DatasetName{"/failed", "whether the run failed: 1 yes, 0 no"},
    DatasetName{"/reason", "why the run failed; empty where it did not"},
    DatasetName{"/acceleration_peak", "largest acceleration in the window of `measure`"},
    DatasetName{"/acceleration_rms", "r.m.s. value of the acceleration in the window of `measure`"},
    DatasetName{"/force_min", "least contact force in the window of `measure`"},
    DatasetName{"/force_max", "largest contact force in the window of `measure`"},
    DatasetName{"/stick_fraction", "share of the time in the window of `measure` in stick"},
    DatasetName{"/free_fraction", "share of the time in the window of `measure` without contact"},
    DatasetName{"/violations", "number of steps that violate persistent sliding"},
    DatasetName{"/steps", "number of steps of the run"},
    DatasetName{"/num_bursts", "number of bursts in the window of `measure`"},
    // Responses and spectrograms.
    DatasetName{"/frequency", "frequency of the force"},
    DatasetName{"/responses/*/*/real", "real part of {} per force at {}"},
    DatasetName{"/responses/*/*/imaginary", "imaginary part of {} per force at {}"},
    DatasetName{"/responses/*/*/truncation",
                "relative difference of {} per force at {} with the modes that a run keeps and the "
                "residual "
                "flexibility of the others"},
    DatasetName{"/responses/*/*/truncation_error",
                "difference of {} per force at {} with the modes that a run keeps and the residual "
                "flexibility of the others, its size"},
    DatasetName{"/compared/number", "number of the measured response"},
    DatasetName{"/compared/output", "motion that was measured"},
    DatasetName{"/compared/input", "where the force acted"},
    DatasetName{"/compared/source", "file and line of the measured response"},
    DatasetName{"/compared/frac",
                "frequency response assurance criterion of measured and computed"},
    DatasetName{"/compared/ratio", "r.m.s. value of the computed response over the measured one"},
    DatasetName{"/compared/*/frequency", "frequency of the measured response {}"},
    DatasetName{"/compared/*/measured_real", "real part of the measured response {}"},
    DatasetName{"/compared/*/measured_imaginary", "imaginary part of the measured response {}"},
    DatasetName{"/compared/*/computed_real",
                "real part of what was computed beside the measured response {}"},
    DatasetName{"/compared/*/computed_imaginary",
                "imaginary part of what was computed beside the measured response {}"},
    DatasetName{"/shapes/number", "number of the force to which several measured points respond"},
    DatasetName{"/shapes/input", "where the force acted"},
    DatasetName{"/shapes/*/frequency", "frequency of all measured responses to force {}"},
    DatasetName{"/shapes/*/mac",
                "modal assurance criterion of the measured and the computed shape under force {}"},
    DatasetName{"/shapes/*/measured_peak", "peak of the measured responses to force {}"},
    DatasetName{"/shapes/*/computed_peak", "peak of the computed responses to force {}"},
    DatasetName{"/shapes/*/peak_mac", "modal assurance criterion of the shapes at peaks, force {}"},
    DatasetName{"/times", "time at the middle of the piece"},
    DatasetName{"/frequencies", "frequency of the line"},
    DatasetName{"/amplitude", "peak amplitude of a sine of this frequency"},
    // Contacts on rubber.
    DatasetName{"/rows/speed", "dimensionless sliding speed"},
    DatasetName{"/rows/indentation", "dimensionless indentation"},
    DatasetName{"/rows/force", "dimensionless normal force"},
    DatasetName{"/rows/area", "dimensionless area of contact"},
    DatasetName{"/rows/friction", "coefficient of friction of the rubber's losses"},
    DatasetName{"/rows/converged", "whether the solution converged: 1 yes, 0 no"},
    DatasetName{"/rows/touches_window",
                "whether the contact reaches the edge of the grid: 1 yes, 0 no"},
    DatasetName{"/rows/has_resolved_edge",
                "whether the grid resolves the edge of the contact: 1 yes, 0 no"},
    DatasetName{"/rows/memory_in_cells",
                "way slid in the shortest memory of the rubber, in cells of the grid"},
    DatasetName{"/rows/rounds", "number of rounds of the solution"},
    DatasetName{"/rows/products", "number of products with the matrix of influences"},
    DatasetName{"/rows/residual", "residual of the solution"},
    DatasetName{"/contacts/*/x", "place along the sliding, contact {}"},
    DatasetName{"/contacts/*/y", "place across the sliding, contact {}"},
    DatasetName{"/contacts/*/pressure", "contact pressure, contact {}"},
    DatasetName{"/contacts/*/gap", "gap between the surfaces, contact {}"},
    DatasetName{"/contacts/*/edge_point",
                "number of the point on the edge of the area of contact {}"},
    DatasetName{"/contacts/*/edge_x",
                "place along the sliding of the edge of the area of contact {}"},
    DatasetName{"/contacts/*/edge_y",
                "place across the sliding of the edge of the area of contact {}"},
    DatasetName{"/speed", "dimensionless sliding speed"},
    DatasetName{"/indentation", "dimensionless indentation"},
    DatasetName{"/force", "dimensionless normal force"},
    DatasetName{"/area", "dimensionless area of contact"},
    DatasetName{"/friction", "coefficient of friction of the rubber's losses"},
    DatasetName{"/memory_in_cells",
                "way slid in the shortest memory of the rubber, in cells of the grid"},
    DatasetName{"/beta", "sliding speed over the root of the indentation, both dimensionless"},
    DatasetName{"/f", "normal force over the indentation to the power 3/2, both dimensionless"},
    DatasetName{"/g", "area of contact over the indentation, both dimensionless"},
    DatasetName{"/m", "coefficient of friction over the root of the dimensionless indentation"},
    // Comparisons of assumptions, errors against run times.
    DatasetName{"/runs/number", "number of the run"},
    DatasetName{"/runs/assumption", "contact assumption of the run"},
    DatasetName{"/runs/coordinates", "coordinates in which the run was integrated"},
    DatasetName{"/runs/status", "how the run ended"},
    DatasetName{"/runs/wall_time", "time that the run took"},
    DatasetName{"/runs/step_time", "time that a step took"},
    DatasetName{"/runs/ratio", "time of a step over that of FiLM"},
    DatasetName{"/runs/steps", "number of steps of the run"},
    DatasetName{"/runs/acceleration_peak", "largest acceleration in the window of `measure`"},
    DatasetName{"/runs/acceleration_rms",
                "r.m.s. value of the acceleration in the window of `measure`"},
    DatasetName{"/runs/difference",
                "r.m.s. difference of the acceleration from that of FiLM, relative"},
    DatasetName{"/runs/force_min", "least contact force in the window of `measure`"},
    DatasetName{"/runs/force_max", "largest contact force in the window of `measure`"},
    DatasetName{"/runs/stick_fraction", "share of the time in the window of `measure` in stick"},
    DatasetName{"/runs/free_fraction",
                "share of the time in the window of `measure` without contact"},
    DatasetName{"/runs/num_bursts", "number of bursts of the run"},
    DatasetName{"/settings/method", "integrator, modes and assumption of the setting"},
    DatasetName{"/settings/status", "how the run ended"},
    DatasetName{"/settings/step", "time step of the run"},
    DatasetName{"/settings/tolerance", "tolerance of the event-driven integrator"},
    DatasetName{"/settings/modes", "number of modes that move"},
    DatasetName{"/settings/run_time", "time that the steps of the run take"},
    DatasetName{"/settings/error", "relative error in the norm chosen"},
    DatasetName{"/settings/error_of_force", "relative error of the contact force"},
    DatasetName{"/settings/error_of_acceleration", "relative error of the acceleration"},
    DatasetName{"/settings/error_of_envelope",
                "relative error of the envelope of the acceleration"},
    DatasetName{"/settings/on_front",
                "whether no other setting has less time and a smaller error: 1 yes, 0 no"},
    DatasetName{"/reduction/number",
                "number of the comparison of a reduced body with the full one"},
    DatasetName{"/reduction/body", "body that is reduced"},
    DatasetName{"/reduction/frequency",
                "frequency at which the reduced body is compared with the full one"},
    DatasetName{
        "/reduction/error",
        "relative difference of displacements per force of the reduced body and the full one"},
    // Sweeps of limit cycles, in a group for each way; last, since any group fits them.
    DatasetName{"/*/value", "value of the parameter ({})"},
    DatasetName{"/*/period", "period of the limit cycle ({})"},
    DatasetName{"/*/x_rms", "r.m.s. value of the displacement over a period ({})"},
    DatasetName{"/*/x_mean", "mean displacement over a period ({})"},
    DatasetName{"/*/x_min", "least displacement over a period ({})"},
    DatasetName{"/*/x_max", "largest displacement over a period ({})"},
    DatasetName{"/*/stick_fraction", "share of the period in stick ({})"},
    DatasetName{"/*/free_fraction", "share of the period without contact ({})"},
    DatasetName{"/*/status",
                "what was found, by the numbers of the attribute meaning_of_status ({})"},
    DatasetName{"/*/reason", "why no limit cycle was found; empty where one was ({})"},
    DatasetName{"/*/equilibrium_stable",
                "whether the sliding equilibrium is stable: 1 yes, 0 no ({})"},
};

/// The text of a name for a path; empty where it is another one.
std::string text_for(const DatasetName& name, const std::vector<std::string>& parts) {
  const std::vector<std::string> pattern = parts_of(name.path, '/');
  if (pattern.size() != parts.size()) return "";
  std::string text = name.text;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (pattern[i] != "*") {
      if (pattern[i] != parts[i]) return "";
      continue;
    }
    const std::size_t place = text.find("{}");
    if (place != std::string::npos) text.replace(place, 2, parts[i]);
  }
  // A contact that has no name of its own is called `contact`.
  const std::size_t doubled = text.find("contact contact");
  if (doubled != std::string::npos) text.erase(doubled, std::string_view("contact ").size());
  return text;
}

}  // namespace

std::string long_name_of(const std::string& path) {
  const std::vector<std::string> parts = parts_of(path, '/');
  if (parts.empty()) return "";
  if (parts.front() == "channels") return channel_text(parts.back());
  for (const DatasetName& name : dataset_names)
    if (std::string text = text_for(name, parts); !text.empty()) return text;
  std::string text = spaced(parts.back());
  for (std::size_t i = 0; i + 1 < parts.size(); ++i)
    text += (i > 0 ? " " : ", ") + spaced(parts[i]);
  return text;
}

}  // namespace stridor
