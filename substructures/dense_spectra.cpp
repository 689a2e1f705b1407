#define STRIDOR_TEMPLATE
#include "substructures/dense_spectra.hpp"
