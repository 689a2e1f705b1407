#include "io/results/response_file.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {

std::string response_quantity(const std::string& units) {
  if (units == "m/N") return "receptance";
  if (units == "m/s/N") return "mobility";
  if (units == "m/s^2/N") return "accelerance";
  return "response";
}

std::vector<PeakPair> peak_pairs(const ComparedShapes& shapes) {
  constexpr double as_alike = 0.05;
  std::vector<PeakPair> pairs;
  if (shapes.computed_peaks.empty()) return pairs;
  for (std::size_t m = 0; m < shapes.measured_peaks.size(); ++m) {
    const auto criteria = shapes.peak_assurance.col(static_cast<Eigen::Index>(m));
    const double best = criteria.maxCoeff();
    const auto distance = [&](std::size_t c) {
      return std::abs(shapes.computed_peaks[c] - shapes.measured_peaks[m]);
    };
    std::optional<std::size_t> taken;
    for (std::size_t c = 0; c < shapes.computed_peaks.size(); ++c) {
      if (criteria[static_cast<Eigen::Index>(c)] < best - as_alike) continue;
      if (!taken || distance(c) < distance(*taken)) taken = c;
    }
    pairs.push_back({m, *taken, criteria[static_cast<Eigen::Index>(*taken)]});
  }
  return pairs;
}

namespace {

std::vector<double> part_of(const std::vector<std::complex<double>>& values, bool is_real) {
  std::vector<double> part;
  part.reserve(values.size());
  for (const std::complex<double>& value : values)
    part.push_back(is_real ? value.real() : value.imag());
  return part;
}

/// Writes "<beginning>real" and "<beginning>imaginary".
void write_parts(const Hdf5Writer& writer, const std::string& beginning, const ResponseCurve& curve,
                 const Handle& frequency) {
  for (const bool is_real : {true, false}) {
    const std::string dataset = beginning + (is_real ? "real" : "imaginary");
    const Handle written = writer.write(dataset, part_of(curve.values, is_real), curve.units);
    writer.tie(written, dataset, frequency, 0);
  }
}

void write_compared(const Hdf5Writer& writer, const std::vector<ComparedResponse>& compared) {
  const Handle number = writer.write_numbers("/compared/number", compared.size());
  writer.make_scale(number, "/compared/number");
  std::vector<std::string> outputs, inputs, sources;
  std::vector<double> assurances, ratios;
  for (const ComparedResponse& one : compared) {
    outputs.push_back(one.computed.output);
    inputs.push_back(one.computed.input);
    sources.push_back(one.source);
    assurances.push_back(one.assurance);
    ratios.push_back(one.ratio);
  }
  for (const auto& [name, texts] : {std::pair("output", &outputs), std::pair("input", &inputs),
                                    std::pair("source", &sources)}) {
    const std::string path = std::string("/compared/") + name;
    writer.tie(writer.write_texts(path, *texts), path, number, 0);
  }
  for (const auto& [name, values] : {std::pair("frac", &assurances), std::pair("ratio", &ratios)}) {
    const std::string path = std::string("/compared/") + name;
    writer.tie(writer.write(path, *values, "1"), path, number, 0);
  }
  for (std::size_t i = 0; i < compared.size(); ++i) {
    const std::string group = "/compared/" + std::to_string(i + 1);
    const Handle frequency = writer.write(group + "/frequency", compared[i].frequencies, "Hz");
    writer.make_scale(frequency, group + "/frequency");
    write_parts(writer, group + "/measured_", compared[i].measured, frequency);
    write_parts(writer, group + "/computed_", compared[i].computed, frequency);
  }
}

void write_shapes(const Hdf5Writer& writer, const std::vector<ComparedShapes>& shapes) {
  const Handle number = writer.write_numbers("/shapes/number", shapes.size());
  writer.make_scale(number, "/shapes/number");
  std::vector<std::string> inputs;
  for (const ComparedShapes& one : shapes) inputs.push_back(one.input);
  writer.tie(writer.write_texts("/shapes/input", inputs), "/shapes/input", number, 0);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ComparedShapes& one = shapes[i];
    const std::string group = "/shapes/" + std::to_string(i + 1) + "/";
    const auto scale = [&](const char* name, const std::vector<double>& values) {
      Handle written = writer.write(group + name, values, "Hz");
      writer.make_scale(written, group + name);
      return written;
    };
    const Handle frequency = scale("frequency", one.frequencies);
    writer.tie(writer.write(group + "mac", one.assurance, "1"), group + "mac", frequency, 0);
    const bool has_measured = !one.measured_peaks.empty(),
               has_computed = !one.computed_peaks.empty();
    const Handle measured = has_measured ? scale("measured_peak", one.measured_peaks) : Handle();
    const Handle computed = has_computed ? scale("computed_peak", one.computed_peaks) : Handle();
    if (!has_measured || !has_computed) continue;
    const std::string path = group + "peak_mac";
    const Eigen::MatrixXd rows = one.peak_assurance.transpose();  // the file has them row by row
    const Handle table = writer.write(path, {one.computed_peaks.size(), one.measured_peaks.size()},
                                      rows.data(), "1");
    writer.tie(table, path, computed, 0);
    writer.tie(table, path, measured, 1);
  }
}

}  // namespace

void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes,
                         const std::vector<ComparedResponse>& compared,
                         const std::vector<ComparedShapes>& shapes) {
  Attributes all{{"kind", std::string("frequency responses")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    const Handle frequency = writer.write("/frequency", frequencies, "Hz");
    writer.make_scale(frequency, "/frequency");
    for (const ResponseCurve& curve : curves) {
      const std::string group = "/responses/" + curve.output + "/" + curve.input + "/";
      write_parts(writer, group, curve, frequency);
      if (!curve.truncation) continue;
      writer.write(group + "truncation", {}, &*curve.truncation, "1");
      writer.tie(writer.write(group + "truncation_error", curve.truncation_error, curve.units),
                 group + "truncation_error", frequency, 0);
    }
    if (!compared.empty()) write_compared(writer, compared);
    if (!shapes.empty()) write_shapes(writer, shapes);
    if (curves.empty()) return;
    writer.make_default_plot("/responses/" + curves[0].output + "/" + curves[0].input + "/real",
                             {"/frequency"});
  });
}

}  // namespace stridor
