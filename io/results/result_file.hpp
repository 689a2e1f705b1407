// Any file of results, read by what stands in it.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace stridor {

/// An array of numbers in a file of results.
struct ResultArray {
  std::string path;                ///< "/eigenvalues/growth"
  std::vector<std::size_t> shape;  ///< the last extent is contiguous
  std::string units;               ///< empty where the file gives none
};

/// Reads files of all verbs (docs/files.md).
class ResultFile {
 public:
  using Values = std::map<std::string, std::variant<std::string, double>>;

  /// @throws FileError if the file is missing, unreadable, not HDF5, damaged or truncated
  explicit ResultFile(const std::string& path);
  ~ResultFile();
  ResultFile(ResultFile&&) noexcept;
  ResultFile& operator=(ResultFile&&) noexcept;

  const std::string& path() const;
  /// What the file holds: attribute `kind`; "run" of run files; empty where it does not say.
  std::string kind() const;
  /// Attributes of the root that are a text or one number.
  const Values& attributes() const;
  /// One of them that is a text; empty where there is none.
  std::string text(const std::string& name) const;
  /// One of them that is a number; nothing where there is none.
  std::optional<double> told(const std::string& name) const;

  /// All arrays of numbers, by path.
  const std::vector<ResultArray>& arrays() const;
  /// All texts, alone or in arrays, with "text" as their units, and numbers alone (no extents).
  const std::vector<ResultArray>& texts_and_numbers() const;
  bool has(const std::string& path) const;
  /// @throws FileError if there is no such array
  const ResultArray& array(const std::string& path) const;
  /// The numbers of an array.
  /// @param rank how many extents are expected
  /// @throws FileError naming the dataset if it is missing, of another rank, or cannot be read
  std::vector<double> read(const std::string& path, std::size_t rank = 1) const;
  /// A number that stands alone; nothing where there is no such dataset.
  /// @throws FileError naming the dataset if it is an array, no number, or cannot be read
  std::optional<double> number(const std::string& path) const;
  /// The texts of a dataset, in order; none where there is no such dataset.
  /// @throws FileError if it holds anything else, or cannot be read
  std::vector<std::string> texts(const std::string& path) const;
  /// Names of the groups and arrays in a group, in alphabetical order; none where it is missing.
  std::vector<std::string> names_in(const std::string& group) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stridor
