#include "runtime/src/textured/layered_rest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/src/base/compiler.h"
#include "runtime/src/rest/textured_media.h"

namespace sunbeam {
inline namespace v1 {
namespace {

Color4 least_reflectance(const Wavelengths& wavelengths) {
  for (const Rgb& weight : wavelengths.weight)
    if (std::min({weight.r, weight.g, weight.b}) < 0) return Color4{} - std::numeric_limits<float>::max();
  return Color4{};
}

// Of the four nodes around x, which counts from the first.
std::array<float, 4> cubic_weights(float x) {
  const float a = x - 1, b = x - 2, c = x - 3;
  return {a * b * c / -6, x * b * c / 2, x * a * c / -2, x * a * b / 6};
}

}  // namespace

LayeredRest::LayeredRest(const Table& table)
    : grid_(table),
      absorption_(mean_absorption(table.factors.wavelengths)),
      pigment_thickness_nm_(table.material.pigment_thickness_nm),
      base_ior_(grid_.axes[1], 1),
      least_(least_reflectance(table.factors.wavelengths)),
      arrays_(table, grid_, absorption_) {}

LayeredRest::Point LayeredRest::point(const Parameters& at) const {
  Point point;
  point.knee = grid_.knee(at.base_ior);
  BoundAxis::Taps n{1, {}, {1}};
  const int iors = static_cast<int>(grid_.axes[1].size()), thicknesses = grid_.points() / iors;
  if (iors > 1) n = base_ior_.at(at.base_ior);
  point.nearest = n.offset[n.count > 1 && n.weight[1] > 0.5f ? 1 : 0];
  if (thicknesses == 1) {
    for (int j = 0; j < n.count; ++j) {
      point.cubic.add(n.offset[j], n.weight[j]);
      point.linear.add(n.offset[j], n.weight[j]);
    }
  } else {
    const EvenPosition d = grid_.even[0].locate(at.film_thickness_nm);
    const int first = std::clamp(d.lower - 1, 0, thicknesses - 4);
    const auto weights = cubic_weights(static_cast<float>(d.lower - first) + d.upper_weight);
    for (int j = 0; j < n.count; ++j) {
      for (int i = 0; i < 4; ++i) point.cubic.add((first + i) * iors + n.offset[j], weights[i] * n.weight[j]);
      point.linear.add(d.lower * iors + n.offset[j], (1 - d.upper_weight) * n.weight[j]);
      point.linear.add((d.lower + 1) * iors + n.offset[j], d.upper_weight * n.weight[j]);
    }
    point.nearest += (d.lower + (d.upper_weight > 0.5f ? 1 : 0)) * iors;
  }
  take_absorption(at.absorption_per_nm, point);
  return point;
}

void LayeredRest::take_absorption(double absorption_per_nm, Point& point) const {
  point.absorption = point.nearest_absorption = 0;
  point.upper_absorption = 0;
  point.beyond =
      static_cast<float>((absorption_per_nm - grid_.axes[2].nodes.front()) * pigment_thickness_nm_);
  if (grid_.absorptions() == 1) return;
  const EvenPosition s = grid_.even[2].locate(absorption_per_nm);
  point.absorption = s.lower;
  point.upper_absorption = s.upper_weight;
  point.nearest_absorption = s.lower + (s.upper_weight > 0.5f ? 1 : 0);
}

Color4 LayeredRest::reflectance(const Point& at, float cosine) const {
  const EvenPosition c(at.knee.place(cosine), grid_.cosines);
  Color4 low{}, high{};
  for (int k = 0; k < at.cubic.count; ++k) {
    const Color4* row = arrays_.film.data() + at.cubic.node[k] * grid_.cosines + c.lower;
    low += at.cubic.weight[k] * row[0];
    high += at.cubic.weight[k] * row[1];
  }
  return max4(low + c.upper_weight * (high - low), least_);
}

Color4 LayeredRest::share(const Point& at, const End& w) const {
  const EvenPosition c(at.knee.place(w.cosine), grid_.cosines), p(w.phi, grid_.phis);
  const int azimuths = grid_.phis == 1 ? 1 : 2;
  Color4 sum{};
  for (int a = 0; a < azimuths; ++a) {
    const float azimuth = azimuths == 1 ? 1 : a == 0 ? 1 - p.upper_weight : p.upper_weight;
    const int first = (azimuths == 1 ? 0 : p.lower + a) * grid_.cosines + c.lower;
    Color4 low{}, high{};
    for (int k = 0; k < at.cubic.count; ++k) {
      const Color4* row = arrays_.shares.data() + at.cubic.node[k] * grid_.phis * grid_.cosines + first;
      low += at.cubic.weight[k] * row[0];
      high += at.cubic.weight[k] * row[1];
    }
    sum += azimuth * (low + c.upper_weight * (high - low));
  }
  return max4(sum, Color4{});  // cubics may overshoot
}

Color4 LayeredRest::log(const Point& at, const End& w) const {
  const EvenPosition c(w.cosine, LayeredGrid::kLogCosines), p(w.phi, grid_.phis);
  const int azimuths = grid_.phis == 1 ? 1 : 2, columns = grid_.columns();
  Color4 sum{};
  for (int a = 0; a < azimuths; ++a) {
    const float azimuth = azimuths == 1 ? 1 : a == 0 ? 1 - p.upper_weight : p.upper_weight;
    const int first = (azimuths == 1 ? 0 : p.lower + a) * LayeredGrid::kLogCosines + c.lower;
    for (int k = 0; k < at.linear.count; ++k) {
      const Color4* row =
          arrays_.logs.data() + (at.linear.node[k] * grid_.absorptions() + at.absorption) * columns + first;
      const Color4 low = row[0] + c.upper_weight * (row[1] - row[0]),
                   high = row[columns] + c.upper_weight * (row[columns + 1] - row[columns]);
      sum += (azimuth * at.linear.weight[k]) * (low + at.upper_absorption * (high - low));
    }
  }
  return sum;
}

LayeredRest::Factor LayeredRest::factor(const Point& at, const End& w) const {
  if (grid_.absorptions() == 1) return {share(at, w), Color4{}};
  return {share(at, w), log(at, w) - (at.beyond * w.per_pigment_cosine) * absorption_};
}

float LayeredRest::first_chance(const Point& at, const End& w) const {
  if (!grid_.has_rest) return 1;
  const EvenPosition c(w.cosine, LayeredGrid::kLogCosines);
  const int azimuth = static_cast<int>(w.phi * static_cast<float>(grid_.phis - 1) + 0.5f);
  const Color4* row = arrays_.logs.data() +
                      (at.nearest * grid_.absorptions() + at.nearest_absorption) * grid_.columns() +
                      azimuth * LayeredGrid::kLogCosines + c.lower;
  return row[0][3] + c.upper_weight * (row[1][3] - row[0][3]);
}

LayeredRest::PairRows LayeredRest::pair_rows(const Point& at, const End& o, const End& i) const {
  const int cosines = grid_.pair_cosines(), phis = grid_.pair_phis();
  const PairTaps of_o(o.cosine, o.phi, cosines, phis), of_i(i.cosine, i.phi, cosines, phis);
  const int ends = grid_.ends(), absorptions = grid_.absorptions() == 1 ? 1 : 2;
  PairRows rows;
  rows.taps = of_i.count;
  rows.node = of_i.node;
  rows.node_weight = of_i.weight;
  for (int s = 0; s < absorptions; ++s)
    for (int k = 0; k < at.linear.count; ++k) {
      const auto node = static_cast<std::size_t>(at.linear.node[k] * grid_.absorptions() + at.absorption + s);
      const Color4* pairs = arrays_.pairs.data() + node * static_cast<std::size_t>(ends * ends);
      const float weight = at.linear.weight[k] * (s == 1 ? at.upper_absorption : 1 - at.upper_absorption);
      for (int a = 0; a < of_o.count; ++a) {
        const Color4* row = pairs + of_o.node[a] * ends;
        for (int b = 0; b < of_i.count; b += 2) prefetch(row + of_i.node[b]);
        rows.row[rows.count] = row;
        rows.weight[rows.count++] = weight * of_o.weight[a];
      }
    }
  return rows;
}

Color4 LayeredRest::exchange(const PairRows& rows) {
  Color4 sum{};
  for (int b = 0; b < rows.taps; ++b) {
    Color4 of_node{};
    for (int k = 0; k < rows.count; ++k) of_node += rows.weight[k] * rows.row[k][rows.node[b]];
    sum += rows.node_weight[b] * of_node;
  }
  return sum;
}

}  // namespace v1
}  // namespace sunbeam
