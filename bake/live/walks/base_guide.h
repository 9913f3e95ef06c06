// This file guides walks by the importance of directions that leave the base. It is a density over t = cos^2,
// where cos-weighted is uniform.
//
// Bins have equal probability, so a sample is one look-up, and stays stratified when its uniform number is.
#pragma once

#include <array>

#include "bake/live/walks/packet.h"

namespace sunbeam::walk {

class BaseGuide {
 public:
  static constexpr int kBins = 64;
  static constexpr double kCosineShare = 0.1;

  // Takes the importance at the midpoints of equal bins of t, none negative. A share of the samples stays
  // cos-weighted, which bounds 1 / density.
  explicit BaseGuide(const std::array<double, kBins>& importance);

  template <class V>
  struct Sample {
    V square;       // t
    V per_density;  // 1 / density over t
  };
  template <class V>
  SUNBEAM_INLINE Sample<V> sample(const V& u) const;

  // Returns the density over t.
  double density(double square) const;

 private:
  static constexpr double kLeastSquare = 1e-24;  // directions along the surface see nothing

  std::array<double, kBins + 1> edge_;
};

template <>
SUNBEAM_INLINE BaseGuide::Sample<double> BaseGuide::sample(const double& u) const {
  const int bin = static_cast<int>(u * kBins);
  const double width = edge_[bin + 1] - edge_[bin];
  return {max(edge_[bin] + (u * kBins - bin) * width, kLeastSquare), width * kBins};
}

template <class V>
SUNBEAM_INLINE BaseGuide::Sample<V> BaseGuide::sample(const V& u) const {
  double at[kLanes];
  (u * V(kBins)).store(at);
  const auto bin = [&](int lane) { return static_cast<int>(at[lane]); };
  const V low = V::generate([&](int lane) { return edge_[bin(lane)]; });
  const V width = V::generate([&](int lane) { return edge_[bin(lane) + 1]; }) - low;
  const V within = V::generate([&](int lane) { return at[lane] - bin(lane); });
  return {max(low + within * width, V(kLeastSquare)), width * V(kBins)};
}

struct Layers;

// Holds what a few walks between film and base tell about them. Its noise is harmless, for it only steers
// choices.
struct BaseForecast {
  BaseGuide going_on;  // for walks that go on: towards what the film throws back and the pigment lets through
  BaseGuide leaving;   // for walks that may leave: towards what gets out, now or later
  double worth;        // share of the light that enters steeply that leaves again, mean over wavelengths
};
BaseForecast forecast_base(const Layers& layers);

}  // namespace sunbeam::walk
