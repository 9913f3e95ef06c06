#include "bake/live/make_kernels.h"

namespace sunbeam::walk {

#ifdef SUNBEAM_AVX2_KERNELS
using Baseline = xsimd::sse2;
#else
using Baseline = xsimd::default_arch;
#endif

const Kernels kBaselineKernels{
    "baseline",        unidirectional<Baseline>, bidirectional<Baseline>, multiple_facets<Baseline>,
    returns<Baseline>, reflectances<Baseline>,   attenuate<Baseline>};

}  // namespace sunbeam::walk
