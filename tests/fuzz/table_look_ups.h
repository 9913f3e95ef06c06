// This file looks a table up as renderers do, and ends the target if a value is not finite or a density is
// negative. It serves the targets of all forms of tables.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>

#include "sunbeam/table.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"

namespace sunbeam::test {

inline void require_sound(bool is_sound) {
  if (!is_sound) std::abort();
}

inline void require_finite(const Rgb& color) {
  for (int c = 0; c < 3; ++c) require_sound(std::isfinite(static_cast<float>(color[c])));
}

inline void require_density(double pdf) { require_sound(std::isfinite(pdf) && pdf >= 0); }

inline void look_up(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, Rng& rng) {
  const EvalPdf at = bsdf.eval_pdf(wo, wi, rng);
  require_finite(at.f);
  require_density(at.pdf);
  if (const auto sample = bsdf.sample(wo, rng)) {
    for (int c = 0; c < 3; ++c) require_sound(std::isfinite(sample->throughput[c]));
    require_sound(std::isfinite(sample->wi.x) && std::isfinite(sample->wi.y) && sample->wi.z > 0);
    require_density(sample->mis_pdf);
  }
  require_density(bsdf.eval_and_sample(wo, wi, rng).eval.pdf);
}

inline void look_up(const Bsdf& bsdf) {
  Rng rng(1, 2);
  const std::array directions = {Vec3{0, 0, 1}, normalize(Vec3{0.5, -0.2, 0.3}),
                                 normalize(Vec3{-1, 0.1, 0.01}), normalize(Vec3{-0.3, 1, 1e-4})};
  for (const Vec3& wo : directions)
    for (const Vec3& wi : directions) look_up(bsdf, wo, wi, rng);
}

inline void look_up_bound(const Table& table, const Parameters& at) {
  const TableBsdf bsdf = table.bind(at, {.outside = OutsideGrid::clamp});
  look_up(bsdf);
  const Vec3 wo = normalize(Vec3{0.4, 0.1, 0.6});
  require_finite(bsdf.dirac(wo));
  require_finite(bsdf.rest_stderr(wo, {0, 0, 1}));
  std::array<Vec3, 5> wi{};
  wi.fill(normalize(Vec3{-0.5, 0.3, 0.2}));
  std::array<Rgb, 5> f;
  bsdf.eval(wo, wi, f);
  for (const Rgb& value : f) require_finite(value);
}

inline void look_up_textured(const Table& table, std::span<const Parameters> points) {
  const TexturedTable textured(table);
  for (const Parameters& at : points) {
    const TexturedTable::At bsdf = textured.at(at);
    look_up(bsdf);
    require_sound(std::isfinite(bsdf.albedo({0, 0, 1})));
  }
}

// Looks up at the ends of the grid and within it. Preparing takes most of the time, so that the bytes
// themselves choose: one in eight is bound, one in 32 textured.
inline void look_up(const Table& table, const std::string& bytes) {
  const std::size_t lot = std::hash<std::string>()(bytes) % 32;
  const auto point = [&](double share) {
    const auto at = [&](std::size_t k) {
      return lerp(share, table.parameter_axis(k).low(), table.parameter_axis(k).high());
    };
    return Parameters{at(0), at(1), at(2)};
  };
  const std::array points = {point(0), point(0.37), point(1)};
  if (lot < 4) look_up_bound(table, points[1 + lot % 2]);
  if (lot == 4) look_up_textured(table, points);
}

}  // namespace sunbeam::test
