// This file holds what kernels ask of the compiler. Only GCC makes clones; other compilers than GCC and Clang
// inline as they see fit.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define SUNBEAM_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SUNBEAM_ADDRESS_SANITIZER 1
#endif
#endif

// SUNBEAM_INLINE stands before the parts of a kernel and SUNBEAM_FLATTEN before the kernel itself: all is
// inlined, so that no copy of a part compiled for one instruction set can stand in for another's. Sanitizers
// would spend minutes on such functions.
//
// SUNBEAM_VECTOR_CLONES before a function makes, besides the baseline, a copy with AVX2 instructions, chosen
// at load time. It gives the same bits, since neither reorders nor fuses operations.
// SUNBEAM_FLAT_VECTOR_CLONES also inlines what the function calls, so that its parts are copied with it.
// Clang loses the inline functions that only such copies call (seen with 22), so it makes none.
#if defined(SUNBEAM_ADDRESS_SANITIZER) || !defined(__GNUC__)
#define SUNBEAM_INLINE inline
#define SUNBEAM_FLATTEN
#else
#define SUNBEAM_INLINE __attribute__((always_inline)) inline
#define SUNBEAM_FLATTEN __attribute__((flatten))
#endif

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(SUNBEAM_PORTABLE) && \
    !defined(SUNBEAM_ADDRESS_SANITIZER)
#define SUNBEAM_VECTOR_CLONES __attribute__((target_clones("default", "avx2")))
#define SUNBEAM_FLAT_VECTOR_CLONES SUNBEAM_VECTOR_CLONES SUNBEAM_FLATTEN
#else
#define SUNBEAM_VECTOR_CLONES
#define SUNBEAM_FLAT_VECTOR_CLONES
#endif
