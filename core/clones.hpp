// Loops for whatever vectors the processor has.
#pragma once

#if defined(__SANITIZE_THREAD__)  // by g++
#define STRIDOR_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define STRIDOR_THREAD_SANITIZER
#endif
#endif

/// Put before a function: it is compiled for several instruction sets, of which the processor's
/// best is chosen at start-up, where the tool chain can do that. Results differ between processors
/// by rounding only. Not under the thread sanitizer, which is not yet there when the choice is
/// made. Only before functions without linkage that no line declares before: of others, clang 14
/// makes the first set alone, whatever the processor.
#if defined(__x86_64__) && defined(__ELF__) && defined(__GLIBC__) && defined(__GNUC__) && \
    !defined(STRIDOR_THREAD_SANITIZER)
#define STRIDOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define STRIDOR_CLONES
#endif
