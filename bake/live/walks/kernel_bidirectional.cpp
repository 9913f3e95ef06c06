#include "bake/live/walks/bidirectional.h"
#include "bake/live/walks/kernels.h"

namespace sunbeam::walk {

template <class Arch, bool kLayered>
SUNBEAM_FLATTEN void bidirectional(const Layers& layers, double wi, double wo, Rng& rng, double* sums) {
  BidirectionalWalk<Packet<Arch>, kLayered>(layers).add(wi, wo, rng, sums);
}
template void bidirectional<SUNBEAM_ARCH, false>(const Layers&, double, double, Rng&, double*);
template void bidirectional<SUNBEAM_ARCH, true>(const Layers&, double, double, Rng&, double*);

}  // namespace sunbeam::walk
