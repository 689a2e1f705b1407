#include "io/results/response_file.hpp"

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

}  // namespace

void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes,
                         const std::vector<ComparedResponse>& compared) {
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
    if (curves.empty()) return;
    writer.make_default_plot("/responses/" + curves[0].output + "/" + curves[0].input + "/real",
                             {"/frequency"});
  });
}

}  // namespace stridor
