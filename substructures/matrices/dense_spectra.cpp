#define STRIDOR_TEMPLATE
#include "substructures/matrices/dense_spectra.hpp"
