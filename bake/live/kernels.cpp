#include "bake/live/kernels.h"

namespace sunbeam::walk {

const Kernels& best_kernels() {
#ifdef SUNBEAM_AVX2_KERNELS
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  if (has_avx2) return kAvx2Kernels;
#endif
  return kBaselineKernels;
}

}  // namespace sunbeam::walk
