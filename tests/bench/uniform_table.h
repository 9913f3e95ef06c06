// The whole BRDF over (theta_i, theta_o, |dphi|), even steps from 0 to 90, 90 and 180 degrees, half floats,
// trilinear. It holds f, or f cos_i cos_o, which has no pole at grazing.
#pragma once

#include "tests/bench/half_grid.h"
#include "tests/bench/plain_table.h"

namespace sunbeam {

class UniformTable final : public PlainTable {
 public:
  enum class Holds { f, f_cos_cos };

  UniformTable(const Bsdf& truth, const HalfGrid::Nodes& nodes, Holds holds) : grid_(nodes), holds_(holds) {
    for (std::size_t i = 0; i < nodes[0]; ++i)
      for (std::size_t j = 0; j < nodes[1]; ++j)
        for (std::size_t k = 0; k < nodes[2]; ++k) grid_.set({i, j, k}, held({i, j, k}, truth));
  }

  std::size_t bytes() const override { return grid_.bytes(); }

 private:
  double fraction(const HalfGrid::Nodes& at, std::size_t axis) const {
    return static_cast<double>(at[axis]) / static_cast<double>(grid_.nodes()[axis] - 1);
  }

  Rgb held(const HalfGrid::Nodes& at, const Bsdf& truth) const {
    const Vec3 wi = spherical_direction(fraction(at, 0) * kPi / 2, 0);
    const Vec3 wo = spherical_direction(fraction(at, 1) * kPi / 2, fraction(at, 2) * kPi);
    Rng rng(0, 0);  // the truth is deterministic
    const Rgb f = truth.eval(above_horizon(wo), above_horizon(wi), rng);
    return holds_ == Holds::f ? f : f * (wi.z * wo.z);
  }

  static double quarter_turns(double cosine) { return std::acos(std::min(cosine, 1.0)) * (2 / kPi); }

  Rgb value(const Vec3& wo, const Vec3& wi) const override {
    const double phi = std::atan2(std::abs(wi.x * wo.y - wi.y * wo.x), wi.x * wo.x + wi.y * wo.y);
    const Rgb found = grid_(quarter_turns(wi.z), quarter_turns(wo.z), phi / kPi);
    return holds_ == Holds::f ? found : found / (wi.z * wo.z);
  }

  HalfGrid grid_;
  Holds holds_;
};

}  // namespace sunbeam
