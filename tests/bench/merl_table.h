// The layout of the MERL database (Matusik et al. 2003): 90 x 90 x 180 cells over half and difference angles,
// the first by the square root of theta_h, phi_d in [0, pi) by reciprocity; doubles, one plane a channel, the
// nearest cell's value. A cell holds the value at its centre.
#pragma once

#include <vector>

#include "tests/bench/plain_table.h"

namespace sunbeam {

class MerlTable final : public PlainTable {
 public:
  explicit MerlTable(const Bsdf& truth) : values_(3 * kCells) {
    Rng rng(0, 0);  // the truth is deterministic
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      const auto [wo, wi] = centre(cell);
      const Rgb f = truth.eval(above_horizon(wo), above_horizon(wi), rng);
      for (std::size_t c = 0; c < 3; ++c) values_[c * kCells + cell] = f[static_cast<int>(c)];
    }
  }

  // The file begins with three 32-bit sizes.
  std::size_t bytes() const override { return 3 * sizeof(std::int32_t) + values_.size() * sizeof(double); }

 private:
  static constexpr std::size_t kThetaH = 90, kThetaD = 90, kPhiD = 180, kCells = kThetaH * kThetaD * kPhiD;

  struct Pair {
    Vec3 wo, wi;
  };

  static Pair centre(std::size_t cell) {
    const auto middle = [](std::size_t k, std::size_t count) {
      return (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    };
    const double theta_h = square(middle(cell / (kThetaD * kPhiD), kThetaH)) * kPi / 2;
    const double theta_d = middle(cell / kPhiD % kThetaD, kThetaD) * kPi / 2;
    const Vec3 d = spherical_direction(theta_d, middle(cell % kPhiD, kPhiD) * kPi);
    const Vec3 h{std::sin(theta_h), 0, std::cos(theta_h)};
    const Vec3 wi{h.z * d.x + h.x * d.z, d.y, h.z * d.z - h.x * d.x};
    return {reflect(wi, h), wi};
  }

  static std::size_t bin(double fraction, std::size_t count) {
    return std::min(static_cast<std::size_t>(fraction * static_cast<double>(count)), count - 1);
  }

  // Azimuth of wi about h, from the plane of h and the normal.
  static double difference_azimuth(const Vec3& wi, const Vec3& h) {
    const double sin_h = std::hypot(h.x, h.y);
    const double x = sin_h > 0 ? h.x / sin_h : 1, y = sin_h > 0 ? h.y / sin_h : 0;
    const double phi = std::atan2(x * wi.y - y * wi.x, h.z * (x * wi.x + y * wi.y) - sin_h * wi.z);
    return phi < 0 ? phi + kPi : phi;
  }

  Rgb value(const Vec3& wo, const Vec3& wi) const override {
    const Vec3 h = normalize(wo + wi);
    const double theta_h = std::acos(std::min(h.z, 1.0)), theta_d = std::acos(std::min(dot(h, wi), 1.0));
    const std::size_t cell =
        (bin(std::sqrt(theta_h * (2 / kPi)), kThetaH) * kThetaD + bin(theta_d * (2 / kPi), kThetaD)) * kPhiD +
        bin(difference_azimuth(wi, h) * kInvPi, kPhiD);
    return {values_[cell], values_[kCells + cell], values_[2 * kCells + cell]};
  }

  std::vector<double> values_;
};

}  // namespace sunbeam
