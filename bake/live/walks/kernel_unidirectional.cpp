#include "bake/live/walks/kernels.h"
#include "bake/live/walks/unidirectional.h"

namespace sunbeam::walk {

template <class Arch>
SUNBEAM_FLATTEN void unidirectional(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                                    double* sums) {
  UnidirectionalWalk<Packet<Arch>>(layers).add(wi, wo, exits, rng, sums);
}
template void unidirectional<SUNBEAM_ARCH>(const Layers&, double, const double*, int, Rng&, double*);

}  // namespace sunbeam::walk
