#include "app/results/output_folder.hpp"

#include "core/errors.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {

namespace fs = std::filesystem;

void prepare_folder(const fs::path& folder, const std::vector<std::string>& names,
                    Overwrite overwrite) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw FileError(Refusal::cannot_write, folder.string(), "",
                    "cannot be made: " + error.message());
  for (const std::string& name : names) check_replaceable((folder / name).string(), overwrite);
}

void write_json(const fs::path& path, const Json& object) {
  write_text_file(path.string(), object.dump(2) + "\n");
}

}  // namespace stridor
