// Check that an input is a regular file.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

namespace stridor {

/// Kind of the file under a path that is no regular file: "a folder", "a FIFO (named pipe)", "a
/// device", "a socket"; "" for a regular file, and where there is nothing.
std::string irregular_kind(const std::string& path);

/// Refuses an irregular file before it is opened: a FIFO would block until somebody writes
/// into it, a device may never end.
/// @throws FileError "is a FIFO (named pipe), expected a regular file"
void refuse_irregular_file(const std::string& path);

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// An open file, closed at its end.
using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace stridor
