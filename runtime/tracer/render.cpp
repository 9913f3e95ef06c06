#include "runtime/tracer/render.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <ctime>
#include <mutex>

#include "runtime/tracer/camera.h"
#include "runtime/tracer/embree_scene.h"
#include "runtime/tracer/flush_denormals.h"
#include "runtime/tracer/lights.h"
#include "runtime/tracer/path.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr int kTileSize = 16;

// Mean and spread of the samples of one pixel (Welford 1962: no cancellation).
class PixelStatistics {
 public:
  void add(const Rgb& sample) {
    count_ += 1;
    const Rgb before = sample - mean_;
    mean_ += before / count_;
    squares_ += before * (sample - mean_);
  }
  const Rgb& mean() const { return mean_; }
  Rgb variance_of_mean() const { return count_ < 2 ? Rgb() : squares_ / (count_ * (count_ - 1)); }

 private:
  double count_ = 0;
  Rgb mean_, squares_;
};

class Renderer {
 public:
  Renderer(const Scene& scene, std::span<const Bsdf* const> bsdfs, const RenderSettings& settings)
      : settings_(settings),
        geometry_(scene),
        lights_(scene),
        tracer_(scene, geometry_, lights_, bsdfs),
        camera_(scene.camera, settings.width, settings.height) {
    result_.mean = Image(settings.width, settings.height);
    result_.variance = Image(settings.width, settings.height);
  }

  RenderResult run() {
    const auto body = [&](const tbb::blocked_range<int>& tiles) {
      for (int tile = tiles.begin(); tile < tiles.end(); ++tile) render_tile(tile);
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, tile_count(), 1), body, tbb::simple_partitioner());
    return std::move(result_);
  }

 private:
  int tiles_across() const { return (settings_.width + kTileSize - 1) / kTileSize; }
  int tile_count() const { return tiles_across() * ((settings_.height + kTileSize - 1) / kTileSize); }

  void render_tile(int tile) {
    const FlushDenormals flush;
    RenderStats stats;
    const int x0 = tile % tiles_across() * kTileSize, y0 = tile / tiles_across() * kTileSize;
    for (int y = y0; y < std::min(y0 + kTileSize, settings_.height); ++y)
      for (int x = x0; x < std::min(x0 + kTileSize, settings_.width); ++x) render_pixel(x, y, stats);
    report(stats);
  }

  void render_pixel(int x, int y, RenderStats& stats) {
    Rng rng(settings_.seed, static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(settings_.width) +
                                static_cast<std::uint64_t>(x));
    PixelStatistics pixel;
    PathCounts counts;
    for (int i = 0; i < settings_.spp; ++i) {
      const double dx = rng.uniform(), dy = rng.uniform();
      const Rgb sample = tracer_.radiance(camera_.ray(x + dx, y + dy), rng, counts);
      const bool good = is_finite(sample);
      pixel.add(good ? sample : Rgb());
      if (!good) ++stats.bad_samples;
    }
    stats.samples += static_cast<std::uint64_t>(settings_.spp);
    stats.rays += counts.rays;
    stats.vertices += counts.vertices;
    result_.mean.set(x, y, pixel.mean());
    result_.variance.set(x, y, pixel.variance_of_mean());
  }

  void report(const RenderStats& tile) {
    const std::lock_guard lock(mutex_);
    RenderStats& total = result_.stats;
    total.samples += tile.samples;
    total.rays += tile.rays;
    total.vertices += tile.vertices;
    total.bad_samples += tile.bad_samples;
    ++tiles_done_;
    if (settings_.progress) settings_.progress(static_cast<double>(tiles_done_) / tile_count());
  }

  const RenderSettings& settings_;
  EmbreeScene geometry_;
  Lights lights_;
  PathTracer tracer_;
  Camera camera_;
  RenderResult result_;
  std::mutex mutex_;
  int tiles_done_ = 0;
};

void require_range(const char* name, int value, int low, int high) {
  if (value < low || value > high)
    throw Error(fmt::format("render settings: {}: found {}; allowed: {} to {}", name, value, low, high));
}

RenderSettings complete(const Scene& scene, std::span<const Bsdf* const> bsdfs, RenderSettings settings) {
  if (settings.width == 0) settings.width = scene.render.width;
  if (settings.height == 0) settings.height = scene.render.height;
  if (settings.spp == 0) settings.spp = scene.render.spp;
  require_range("width", settings.width, 1, 16384);
  require_range("height", settings.height, 1, 16384);
  require_range("spp", settings.spp, 1, 1 << 24);
  require_range("threads", settings.threads, 0, 4096);
  if (bsdfs.size() != scene.materials.size())
    throw Error(fmt::format("render: found {} BSDFs; allowed: one for each of {} materials", bsdfs.size(),
                            scene.materials.size()));
  for (std::size_t i = 0; i < bsdfs.size(); ++i)
    if (!bsdfs[i]) throw Error(fmt::format("render: material \"{}\" has no BSDF", scene.materials[i].name));
  return settings;
}

RenderResult render_in_arena(const Scene& scene, std::span<const Bsdf* const> bsdfs,
                             const RenderSettings& settings) {
  const auto run = [&] { return Renderer(scene, bsdfs, settings).run(); };
  if (settings.threads == 0) return run();
  // The arena bounds the threads of this call; the control lets it have more than there are cores.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(settings.threads));
  tbb::task_arena arena(settings.threads);
  return arena.execute(run);
}

}  // namespace

RenderResult render(const Scene& scene, std::span<const Bsdf* const> bsdfs, const RenderSettings& settings) {
  const RenderSettings complete_settings = complete(scene, bsdfs, settings);
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu_start = std::clock();
  RenderResult result = render_in_arena(scene, bsdfs, complete_settings);

  RenderStats& stats = result.stats;
  stats.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  stats.cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  stats.samples_per_second = static_cast<double>(stats.samples) / std::max(stats.seconds, 1e-9);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  stats.peak_rss_mb = usage.ru_maxrss / 1024;  // kilobytes on Linux
  return result;
}

}  // namespace sunbeam
