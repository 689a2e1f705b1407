#define STRIDOR_TEMPLATE
#include "substructures/matrices/dense_factors.hpp"
