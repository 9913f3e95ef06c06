// Included by one source file for each instruction set.
#pragma once

#include "bake/live/bidirectional.h"
#include "bake/live/facets_walk.h"
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

template <class Arch>
SUNBEAM_FLATTEN void multiple_facets(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                                     double* sums) {
  FacetsWalk<Packet<Arch>>(layers).add(wi, wo, exits, rng, sums);
}

template <class Arch>
SUNBEAM_FLATTEN void returns(const Layers& layers, Rng& rng, double* sums) {
  FacetsWalk<Packet<Arch>>(layers).add_returns(rng, sums);
}

template <class Arch>
SUNBEAM_FLATTEN void reflectances(const FilmSide& film, const FilmPhases& phases, double cosine, double* r) {
  using Batch = xsimd::batch<double, Arch>;
  const FilmLanes<Batch> lanes(film, phases, Batch(cosine));
  for (int j = 0; j < phases.count; j += static_cast<int>(Batch::size))
    lanes.reflectance_at(Batch::load_unaligned(&phases.k[j])).store_unaligned(r + j);
}

template <class Arch>
SUNBEAM_FLATTEN void attenuate(const double* tau, double length, int count, double* power) {
  using Batch = xsimd::batch<double, Arch>;
  constexpr int kSize = static_cast<int>(Batch::size);
  const auto attenuated = [&](const double* p, int j) {
    return Batch::load_unaligned(p) * exp_negative(Batch::load_unaligned(tau + j) * Batch(-length));
  };
  int j = 0;
  for (; j + kSize <= count; j += kSize) attenuated(power + j, j).store_unaligned(power + j);
  if (j == count) return;
  double last[kSize]{};
  for (int k = 0; j + k < count; ++k) last[k] = power[j + k];
  attenuated(last, j).store_unaligned(last);
  for (int k = 0; j + k < count; ++k) power[j + k] = last[k];
}

}  // namespace sunbeam::walk
