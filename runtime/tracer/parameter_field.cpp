#include "runtime/tracer/parameter_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

HeightMap random_map(int cells, Rng& rng) {
  HeightMap map{cells, cells, {}};
  map.values.resize(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  for (float& value : map.values) value = static_cast<float>(rng.uniform());
  return map;
}

void stretch(std::vector<float>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const float from = *low, range = std::max(*high - *low, 1e-6f);
  for (float& value : values) value = (value - from) / range;
}

}  // namespace

double ParameterField::at(const Point2& uv) const {
  const double x = along.x * uv.x + along.y * uv.y;
  double s = 0;
  switch (kind) {
    case Kind::constant:
      return from;
    case Kind::ramp:
      s = x;
      break;
    case Kind::bands:
      s = 0.5 - 0.5 * std::cos(2 * kPi * x);
      break;
    case Kind::map:
      s = map->sample({along.x * uv.x, along.y * uv.y}).height;
  }
  return lerp(std::clamp(s, 0.0, 1.0), from, to);
}

std::pair<double, double> ParameterField::bounds() const { return std::minmax(from, to); }

// The sum is sampled at four pixels to a cell of the finest layer.
HeightMap noise_map(int cells, int octaves, std::uint64_t seed) {
  const int size = 4 * (cells << (octaves - 1));
  HeightMap sum{size, size,
                std::vector<float>(static_cast<std::size_t>(size) * static_cast<std::size_t>(size))};
  Rng rng(seed, 0x6e6f697365);
  float strength = 1;
  for (int octave = 0; octave < octaves; ++octave, strength /= 2) {
    const HeightMap layer = random_map(cells << octave, rng);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        sum.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                   static_cast<std::size_t>(x)] +=
            strength * static_cast<float>(layer.sample({(x + 0.5) / size, 1 - (y + 0.5) / size}).height);
  }
  stretch(sum.values);
  return sum;
}

}  // namespace sunbeam
