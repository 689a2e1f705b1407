#include "io/results/response_file.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <set>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {

void write_response_file(const std::string& path, Overwrite overwrite,
                         const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves, const Attributes& attributes) {
  Attributes all{{"kind", std::string("frequency responses")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    const Checker& at = writer.checker();
    const Handle frequency = writer.write("/frequency", frequencies, "Hz");
    at.check(H5DSset_scale(frequency.id(), "frequency"), "/frequency",
             "cannot be made a dimension scale");
    writer.make_group("/responses");
    std::set<std::string> groups;
    for (const ResponseCurve& curve : curves) {
      const std::string of_output = "/responses/" + curve.output;
      if (groups.insert(of_output).second) writer.make_group(of_output);
      const std::string group = of_output + "/" + curve.input;
      writer.make_group(group);
      for (const bool is_real : {true, false}) {
        std::vector<double> part;
        for (const std::complex<double>& value : curve.values)
          part.push_back(is_real ? value.real() : value.imag());
        const std::string dataset = group + (is_real ? "/real" : "/imaginary");
        const Handle written = writer.write(dataset, part, curve.units);
        at.check(H5DSattach_scale(written.id(), frequency.id(), 0), dataset,
                 "cannot be tied to /frequency");
      }
    }
  });
}

}  // namespace stridor
