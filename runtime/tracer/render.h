// Rendering a scene into a picture, on all cores.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "runtime/tracer/image.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/bsdf.h"

namespace sunbeam {

struct RenderSettings {
  int width = 0, height = 0, spp = 0;  // 0: the scene's own
  int threads = 0;                     // 0: all cores
  std::uint64_t seed = 0;
  // Called with the fraction done, rising to 1, by one thread at a time. If it throws, rendering stops and
  // the exception reaches the caller.
  std::function<void(double)> progress{};
};

struct RenderStats {
  double seconds = 0;      // wall clock, building the search structure included
  double cpu_seconds = 0;  // of the whole process meanwhile
  std::uint64_t samples = 0, rays = 0, vertices = 0;
  double samples_per_second = 0;
  long peak_rss_mb = 0;           // of the process so far
  std::uint64_t bad_samples = 0;  // not finite; each counts as black
};

struct RenderResult {
  Image mean;
  Image variance;  // of the mean of each pixel, estimated from its samples; 0 where spp = 1 cannot tell
  RenderStats stats;
};

// bsdfs[i] belongs to scene.materials[i], diffuse ones included, and is used by many threads at once.
// The picture depends on scene, bsdfs, size, spp and seed, never on the number of threads: every pixel has
// its own Rng(seed, pixel index). Pixels are box-filtered. Throws Error for settings out of range, and lets
// exceptions of the BSDFs through.
RenderResult render(const Scene& scene, std::span<const Bsdf* const> bsdfs, const RenderSettings& settings);

}  // namespace sunbeam
