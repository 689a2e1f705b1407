// Lets the thread sanitizer see who calls BLAS. It does not look into libraries that are not built
// with it, and an OpenBLAS without threads of its own hands one work space to all callers
// (core/blas.hpp). Linked into the program, the functions here come before those of the library,
// for CHOLMOD and UMFPACK too, and write to a plain variable where that is the BLAS at hand: two
// calls that no lock keeps apart are a race. Operations on vectors alone use no work space and are
// not here.
#include <dlfcn.h>

#include "core/blas.hpp"

namespace {

int num_calls = 0;

}  // namespace

using P = const void*;  // Fortran's arguments are pointers, all of them
#define STRIDOR_P5 P a, P b, P c, P d, P e
#define STRIDOR_P8 STRIDOR_P5, P f, P g, P h
#define STRIDOR_P9 STRIDOR_P8, P i
#define STRIDOR_P10 STRIDOR_P9, P j
#define STRIDOR_P11 STRIDOR_P10, P k
#define STRIDOR_P13 STRIDOR_P11, P l, P m
#define STRIDOR_P23 STRIDOR_P13, P n, P o, P p, P q, P r, P s, P t, P u, P v, P w
#define STRIDOR_A5 a, b, c, d, e
#define STRIDOR_A8 STRIDOR_A5, f, g, h
#define STRIDOR_A9 STRIDOR_A8, i
#define STRIDOR_A10 STRIDOR_A9, j
#define STRIDOR_A11 STRIDOR_A10, k
#define STRIDOR_A13 STRIDOR_A11, l, m
#define STRIDOR_A23 STRIDOR_A13, n, o, p, q, r, s, t, u, v, w

/// A function of so many arguments that counts and goes on to the library's of the same name.
#define STRIDOR_WATCH(name, count)                                                       \
  extern "C" void name(STRIDOR_P##count) {                                               \
    if (!stridor::is_blas_reentrant()) ++num_calls;                                      \
    static const auto next = reinterpret_cast<decltype(&name)>(dlsym(RTLD_NEXT, #name)); \
    next(STRIDOR_A##count);                                                              \
  }

STRIDOR_WATCH(dgemv_, 11)
STRIDOR_WATCH(dger_, 9)
STRIDOR_WATCH(dsymv_, 10)
STRIDOR_WATCH(dtrmv_, 8)
STRIDOR_WATCH(dtrsv_, 8)
STRIDOR_WATCH(dgemm_, 13)
STRIDOR_WATCH(dsyrk_, 10)
STRIDOR_WATCH(dtrmm_, 11)
STRIDOR_WATCH(dtrsm_, 11)
STRIDOR_WATCH(dpotrf_, 5)
STRIDOR_WATCH(dgeevx_, 23)
STRIDOR_WATCH(zgemv_, 11)
STRIDOR_WATCH(zgeru_, 9)
STRIDOR_WATCH(ztrmv_, 8)
STRIDOR_WATCH(ztrsv_, 8)
STRIDOR_WATCH(zgemm_, 13)
STRIDOR_WATCH(ztrmm_, 11)
STRIDOR_WATCH(ztrsm_, 11)
