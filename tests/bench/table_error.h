// How far a BSDF is off the exact one, for one wi at a time:
//     Int |f - f_exact| cos_o dwo / max(Int |f_exact| cos_o dwo, 0.002),   mean over channels,
// by importance sampling with the exact BSDF's own directions. wi is uniform in cosine, theta <= 89 degrees.
#pragma once

#include <vector>

#include "bake/base/error_floor.h"
#include "sunbeam/bsdf.h"

namespace sunbeam {

// The directions for one wi, the same for every BSDF held against the exact one.
struct Probe {
  struct Direction {
    Vec3 wo;
    double weight;  // cos / (pdf attempts)
    Rgb f;          // exact
  };
  Vec3 wi;
  std::vector<Direction> directions;
  double reflected = 0;  // Int |f_exact| cos_o dwo
};

// The non-Dirac part of `exact`; lost draws count as attempts.
inline Probe draw_probe(const Bsdf& exact, std::size_t attempts, Rng& rng) {
  Probe probe;
  probe.wi = direction_from_cosine(lerp(rng.uniform(), std::cos(89 * kPi / 180), 1), 0);
  for (std::size_t k = 0; k < attempts; ++k) {
    const auto sample = exact.sample(probe.wi, rng);
    if (!sample || sample->is_dirac) continue;
    const Vec3& wo = sample->wi;
    const double weight = wo.z / (exact.mis_pdf(probe.wi, wo) * static_cast<double>(attempts));
    probe.directions.push_back({wo, weight, exact.eval(wo, probe.wi, rng)});
    probe.reflected += weight * mean_abs(probe.directions.back().f);
  }
  return probe;
}

inline double error_of(const Bsdf& bsdf, const Probe& probe, Rng& rng) {
  double difference = 0;
  for (const auto& [wo, weight, f] : probe.directions)
    difference += weight * mean_abs(bsdf.eval(wo, probe.wi, rng) - f);
  return difference / std::max(probe.reflected, kDarkestAlbedo);
}

}  // namespace sunbeam
