#define STRIDOR_TEMPLATE
#include "substructures/dense_factors.hpp"
