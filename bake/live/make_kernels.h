// Included by one source file for each instruction set.
#pragma once

#include "bake/live/bidirectional.h"
#include "bake/live/kernels.h"
#include "bake/live/walk.h"

namespace sunbeam::walk {

template <class Arch>
SUNBEAM_FLATTEN void unidirectional(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                                    double* sums) {
  UnidirectionalWalk<Packet<Arch>>(layers).add(wi, wo, exits, rng, sums);
}

template <class Arch>
SUNBEAM_FLATTEN void bidirectional(const Layers& layers, double wi, double wo, Rng& rng, double* sums) {
  BidirectionalWalk<Packet<Arch>>(layers).add(wi, wo, rng, sums);
}

}  // namespace sunbeam::walk
