// Treats denormal floats as zero on this thread while alive: Embree asks for it, or rays near a vertex slow
// down.
#pragma once

#if defined(__SSE__)
#include <immintrin.h>
#endif

namespace sunbeam {

class FlushDenormals {
#if defined(__SSE__)
 public:
  FlushDenormals() : previous_(_mm_getcsr()) { _mm_setcsr(previous_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormals() { _mm_setcsr(previous_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned previous_;
#endif
};

}  // namespace sunbeam
