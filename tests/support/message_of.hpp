// Message of a call that throws.
#pragma once

#include <exception>
#include <string>
#include <utility>

namespace stridor::test {

/// Message of the Exception that `call` throws; says so where it throws none or another one.
template <class Exception, class Call>
std::string message_of(Call&& call) {
  try {
    std::forward<Call>(call)();
  } catch (const Exception& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("<another exception: ") + error.what() + ">";
  }
  return "<no exception>";
}

}  // namespace stridor::test
