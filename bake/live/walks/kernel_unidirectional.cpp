#include "bake/live/walks/kernels.h"
#include "bake/live/walks/unidirectional.h"

namespace sunbeam::walk {

template <class Arch, bool kLayered>
SUNBEAM_FLATTEN void unidirectional(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                                    double* sums) {
  UnidirectionalWalk<Packet<Arch>, kLayered>(layers).add(wi, wo, exits, rng, sums);
}
template void unidirectional<SUNBEAM_ARCH, false>(const Layers&, double, const double*, int, Rng&, double*);
template void unidirectional<SUNBEAM_ARCH, true>(const Layers&, double, const double*, int, Rng&, double*);

}  // namespace sunbeam::walk
