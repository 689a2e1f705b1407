#include "io/imports/matrix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "io/imports/coordinate_matrix.hpp"
#include "io/imports/harwell_boeing.hpp"
#include "io/imports/matrix_market.hpp"
#include "io/imports/nastran_punch.hpp"
#include "io/imports/text_words.hpp"

namespace stridor {
namespace {

constexpr const char* matrix_formats =
    "a matrix: Matrix Market, CalculiX (.sti, .mas), Abaqus (*MATRIX OUTPUT), Harwell-Boeing or "
    "DMIG of Nastran";

LabelledMatrix read_market(SourceText source) {
  const std::string head = lower_case_of(source.text.substr(0, source.text.find('\n')));
  LabelledMatrix read;
  const bool is_symmetric = head.find(" symmetric") != std::string::npos;
  read.stored = is_symmetric ? StoredPart::lower : StoredPart::full;
  std::istringstream text(std::move(source.text));
  read.matrix = read_matrix_market(text, source.name);
  return read;
}

}  // namespace

LabelledMatrix read_matrix_text(SourceText source, MatrixPurpose purpose) {
  const std::string foreign = foreign_format(source.text);
  if (!foreign.empty())
    refuse_at({&source, 0}, fmt::format("this is {}; expected {}", foreign, matrix_formats));
  const std::size_t strange = source.text.find('\0');
  if (strange != std::string::npos)
    refuse_at({&source, strange}, fmt::format("a byte 0; expected {}", matrix_formats));
  if (source.text.front() == '%') return read_market(std::move(source));
  if (is_harwell_boeing(source.text)) return read_harwell_boeing(source);
  if (is_nastran_bulk(source.text)) return read_nastran_punch(source, purpose);

  TextLines lines(source);
  if (!lines.next()) lines.fail(fmt::format("the file is blank, expected {}", matrix_formats));
  const auto& words = lines.words();
  const bool is_number = integer_in(words.front()).has_value();
  const auto num_commas = std::count(lines.line().begin(), lines.line().end(), ',');
  if (lines.line().front() == '*' || (is_number && num_commas == 4))
    return read_abaqus_matrix(source);
  if (is_number && words.size() == 3) return read_coordinate_matrix(source);
  lines.fail(fmt::format("the file begins with '{}'; expected {}", shown(lines.line()),
                         matrix_formats));
}

LabelledMatrix read_matrix_file(const std::string& path, MatrixPurpose purpose) {
  return read_matrix_text(read_source_text(path, matrix_formats), purpose);
}

}  // namespace stridor
