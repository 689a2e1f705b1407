#include "io/results/response_file.hpp"

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {

std::string response_quantity(const std::string& units) {
  if (units == "m/N") return "receptance";
  if (units == "m/s/N") return "mobility";
  if (units == "m/s^2/N") return "accelerance";
  return "response";
}

void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes) {
  Attributes all{{"kind", std::string("frequency responses")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    const Handle frequency = writer.write("/frequency", frequencies, "Hz");
    writer.make_scale(frequency, "/frequency");
    for (const ResponseCurve& curve : curves) {
      const std::string group = "/responses/" + curve.output + "/" + curve.input;
      for (const bool is_real : {true, false}) {
        std::vector<double> part;
        for (const std::complex<double>& value : curve.values)
          part.push_back(is_real ? value.real() : value.imag());
        const std::string dataset = group + (is_real ? "/real" : "/imaginary");
        const Handle written = writer.write(dataset, part, curve.units);
        writer.tie(written, dataset, frequency, 0);
      }
      if (curve.truncation) writer.write(group + "/truncation", {}, &*curve.truncation, "1");
    }
    if (curves.empty()) return;
    writer.make_default_plot("/responses/" + curves[0].output + "/" + curves[0].input + "/real",
                             {"/frequency"});
  });
}

}  // namespace stridor
