#include "runtime/tracer/render.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <bit>
#include <chrono>
#include <ctime>
#include <mutex>

#include "runtime/tracer/camera.h"
#include "runtime/tracer/embree_scene.h"
#include "runtime/tracer/flush_denormals.h"
#include "runtime/tracer/lights.h"
#include "runtime/tracer/path.h"
#include "runtime/tracer/pixel_sums.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr int kTileSize = 8;              // also the blocks of RenderSettings::noise
constexpr std::uint32_t kFirstLook = 16;  // samples a pixel before its noise is judged
constexpr double kPassSeconds = 0.5;      // between two looks at the limits
constexpr double kMostRadiance = 1e18;    // of a sample: pictures hold its square as a float
constexpr double kDarkShare = 0.1;        // of the picture's brightness: darker blocks count as that bright
constexpr int kPixelBits = 28;            // a stream holds the pixel below, the sample above

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}
double cpu_seconds_since(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

bool fits_a_picture(const Rgb& c) {
  return is_finite(c) && std::abs(c.r) <= kMostRadiance && std::abs(c.g) <= kMostRadiance &&
         std::abs(c.b) <= kMostRadiance;
}

struct HitSums {
  double count = 0, on_surface = 0;
  Rgb albedo;
  Vec3 shading_normal, geometric_normal;
  double depth = 0, film_thickness_nm = 0;

  void add(const FirstHit& hit) {
    count += 1;
    if (!hit.on_surface) return;
    on_surface += 1;
    if (fits_a_picture(hit.albedo)) albedo += hit.albedo;
    shading_normal = shading_normal + hit.shading_normal;
    geometric_normal = geometric_normal + hit.geometric_normal;
    depth += hit.depth;
    film_thickness_nm += hit.film_thickness_nm;
  }
};

Rgb as_rgb(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 as_vec3(const Rgb& c) { return {c.r, c.g, c.b}; }

// Refuses a camera that sees nothing but the back of one object, whichever way it looks.
void require_outside(const EmbreeScene& geometry, const Vec3& position) {
  int object = -1;
  for (const Vec3& towards : {Vec3{1, 0.1, 0.2}, Vec3{-1, 0.2, 0.1}, Vec3{0.1, 1, 0.2}, Vec3{0.2, -1, 0.1},
                              Vec3{0.1, 0.2, 1}, Vec3{0.2, 0.1, -1}, Vec3{1, 1, 1}, Vec3{-1, -1, -1}}) {
    const auto hit = geometry.intersect({position, normalize(towards)});
    if (!hit || hit->object < 0 || dot(hit->geometric_normal, towards) <= 0) return;
    if (object >= 0 && hit->object != object) return;
    object = hit->object;
  }
  throw Error(fmt::format(
      "camera: position lies inside object {} (counted from 1); allowed: outside, or inside = true",
      object + 1));
}

bool is_isotropic(const SurfaceBsdf& bsdf) { return bsdf.uniform && bsdf.uniform->is_isotropic(); }

class Renderer {
 public:
  Renderer(const Scene& scene, std::span<const SurfaceBsdf> bsdfs, const RenderSettings& settings,
           const PixelWindow& window, Clock::time_point start)
      : settings_(settings),
        window_(window),
        start_(start),
        geometry_(scene, [&](std::size_t i) { return is_isotropic(bsdfs[i]); }),
        lights_(scene),
        tracer_(scene, geometry_, lights_, bsdfs),
        camera_(scene.camera, window.width, window.height),
        pixels_(pixel_count()),
        tile_done_(static_cast<std::size_t>(tile_count())) {
    if (!scene.camera.inside) require_outside(geometry_, scene.camera.position);
    result_.window = window;
    result_.mean = result_.variance = Image(window.columns(), window.rows());
    result_.sample_count.resize(pixel_count());
    if (settings.first_hits) prepare_first_hits();
    if (settings.resume) take_over(*settings.resume);
  }

  RenderResult run() {
    while (!is_finished()) {
      choose_next_target();
      run_pass();
      if (settings_.noise > 0 && is_look(target_)) judge_noise();
    }
    for (int tile = 0; tile < tile_count(); ++tile) publish(tile);
    result_.stats.fraction = stopped_ ? fraction() : 1;
    result_.stats.stopped = stopped_;
    return std::move(result_);
  }

 private:
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(window_.columns()) * static_cast<std::size_t>(window_.rows());
  }
  int tiles_across() const { return (window_.columns() + kTileSize - 1) / kTileSize; }
  int tiles_down() const { return (window_.rows() + kTileSize - 1) / kTileSize; }
  int tile_count() const { return tiles_across() * tiles_down(); }
  static bool is_look(std::uint32_t count) { return count >= kFirstLook && std::has_single_bit(count); }

  void prepare_first_hits() {
    hits_.resize(pixel_count());
    const Image black(window_.columns(), window_.rows());
    result_.first_hits =
        FirstHits{black, black, black, std::vector<float>(pixel_count()), std::vector<float>(pixel_count())};
  }

  void take_over(const RenderResult& earlier) {
    for (std::size_t i = 0; i < pixel_count(); ++i) {
      const auto count = static_cast<std::uint32_t>(earlier.sample_count[i]);
      pixels_[i] = PixelSums(count, earlier.mean.at(i), earlier.variance.at(i));
      if (earlier.first_hits && settings_.first_hits) take_over(*earlier.first_hits, i, count);
    }
    for (int tile = 0; tile < tile_count(); ++tile) publish(tile);
  }

  // How many samples met a surface is not kept: all, or none.
  void take_over(const FirstHits& earlier, std::size_t i, double count) {
    HitSums& sums = hits_[i];
    sums.count = count;
    sums.on_surface = earlier.depth[i] > 0 ? count : 0;
    sums.albedo = earlier.albedo.at(i) * count;
    sums.shading_normal = count * as_vec3(earlier.shading_normal.at(i));
    sums.geometric_normal = count * as_vec3(earlier.geometric_normal.at(i));
    sums.depth = earlier.depth[i] * sums.on_surface;
    sums.film_thickness_nm = earlier.film_thickness_nm[i] * sums.on_surface;
  }

  bool is_time_up() const { return settings_.seconds > 0 && seconds_since(start_) >= settings_.seconds; }
  bool is_finished() const {
    return stopped_ || target_ >= static_cast<std::uint32_t>(settings_.spp) ||
           (target_ > 0 && is_time_up()) ||
           std::all_of(tile_done_.begin(), tile_done_.end(), [](char done) { return done != 0; });
  }

  // One sample a pixel first; then as many as kPassSeconds allow, but never past a look at the noise.
  void choose_next_target() {
    const double affordable = pass_seconds_ > 0 ? kPassSeconds * last_step_ / pass_seconds_ : 1;
    const auto limit = static_cast<std::uint32_t>(settings_.spp);
    std::uint32_t next = target_ + static_cast<std::uint32_t>(std::clamp(affordable, 1.0, 1e6));
    if (settings_.noise > 0) next = std::min(next, std::max(kFirstLook, std::bit_ceil(target_ + 1)));
    next = std::min(next, limit);
    last_step_ = next - target_;
    target_ = next;
  }

  void run_pass() {
    const Clock::time_point start = Clock::now();
    const bool may_run_out = target_ > 1;
    const auto body = [&](const tbb::blocked_range<int>& tiles) {
      for (int tile = tiles.begin(); tile < tiles.end(); ++tile) {
        if (stopped_ || tile_done_[static_cast<std::size_t>(tile)] || (may_run_out && is_time_up())) continue;
        render_tile(tile);
      }
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, tile_count(), 1), body, tbb::simple_partitioner());
    pass_seconds_ = seconds_since(start);
  }

  template <class Visit>
  void for_each_pixel(int tile, Visit visit) const {
    const int x0 = tile % tiles_across() * kTileSize, y0 = tile / tiles_across() * kTileSize;
    for (int y = y0; y < std::min(y0 + kTileSize, window_.rows()); ++y)
      for (int x = x0; x < std::min(x0 + kTileSize, window_.columns()); ++x)
        visit(x, y,
              static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.columns()) +
                  static_cast<std::size_t>(x));
  }

  void render_tile(int tile) {
    const FlushDenormals flush;
    RenderStats stats;
    for_each_pixel(
        tile, [&](int x, int y, std::size_t i) { render_pixel(window_.x0 + x, window_.y0 + y, i, stats); });
    report(tile, stats);
  }

  // x and y in the whole picture, i in the window.
  void render_pixel(int x, int y, std::size_t i, RenderStats& stats) {
    const std::uint64_t pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(window_.width) +
                                static_cast<std::uint64_t>(x);
    PixelSums sums = pixels_[i];  // a copy stays in registers
    HitSums hits = hits_.empty() ? HitSums() : hits_[i];
    FirstHit first;
    PathCounts counts;
    while (sums.count() < target_) {
      Sampler sampler(settings_.seed, pixel | std::uint64_t{sums.count()} << kPixelBits);
      const Point2 in_pixel = sampler.next2(), on_lens = sampler.next2();
      if (!hits_.empty()) first = {};
      const Rgb sample = tracer_.radiance(camera_.ray(x + in_pixel.x, y + in_pixel.y, on_lens), sampler,
                                          counts, hits_.empty() ? nullptr : &first);
      const bool good = fits_a_picture(sample);
      sums.add(good ? sample : Rgb());
      if (!hits_.empty()) hits.add(first);
      if (!good) ++stats.bad_samples;
      ++stats.samples;
    }
    pixels_[i] = sums;
    if (!hits_.empty()) hits_[i] = hits;
    stats.rays += counts.rays;
    stats.vertices += counts.vertices;
  }

  void publish(int tile) {
    for_each_pixel(tile, [&](int x, int y, std::size_t i) {
      result_.mean.set(x, y, pixels_[i].mean());
      result_.variance.set(x, y, pixels_[i].variance_of_mean());
      result_.sample_count[i] = static_cast<float>(pixels_[i].count());
      if (!hits_.empty()) publish_first_hits(*result_.first_hits, x, y, i);
    });
  }

  void publish_first_hits(FirstHits& published, int x, int y, std::size_t i) const {
    const HitSums& sums = hits_[i];
    const double all = 1 / std::max(sums.count, 1.0), met = 1 / std::max(sums.on_surface, 1.0);
    published.albedo.set(x, y, sums.albedo * all);
    published.shading_normal.set(x, y, as_rgb(all * sums.shading_normal));
    published.geometric_normal.set(x, y, as_rgb(all * sums.geometric_normal));
    published.depth[i] = static_cast<float>(met * sums.depth);
    published.film_thickness_nm[i] = static_cast<float>(met * sums.film_thickness_nm);
  }

  void report(int tile, const RenderStats& stats) {
    const std::lock_guard lock(mutex_);
    if (settings_.monitor) publish(tile);
    RenderStats& total = result_.stats;
    total.samples += stats.samples;
    total.rays += stats.rays;
    total.vertices += stats.vertices;
    total.bad_samples += stats.bad_samples;
    if (!settings_.monitor || stopped_) return;
    total.seconds = seconds_since(start_);
    total.fraction = fraction();
    if (!settings_.monitor(result_)) stopped_ = true;
  }

  double fraction() const {
    const double planned = static_cast<double>(pixel_count()) * settings_.spp;
    const double by_samples = static_cast<double>(result_.stats.samples) / planned;
    const double by_time = settings_.seconds > 0 ? seconds_since(start_) / settings_.seconds : 0;
    const double by_noise =
        static_cast<double>(std::count(tile_done_.begin(), tile_done_.end(), 1)) / tile_count();
    return std::min(1.0, std::max({by_samples, by_time, by_noise}));
  }

  // A tile is done when it and its neighbours are quiet: a rare bright path next door is a warning.
  void judge_noise() {
    double brightness = 0;
    for (const PixelSums& pixel : pixels_) brightness += mean(pixel.mean());
    const double dark = kDarkShare * brightness / static_cast<double>(pixel_count());
    std::vector<char> quiet(tile_done_.size());
    for (int tile = 0; tile < tile_count(); ++tile)
      quiet[static_cast<std::size_t>(tile)] = noise_of(tile, dark) <= settings_.noise;
    for (int y = 0; y < tiles_down(); ++y)
      for (int x = 0; x < tiles_across(); ++x) {
        bool done = true;
        for (int j = std::max(0, y - 1); j <= std::min(tiles_down() - 1, y + 1); ++j)
          for (int i = std::max(0, x - 1); i <= std::min(tiles_across() - 1, x + 1); ++i)
            done = done && quiet[static_cast<std::size_t>(j * tiles_across() + i)];
        tile_done_[static_cast<std::size_t>(y * tiles_across() + x)] = done;
      }
  }

  double noise_of(int tile, double dark) const {
    double variance = 0, brightness = 0, count = 0;
    for_each_pixel(tile, [&](int, int, std::size_t i) {
      variance += mean(pixels_[i].variance_of_mean());
      brightness += mean(pixels_[i].mean());
      count += 1;
    });
    const double reference = std::max(brightness / count, dark);
    return reference > 0 ? std::sqrt(variance / count) / reference : 0;
  }

  const RenderSettings& settings_;
  PixelWindow window_;
  Clock::time_point start_;
  EmbreeScene geometry_;
  Lights lights_;
  PathTracer tracer_;
  Camera camera_;
  std::vector<PixelSums> pixels_;
  std::vector<HitSums> hits_;    // empty if nobody asked
  std::vector<char> tile_done_;  // quiet enough
  std::uint32_t target_ = 0;     // samples a pixel at the end of this pass
  double last_step_ = 0, pass_seconds_ = 0;
  std::atomic<bool> stopped_ = false;
  RenderResult result_;
  std::mutex mutex_;
};

void require_range(const char* name, int value, int low, int high) {
  if (value < low || value > high)
    throw Error(fmt::format("render settings: {}: found {}; allowed: {} to {}", name, value, low, high));
}

RenderSettings complete(const Scene& scene, std::span<const SurfaceBsdf> bsdfs, RenderSettings settings) {
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
    if (!bsdfs[i].uniform && !bsdfs[i].varying)
      throw Error(fmt::format("render: material \"{}\" has no BSDF", scene.materials[i].name));
  return settings;
}

PixelWindow window_of(const RenderSettings& settings) {
  PixelWindow window = settings.crop.value_or(PixelWindow::whole(settings.width, settings.height));
  window.width = settings.width;
  window.height = settings.height;
  const bool inside = 0 <= window.x0 && window.x0 < window.x1 && window.x1 <= window.width &&
                      0 <= window.y0 && window.y0 < window.y1 && window.y1 <= window.height;
  if (!inside)
    throw Error(
        fmt::format("render settings: crop: found x {} to {}, y {} to {}; allowed: 0 to {} and 0 to {}, "
                    "each rising",
                    window.x0, window.x1, window.y0, window.y1, window.width, window.height));
  if (settings.resume && settings.resume->window != window)
    throw Error("render settings: resume: the earlier picture covers other pixels; allowed: the same window");
  return window;
}

RenderResult render_in_arena(const Scene& scene, std::span<const SurfaceBsdf> bsdfs,
                             const RenderSettings& settings, Clock::time_point start) {
  const PixelWindow window = window_of(settings);
  const auto run = [&] {
    const std::clock_t cpu_start = std::clock();
    Renderer renderer(scene, bsdfs, settings, window, start);
    const double build_cpu_seconds = cpu_seconds_since(cpu_start);
    RenderResult result = renderer.run();
    result.stats.build_cpu_seconds = build_cpu_seconds;
    return result;
  };
  if (settings.threads == 0) return run();
  // The arena bounds the threads of this call; the control lets it have more than there are cores.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(settings.threads));
  tbb::task_arena arena(settings.threads);
  return arena.execute(run);
}

}  // namespace

RenderResult render(const Scene& scene, std::span<const SurfaceBsdf> bsdfs, const RenderSettings& settings) {
  const Clock::time_point start = Clock::now();
  const std::clock_t cpu_start = std::clock();
  RenderResult result = render_in_arena(scene, bsdfs, complete(scene, bsdfs, settings), start);

  RenderStats& stats = result.stats;
  stats.seconds = seconds_since(start);
  stats.cpu_seconds = cpu_seconds_since(cpu_start);
  stats.samples_per_second = static_cast<double>(stats.samples) / std::max(stats.seconds, 1e-9);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  stats.peak_rss_mb = usage.ru_maxrss / 1024;  // kilobytes on Linux
  return result;
}

}  // namespace sunbeam
