// Functions of a universal file: dataset 58, measured or computed.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/imports/source_text.hpp"
#include "io/imports/uff_lines.hpp"

namespace stridor {

/// A node and a direction: ±1, ±2, ±3 for x, y, z, ±4 to ±6 for rotations, 0 for none.
struct UffDof {
  std::int64_t node = 0;
  int direction = 0;
  bool operator==(const UffDof&) const = default;
};

/// What a function is of, by the numbers of record 6.
enum class UffFunctionType {
  general = 0,
  time_response = 1,
  frequency_response = 4,
  spectrum = 12
};
/// What its numbers are, by the numbers of records 8 to 10.
enum class UffQuantity {
  general = 0,
  displacement = 8,
  reaction_force = 9,
  velocity = 11,
  acceleration = 12,
  excitation_force = 13,
  time = 17,
  frequency = 18
};

/// A function of a universal file in SI units.
struct UffFunction {
  int type = 0;  ///< UffFunctionType, or another one of the format
  std::string id;    ///< first line of text
  std::string note;  ///< fourth one; empty where it says NONE
  UffDof response, reference;
  int abscissa_quantity = 0;  ///< UffQuantity, or another one, as the next two
  int ordinate_quantity = 0;
  int denominator_quantity = 0;
  std::string units;  ///< of the values, by their name in the file, which may have none
  bool is_complex = false;
  std::vector<double> abscissa;
  std::vector<std::complex<double>> values;  ///< as many
  std::size_t num_missing = 0;  ///< values that the file announces and lacks at the end
  std::string source;                        ///< "file:line", for messages
};

/// Functions of a universal file and what is to be known of them.
struct UffFunctions {
  std::vector<UffFunction> functions;
  std::vector<std::string> remarks;
};

/// Reads datasets 58, in text or binary (58b, IEEE 754): real or complex, single or double, at even
/// or uneven abscissas. Units are those of dataset 164; SI where there is none.
///
/// Tolerated, besides what read_uff() does: an unfinished or padded last line, numbers without
/// blanks between them in their columns, abscissas of 4 or 8 bytes beside numbers of 8, a wrong
/// number of bytes in the head of binary data, and values that are missing at the end, of which a
/// remark tells.
/// @throws ConfigError with the place in the file and what was expected; if there is no function
UffFunctions read_uff_functions(const SourceText& source);

/// The functions of the datasets of a file, with remarks; may be none.
/// @throws ConfigError with the place in the file and what was expected
UffFunctions functions_in(const std::vector<UffDataset>& datasets);

/// @throws ConfigError as read_uff_functions(); FileError
UffFunctions read_uff_functions_file(const std::string& path);

}  // namespace stridor
