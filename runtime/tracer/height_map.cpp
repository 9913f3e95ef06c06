#include "runtime/tracer/height_map.h"

#include <array>
#include <cmath>

namespace sunbeam {
namespace {

// The four weights of a uniform cubic B-spline at t in [0, 1) past the second control point, and their
// slopes.
struct SplineWeights {
  std::array<double, 4> value, slope;

  explicit SplineWeights(double t) {
    const double s = 1 - t;
    value = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
             t * t * t / 6};
    slope = {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2};
  }
};

// Where `x` periods from the origin fall among `count` control points at (k + 1/2) / count.
struct Span {
  std::array<int, 4> index;
  SplineWeights weights;

  Span(double x, int count) : Span((x - std::floor(x)) * count - 0.5, count, 0) {}

 private:
  Span(double position, int count, int) : weights(position - std::floor(position)) {
    const int first = static_cast<int>(std::floor(position)) - 1 + count;
    for (int k = 0; k < 4; ++k) index[static_cast<std::size_t>(k)] = (first + k + count) % count;
  }
};

}  // namespace

HeightMap::Sample HeightMap::sample(const Point2& uv) const {
  const Span across(uv.x, width), down(-uv.y, height);
  Sample result;
  for (std::size_t j = 0; j < 4; ++j) {
    double value = 0, slope = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double h = at(across.index[i], down.index[j]);
      value += across.weights.value[i] * h;
      slope += across.weights.slope[i] * h;
    }
    result.height += down.weights.value[j] * value;
    result.gradient.x += down.weights.value[j] * slope;
    result.gradient.y -= down.weights.slope[j] * value;
  }
  result.gradient.x *= width;
  result.gradient.y *= height;
  return result;
}

}  // namespace sunbeam
