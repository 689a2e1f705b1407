// What another method may find.
#pragma once

#include "core/errors.hpp"

namespace stridor {

/// A search for eigenvalues that ended without all of them.
class SearchFailure : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

}  // namespace stridor
