// The plainest unidirectional walk: one path, one direction, three wavelengths, scalar; every choice drawn
// independently. Kept as the yardstick of the benchmarks and as a second code path for the tests.
#pragma once

#include <optional>

#include "tests/support/plain_base.h"
#include "tests/support/plain_film.h"

namespace sunbeam::test {

class PlainWalk {
 public:
  PlainWalk(const Material& material, const Rgb& wavelengths_nm)
      : film_(material, wavelengths_nm),
        base_(material),
        radiance_scale_(material.radiance_scale()),
        brightest_albedo_(max_component(material.albedo)) {}

  // One unbiased estimate of rest(wo, wi), 1/sr: at every visit of the base a crossing drawn from wo and the
  // walk's own way out, combined by the balance heuristic over inside directions.
  Rgb estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    const auto entry = film_.cross(wi, film_.meet_from_outside(wi, rng));
    if (!entry) return {};
    Vec3 m = entry->inside;
    Rgb throughput = entry->weight, sum;
    double roulette = 1;
    do sum += connect(m, throughput, wo, rng);
    while (next_visit(m, throughput, roulette, rng, wo, sum));
    return sum;
  }

 private:
  Rgb connect(const Vec3& m, const Rgb& throughput, const Vec3& wo, Rng& rng) const {
    const auto crossing = film_.cross(wo, film_.meet_from_outside(wo, rng));
    if (!crossing) return {};
    const double mis = crossing->density > 0
                           ? crossing->density / (crossing->density + base_.density(m.z, crossing->inside.z))
                           : 1;
    return throughput * base_.value(m.z, crossing->inside.z) * crossing->weight * (mis * radiance_scale_);
  }

  // From the base up to the film and back down. False when the walk ends.
  bool next_visit(Vec3& m, Rgb& throughput, double& roulette, Rng& rng, const Vec3& wo, Rgb& sum) const {
    const auto up = base_.sample(m.z, rng);
    throughput *= up.weight;
    if (is_black(throughput)) return false;
    if (film_.has_glossy_crossing()) {
      const Exit exit = film_.exit(up.direction, wo);
      sum += throughput * exit.value * (up.density / (up.density + exit.density));
    }
    const auto down = film_.reflect_down(up.direction, film_.meet_from_below(up.direction, rng));
    if (!down) return false;
    m = down->direction;
    throughput *= down->weight;

    constexpr double kRouletteStart = 0.02;
    roulette *= brightest_albedo_ * max_component(down->weight);
    if (roulette >= kRouletteStart) return true;
    const double survival = roulette / kRouletteStart;
    if (rng.uniform() >= survival) return false;
    throughput *= 1 / survival;
    roulette = kRouletteStart;
    return true;
  }

  FacetedFilm film_;
  PigmentedBase base_;
  double radiance_scale_;
  double brightest_albedo_;
};

}  // namespace sunbeam::test
