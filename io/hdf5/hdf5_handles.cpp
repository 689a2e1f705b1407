#include "io/hdf5/hdf5_handles.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>

#include "core/errors.hpp"

namespace stridor {
namespace {

herr_t keep_description(unsigned, const H5E_error2_t* error, void* text) {
  // Upwards: the first one is the innermost and the most telling.
  auto& description = *static_cast<std::string*>(text);
  if (description.empty() && error->desc != nullptr) description = error->desc;
  return 0;
}

}  // namespace

QuietErrors::QuietErrors() {
  // Before anything else of HDF5: a file whose closing failed stays in its books, and its
  // clean-up at exit crashes over it. All handles are closed by their owners, there is nothing for
  // it to clean up.
  H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietErrors::~QuietErrors() {
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

std::string hdf5_cause() {
  std::string description;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_description, &description);
  const std::string marker = "error message = '";
  const auto begin = description.find(marker);
  if (begin != std::string::npos) {
    const auto text = begin + marker.size();
    return description.substr(text, description.find('\'', text) - text);
  }
  return description.empty() ? "HDF5 gives no reason" : "HDF5: " + description;
}

std::string errno_text(int number) {
  return std::strerror(number);
}

void Checker::fail(const std::string& dataset, const std::string& what) const {
  throw FileError(refusal_, path_, dataset, fmt::format("{}: {}", what, hdf5_cause()));
}

void Checker::check(herr_t status, const std::string& dataset, const char* what) const {
  if (status < 0) fail(dataset, what);
}

Handle Checker::own(hid_t id, Handle::Close close, const std::string& dataset,
                    const char* what) const {
  if (id < 0) fail(dataset, what);
  return {id, close};
}

Handle file_access(const Checker& at) {
  // Locks fail on many network file systems and would keep readers out while a run goes on.
#if H5_VERSION_GE(1, 10, 7)
  Handle access = at.own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "", "cannot set up HDF5");
  at.check(H5Pset_file_locking(access.id(), false, true), "", "cannot switch file locking off");
#else
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  Handle access = at.own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "", "cannot set up HDF5");
#endif
  at.check(H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG), "", "cannot set up HDF5");
  return access;
}

bool is_object_path(const std::string& path) {
  return path.size() >= 2 && path.front() == '/' && path.back() != '/' &&
         path.find("//") == std::string::npos && path.find("/./") == std::string::npos &&
         path.find('\0') == std::string::npos && !path.ends_with("/.");
}

}  // namespace stridor
