#include "substructures/matrix_body.hpp"

namespace stridor {

const Schema& MatrixFactors::schema() {
  using P = MatrixFactors;
  const auto factor = [](const char* doc) { return RealKey{.doc = doc, .optional = true}; };
  static const Schema keys = SchemaOf<P>("matrix_factors")
                                 .real("damping", &P::damping, factor("Factor of `damping`."))
                                 .real("gyroscopic", &P::gyroscopic,
                                       factor("Factor of `gyroscopic`: a speed, if that is of a "
                                              "unit speed."))
                                 .real("stiffness", &P::stiffness, factor("Factor of `stiffness`."))
                                 .real("circulatory", &P::circulatory,
                                       factor("Factor of `circulatory`: friction, for instance."));
  return keys;
}

const Schema& MatrixBodyParameters::schema() {
  using P = MatrixBodyParameters;
  const auto matrix = [](const char* doc, bool is_optional) {
    return PlainKey{
        .doc = std::string(doc) +
               " A Matrix Market file, from the folder of the scene, or a list of rows, "
               "each a list or a text of numbers.",
        .optional = is_optional};
  };
  static const Schema keys =
      SchemaOf<P>("matrices")
          .text_rows("mass", &P::mass, matrix("Mass matrix, symmetric positive definite.", false))
          .text_rows("damping", &P::damping, matrix("Damping matrix.", true))
          .text_rows("gyroscopic", &P::gyroscopic,
                     matrix("Gyroscopic matrix, skew-symmetric.", true))
          .text_rows("stiffness", &P::stiffness, matrix("Stiffness matrix.", false))
          .text_rows("circulatory", &P::circulatory,
                     matrix("Circulatory matrix, skew-symmetric.", true))
          .section("factors", &P::factors,
                   {.doc = "Factors of these matrices, each a key that can be varied.",
                    .optional = true})
          .real("load", &P::load, {.doc = "Factor of the matrices below.", .optional = true})
          .text_rows("load_damping", &P::load_damping,
                     matrix("What one unit of load adds to the velocity matrix.", true))
          .text_rows("load_stiffness", &P::load_stiffness,
                     matrix("What one unit of load adds to the position matrix.", true));
  return keys;
}

}  // namespace stridor
