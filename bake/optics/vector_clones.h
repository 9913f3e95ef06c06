// SUNBEAM_VECTOR_CLONES before a function: besides the baseline a copy with AVX2 instructions, chosen at load
// time. It gives the same bits, since neither reorders nor fuses operations.
#pragma once

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define SUNBEAM_VECTOR_CLONES __attribute__((target_clones("default", "avx2")))
#else
#define SUNBEAM_VECTOR_CLONES
#endif
