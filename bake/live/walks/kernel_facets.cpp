#include "bake/live/walks/facets_walk.h"
#include "bake/live/walks/kernels.h"

namespace sunbeam::walk {

template <class Arch, bool kLayered>
SUNBEAM_FLATTEN void multiple_facets(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                                     double* sums) {
  FacetsWalk<Packet<Arch>, kLayered>(layers).add(wi, wo, exits, rng, sums);
}
template void multiple_facets<SUNBEAM_ARCH, false>(const Layers&, double, const double*, int, Rng&, double*);
template void multiple_facets<SUNBEAM_ARCH, true>(const Layers&, double, const double*, int, Rng&, double*);

template <class Arch, bool kLayered>
SUNBEAM_FLATTEN void returns(const Layers& layers, Rng& rng, double* sums) {
  FacetsWalk<Packet<Arch>, kLayered>(layers).add_returns(rng, sums);
}
template void returns<SUNBEAM_ARCH, false>(const Layers&, Rng&, double*);
template void returns<SUNBEAM_ARCH, true>(const Layers&, Rng&, double*);

}  // namespace sunbeam::walk
