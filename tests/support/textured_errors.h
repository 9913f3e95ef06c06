// How far textured look-ups of a table are from bound ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"

namespace sunbeam::test {

inline Parameters random_parameters(const Table& table, Rng& rng) {
  std::array<double, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
    x[k] = lerp(rng.uniform(), table.parameter_axis(k).low(), table.parameter_axis(k).high());
  return {x[0], x[1], x[2]};
}

inline double mean_abs(const Rgb& x) { return (std::abs(x.r) + std::abs(x.g) + std::abs(x.b)) / 3; }

// As bake/check/verify.h measures a table: Int |difference| cos / max(Int |f| cos, 0.002).
inline double error_at(const TexturedTable& textured, const Table& table, const Parameters& at, Rng& rng) {
  const TexturedTable::At bsdf = textured.at(at);
  const TableBsdf reference(table, at);
  const Vec3 wi = direction_from_cosine(lerp(rng.uniform(), std::cos(89 * kPi / 180), 1), 1);
  double difference = 0, total = 0;
  constexpr int kDraws = 256;
  for (int k = 0; k < kDraws; ++k) {
    const auto sample = reference.sample(wi, rng);
    if (!sample || sample->is_dirac) continue;
    const EvalPdf expected = reference.eval_pdf(sample->wi, wi);
    const double weight = sample->wi.z / reference.mis_pdf(wi, sample->wi) / kDraws;
    difference += weight * mean_abs(bsdf.eval_pdf(sample->wi, wi).f - expected.f);
    total += weight * mean_abs(expected.f);
  }
  return difference / std::max(total, 0.002);
}

// At random points, each with a direction and draws of its own: what sample() does with its random numbers
// does not move them.
inline std::vector<double> sorted_errors(const TexturedTable& textured, const Table& table, int points) {
  Rng places(6, 0);
  std::vector<double> errors;
  for (int k = 0; k < points; ++k) {
    Rng draws(6, 1 + static_cast<std::uint64_t>(k));
    errors.push_back(error_at(textured, table, random_parameters(table, places), draws));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

}  // namespace sunbeam::test
