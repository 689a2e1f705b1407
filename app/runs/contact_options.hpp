// Options of the verb contact.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/terminal/command.hpp"

namespace stridor {

struct ContactOptions {
  CommonOptions common;
  std::string scene;
  std::optional<std::string> contact;  ///< name of one of the contacts of the scene
  std::vector<double> speeds;
  std::vector<double> indentations;
  std::vector<double> loads;
  std::optional<std::string> output;
  std::optional<std::string> pressure_figure;
  std::optional<std::string> edges_figure;
  std::optional<std::string> master_curve;
  std::optional<std::string> table;
  std::vector<double> table_speeds{1e-3, 1e3, 49};        ///< first, last, number
  std::vector<double> table_indentations{1e-4, 0.3, 15};  ///< likewise
  bool verify = false;
  std::string command_line;
};

}  // namespace stridor
