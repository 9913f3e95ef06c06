// This file renders a scene into a picture, on all cores, pass after pass, until a limit is met.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "runtime/tracer/image.h"
#include "runtime/tracer/scene.h"
#include "runtime/tracer/surface_bsdf.h"

namespace sunbeam {

struct RenderStats {
  double seconds = 0;            // wall clock, building the search structure included
  double cpu_seconds = 0;        // of the whole process meanwhile
  double build_cpu_seconds = 0;  // of those, until the first ray could be traced
  double fraction = 0;           // of the work, as far as it can be foreseen; 1 when a limit was met
  std::uint64_t samples = 0, rays = 0, vertices = 0;
  double samples_per_second = 0;
  long peak_rss_mb = 0;           // of the process so far
  std::uint64_t bad_samples = 0;  // not finite, or beyond 1e18; each counts as black
  bool stopped = false;           // by the monitor, before any limit was met
};

// Holds what the camera rays met first, averaged over each pixel's samples (pixel_sums.h says what each is).
// Normals are in world space and shorter than 1 where samples differ; depth and film thickness are averages
// over the samples that met a surface, 0 where none did.
struct FirstHits {
  Image albedo, shading_normal, geometric_normal;
  std::vector<float> depth, film_thickness_nm;  // rows from the top
};

struct RenderResult {
  PixelWindow window;  // of the whole picture; all below covers this part
  Image mean;
  Image variance;  // of the mean of each pixel, estimated from its samples; 0 where one sample cannot tell
  std::vector<float> sample_count;  // of each pixel
  std::optional<FirstHits> first_hits;
  RenderStats stats;
};

struct RenderSettings {
  int width = 0, height = 0, spp = 0;  // 0: the scene's own
  int threads = 0;                     // 0: all cores
  std::uint64_t seed = 0;
  std::optional<PixelWindow> crop{};  // the part to render; its pixels are those of the whole picture
  double seconds = 0;                 // limit of wall clock time from the call on; 0: none
  // This is the limit of noise; 0 is none. Blocks of 8 x 8 pixels stop when their standard error (root mean
  // square over pixels and channels) falls below this part of their brightness, or of a tenth of the
  // picture's where they are darker; looked at when a pixel has 16, 32, 64, ... samples. Stopping by what was
  // seen makes a small bias, well below the noise it leaves.
  double noise = 0;
  bool first_hits = false;               // fill RenderResult::first_hits
  const RenderResult* resume = nullptr;  // go on from here: same window, scene and seed
  // It is called after every tile by one thread at a time, with the picture so far (stats: counts, seconds
  // and fraction). Returning false stops. If it throws, rendering stops and the exception reaches the caller.
  std::function<bool(const RenderResult&)> monitor{};
};

// Renders a scene. bsdfs[i] belongs to scene.materials[i], diffuse ones included, and is used by many threads
// at once. The picture depends on scene, bsdfs, size, spp, noise and seed, never on the number of threads:
// sample k of a pixel has its own Rng(seed, pixel and k), and samples are added in order. Only a limit of
// time makes the number of samples, never their values, depend on the machine. A resumed picture equals the
// uninterrupted one but for the single precision of `resume`. Pixels are box-filtered. Throws Error for
// settings out of range, and lets exceptions of the BSDFs through.
RenderResult render(const Scene& scene, std::span<const SurfaceBsdf> bsdfs, const RenderSettings& settings);

}  // namespace sunbeam
