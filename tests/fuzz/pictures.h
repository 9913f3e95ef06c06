// What the targets of pictures share: what is sound about a picture that a reader returns.
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include "runtime/tracer/environment.h"
#include "runtime/tracer/environment_map.h"
#include "runtime/tracer/height_map.h"
#include "runtime/tracer/image.h"

namespace sunbeam::test {

inline void require(bool is_sound) {
  if (!is_sound) std::abort();
}

inline void require_values(const std::vector<float>& values, int width, int height, std::size_t channels,
                           float lowest) {
  require(width > 0 && height > 0);
  require(values.size() == channels * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (const float value : values) require(std::isfinite(value) && value >= lowest);
}

inline void require_picture(const Image& image, float lowest = -std::numeric_limits<float>::max()) {
  require_values(image.rgb, image.width, image.height, 3, lowest);
}

inline void require_heights(const HeightMap& map) {
  require_values(map.values, map.width, map.height, 1, -1e6f);
  require(std::isfinite(map.sample({0.3, 0.7}).height));
}

// Draws from the map as lighting does.
inline void require_environment(EnvironmentMap loaded) {
  require_picture(loaded.map, 0);
  EnvironmentSource source;
  source.map = std::move(loaded.map);
  const Environment environment(source);
  const Vec3 direction = environment.sample({0.3, 0.7});
  require(std::isfinite(length(direction)) && std::isfinite(environment.pdf(direction)));
  require(is_finite(environment.radiance(direction)) && std::isfinite(environment.mean_radiance()));
}

}  // namespace sunbeam::test
