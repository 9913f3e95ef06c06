#include "runtime/src/textured/layered_rest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/src/base/exp4.h"
#include "runtime/src/rest/textured_media.h"

namespace sunbeam {
inline namespace v1 {
namespace {

Color4 least_reflectance(const Wavelengths& wavelengths) {
  for (const Rgb& weight : wavelengths.weight)
    if (std::min({weight.r, weight.g, weight.b}) < 0) return Color4{} - std::numeric_limits<float>::max();
  return Color4{};
}

Axis linear(Axis axis) {
  axis.is_cubic = false;
  return axis;
}

int nearest(const BoundAxis::Taps& taps) {
  const auto most = std::max_element(taps.weight.begin(), taps.weight.begin() + taps.count);
  return taps.offset[static_cast<std::size_t>(most - taps.weight.begin())];
}

}  // namespace

LayeredRest::LayeredRest(const Table& table)
    : grid_(table),
      absorption_(mean_absorption(table.factors.wavelengths)),
      pigment_thickness_nm_(table.material.pigment_thickness_nm),
      cubic_thickness_(grid_.axes[0], grid_.axes[1].size()),
      linear_thickness_(linear(grid_.axes[0]), grid_.axes[1].size()),
      base_ior_(grid_.axes[1], 1),
      absorptions_(grid_.axes[2], 1),
      least_(least_reflectance(table.factors.wavelengths)),
      arrays_(table, grid_, absorption_) {}

LayeredRest::Point LayeredRest::point(const Parameters& at) const {
  const BoundAxis::Taps d = linear_thickness_.at(at.film_thickness_nm), n = base_ior_.at(at.base_ior),
                        s = absorptions_.at(at.absorption_per_nm);
  return {{cubic_thickness_.at(at.film_thickness_nm), n},
          {d, n},
          s.offset[0],
          s.count > 1 ? s.weight[1] : 0,
          nearest(d) + nearest(n),
          nearest(s),
          static_cast<float>((at.absorption_per_nm - grid_.axes[2].nodes.front()) * pigment_thickness_nm_)};
}

Color4 LayeredRest::reflectance(const Point& at, float cosine) const {
  const EvenPosition c(cosine, grid_.cosines);
  Color4 low{}, high{};
  for (int k = 0; k < at.cubic.count; ++k) {
    const Color4* row = arrays_.film.data() + at.cubic.node[k] * grid_.cosines + c.lower;
    low += at.cubic.weight[k] * row[0];
    high += at.cubic.weight[k] * row[1];
  }
  return max4(low + c.upper_weight * (high - low), least_);
}

Color4 LayeredRest::share(const Point& at, const End& w) const {
  const EvenPosition c(w.cosine, grid_.cosines), p(w.phi, grid_.phis);
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

Color4 LayeredRest::factor(const Point& at, const End& w) const {
  const Color4 share = this->share(at, w);
  if (grid_.absorptions() == 1) return share;
  return share * exp4(log(at, w) - (at.beyond * w.per_pigment_cosine) * absorption_);
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

LayeredRest::PairTaps LayeredRest::taps(const End& end) const {
  const EvenPosition c(end.cosine, grid_.pair_cosines());
  PairTaps taps{{c.lower, c.lower + 1}, {1 - c.upper_weight, c.upper_weight}, 2};
  if (grid_.pair_phis() == 1) return taps;
  const EvenPosition p(end.phi, grid_.pair_phis());
  for (int k = 0; k < 2; ++k) {
    taps.node[k] += p.lower * grid_.pair_cosines();
    taps.node[k + 2] = taps.node[k] + grid_.pair_cosines();
    taps.weight[k + 2] = taps.weight[k] * p.upper_weight;
    taps.weight[k] *= 1 - p.upper_weight;
  }
  taps.count = 4;
  return taps;
}

Color4 LayeredRest::exchange(const Point& at, const End& o, const End& i) const {
  const PairTaps of_o = taps(o), of_i = taps(i);
  const int ends = grid_.ends(), absorptions = grid_.absorptions() == 1 ? 1 : 2;
  Color4 sum{};
  for (int s = 0; s < absorptions; ++s) {
    const float upper = s == 1 ? at.upper_absorption : 1 - at.upper_absorption;
    Color4 of_absorption{};
    for (int k = 0; k < at.linear.count; ++k) {
      const auto node = static_cast<std::size_t>(at.linear.node[k] * grid_.absorptions() + at.absorption + s);
      const Color4* pairs = arrays_.pairs.data() + node * static_cast<std::size_t>(ends * ends);
      Color4 of_point{};
      for (int a = 0; a < of_o.count; ++a) {
        const Color4* row = pairs + of_o.node[a] * ends;
        Color4 of_row{};
        for (int b = 0; b < of_i.count; ++b) of_row += of_i.weight[b] * row[of_i.node[b]];
        of_point += of_o.weight[a] * of_row;
      }
      of_absorption += at.linear.weight[k] * of_point;
    }
    sum += upper * of_absorption;
  }
  return sum;
}

}  // namespace v1
}  // namespace sunbeam
