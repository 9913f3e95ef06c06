#include "bake/live/make_kernels.h"

namespace sunbeam::walk {

const Kernels kAvx2Kernels{"avx2",
                           unidirectional<xsimd::avx2>,
                           bidirectional<xsimd::avx2>,
                           multiple_facets<xsimd::avx2>,
                           returns<xsimd::avx2>,
                           reflectances<xsimd::avx2>,
                           attenuate<xsimd::avx2>};

}  // namespace sunbeam::walk
