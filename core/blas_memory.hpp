// The work space of BLAS, requested early enough to report that there is none.
#pragma once

#include <new>
#include <string>

namespace stridor {

/// There is too little memory for BLAS.
class BlasMemoryError : public std::bad_alloc {
 public:
  explicit BlasMemoryError(std::string text) : text_(std::move(text)) {}
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

/// Lets BLAS take its work space, which it then keeps. OpenBLAS takes it with its first call and,
/// where the system refuses, asks again for ever; so the room is looked for before. Call it before
/// any other thread is there. @throws BlasMemoryError where there is too little
void reserve_blas_memory();

}  // namespace stridor
