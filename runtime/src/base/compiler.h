// This file names what compilers say in their own words. Elsewhere, and with SUNBEAM_PORTABLE, the words
// vanish.
#pragma once

namespace sunbeam {
inline namespace v1 {

#if defined(__GNUC__) && !defined(SUNBEAM_PORTABLE)
#define SUNBEAM_ALWAYS_INLINE [[gnu::always_inline]] inline
#define SUNBEAM_NOINLINE [[gnu::noinline]]
#define SUNBEAM_UNROLL_4 _Pragma("GCC unroll 4")
inline void prefetch(const void* address) { __builtin_prefetch(address); }
#else
#define SUNBEAM_ALWAYS_INLINE inline
#define SUNBEAM_NOINLINE
#define SUNBEAM_UNROLL_4
inline void prefetch(const void*) {}
#endif

}  // namespace v1
}  // namespace sunbeam
