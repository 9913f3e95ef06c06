#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/interrupt.h"
#include "bake/cli/json_text.h"
#include "bake/cli/picture.h"
#include "bake/cli/progress.h"
#include "bake/cli/separate_files.h"
#include "bake/scene/materials.h"
#include "runtime/config/config.h"
#include "runtime/tracer/render.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/hash.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct ImageSize {
  int width = 0, height = 0;  // 0: as the scene says
};

ImageSize parse_size(const std::string& text) {
  ImageSize size;
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool has_x = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = has_x ? std::from_chars(width.ptr + 1, end, size.height) : width;
  constexpr int kLargest = 16384;
  if (!has_x || height.ec != std::errc() || height.ptr != end || size.width < 1 || size.height < 1 ||
      size.width > kLargest || size.height > kLargest)
    throw Error(fmt::format("--size: found '{}'; allowed: WIDTHxHEIGHT, each 1 to {}", text, kLargest));
  return size;
}

// X0,Y0,X1,Y1; the size of the whole picture is filled in by render().
PixelWindow parse_crop(const std::string& text) {
  PixelWindow crop;
  const char *at = text.data(), *end = at + text.size();
  const auto read = [&](int& number, bool is_last) {
    const auto result = std::from_chars(at, end, number);
    const bool ends_well = is_last ? result.ptr == end : result.ptr != end && *result.ptr == ',';
    if (result.ec != std::errc() || !ends_well)
      throw Error(
          fmt::format("--crop: found '{}'; allowed: X0,Y0,X1,Y1 in pixels from the top left corner", text));
    at = result.ptr + (is_last ? 0 : 1);
  };
  read(crop.x0, false);
  read(crop.y0, false);
  read(crop.x1, false);
  read(crop.y1, true);
  return crop;
}

// "90", "90s", "1.5m", "500ms", "2h".
double parse_seconds(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, value);
  const std::string unit(number.ptr, end);
  const double scale = unit.empty() || unit == "s" ? 1
                       : unit == "ms"              ? 1e-3
                       : unit == "m"               ? 60
                       : unit == "h"               ? 3600
                                                   : 0;
  constexpr double kLongest = 1e9;
  if (number.ec != std::errc() || scale == 0 || !(value > 0 && scale * value <= kLongest))
    throw Error(fmt::format(
        "--time: found '{}'; allowed: a number above 0 with s, ms, m or h, such as 10s, up to {:g} s", text,
        kLongest));
  return scale * value;
}

// The scene file's own content but for the number of samples, which a continued picture may raise.
std::string scene_hash(const std::string& text, const std::string& path, std::vector<std::string> overrides) {
  overrides.push_back("render.spp=1");
  return content_hash(ConfigTable::parse(text, path, overrides).canonical_text());
}

// The picture may be the one to go on from.
void require_separate_outputs(const RenderOptions& options, const Scene& scene) {
  const std::string png = png_beside(options.output);
  std::vector<std::string> inputs = scene.files;
  inputs.insert(inputs.end(), {options.scene, options.table});
  require_separate(inputs, {options.output, png, options.stats});
  require_separate({options.resume}, {png, options.stats});
}

// A bar on stderr, the picture so far on disk every few seconds, and Ctrl-C.
class Monitor {
 public:
  Monitor(const RenderOptions& options, const PictureSource& source) : options_(options), source_(source) {}

  // False stops.
  bool operator()(const RenderResult& so_far) {
    progress_.show(so_far.stats.fraction, static_cast<double>(so_far.stats.samples));
    if (options_.watch_seconds > 0 && seconds_since(written_) >= wait_) write(so_far);
    return !interrupt_.requested();
  }

 private:
  // The first picture comes early; and writing takes a tenth of the time at most.
  void write(const RenderResult& so_far) {
    const Clock::time_point start = Clock::now();
    write_picture(options_.output, so_far, source_, false);
    wait_ = std::max(options_.watch_seconds, 10 * seconds_since(start));
    written_ = Clock::now();
  }

  static constexpr double kFirstPicture = 0.3;

  const RenderOptions& options_;
  const PictureSource& source_;
  Interrupt interrupt_;
  Progress progress_{"render", "samples", 0};
  Clock::time_point written_ = Clock::now();
  double wait_ = kFirstPicture;
};

std::string stats_json(const RenderStats& s, const std::string& estimators) {
  nlohmann::ordered_json json;
  json["seconds"] = s.seconds;
  json["cpu_seconds"] = s.cpu_seconds;
  json["build_cpu_seconds"] = s.build_cpu_seconds;
  json["samples"] = s.samples;
  json["rays"] = s.rays;
  json["vertices"] = s.vertices;
  json["samples_per_second"] = s.samples_per_second;
  json["peak_rss_mb"] = s.peak_rss_mb;
  json["bad_samples"] = s.bad_samples;
  if (!estimators.empty()) json["estimator"] = estimators;
  return json_text(json) + "\n";
}

RenderSettings read_settings(const RenderOptions& options) {
  RenderSettings settings;
  if (options.size) {
    const ImageSize size = parse_size(*options.size);
    settings.width = size.width;
    settings.height = size.height;
  }
  settings.spp = options.samples_per_pixel;
  settings.threads = options.threads;
  settings.seed = options.seed;
  settings.noise = options.noise;
  settings.first_hits = options.aovs;
  if (options.crop) settings.crop = parse_crop(*options.crop);
  if (options.time) settings.seconds = parse_seconds(*options.time);
  constexpr int kMost = 1 << 24, kMostForNoise = 1 << 16;
  if (settings.spp == 0 && (settings.seconds > 0 || settings.noise > 0))
    settings.spp = settings.seconds > 0 ? kMost : kMostForNoise;
  return settings;
}

void require_sound(const RenderOptions& options) {
  if (extension(options.output) != ".exr")
    throw Error(options.output + ": extension is '" + extension(options.output) +
                "'; allowed for an image: .exr");
  if (options.estimator != "auto" && options.material != "live")
    throw Error("--estimator: found '" + options.estimator + "' with --material " + options.material +
                "; allowed with --material live");
}

RenderResult render_named(const std::string& path, const Scene& scene, const SceneMaterials& materials,
                          const RenderSettings& settings) {
  try {
    return render(scene, materials.bsdfs(), settings);
  } catch (const Error& error) {
    throw Error(path + ": " + error.what());
  }
}

}  // namespace

int run_render(const RenderOptions& options) {
  const Clock::time_point start = Clock::now();
  require_sound(options);
  RenderSettings settings = read_settings(options);
  const std::string scene_text = read_text(options.scene);
  Scene scene = read_scene(ConfigTable::parse(scene_text, options.scene, options.overrides));
  for (const std::string& warning : scene.warnings) message("warning: {}", warning);
  require_separate_outputs(options, scene);
  if (!options.table.empty()) scene.table = options.table;
  const SceneMaterials materials(scene, options.scene, options.material, estimator_of(options.estimator));
  for (const std::string& warning : materials.warnings()) message("warning: {}", warning);
  for (const auto& path : {options.output, png_beside(options.output)}) require_writable(path);
  if (!options.stats.empty()) require_writable(options.stats);

  const PictureSource source{.scene = options.scene,
                             .scene_hash = scene_hash(scene_text, options.scene, options.overrides),
                             .material = options.material,
                             .estimators = materials.estimators(),
                             .table_hash = materials.table_hash(),
                             .seed = options.seed};
  std::optional<RenderResult> earlier;
  if (!options.resume.empty()) {
    earlier = read_picture(options.resume, source);
    settings.resume = &*earlier;
  }
  if (settings.seconds > 0) settings.seconds = std::max(1e-3, settings.seconds - seconds_since(start));
  Monitor monitor(options, source);
  settings.monitor = std::ref(monitor);
  RenderResult result = render_named(options.scene, scene, materials, settings);
  if (earlier) result.stats.seconds += earlier->stats.seconds;

  write_picture(options.output, result, source, true);
  if (!options.stats.empty())
    write_file_atomically(options.stats, stats_json(result.stats, materials.estimators()));
  if (result.stats.bad_samples > 0)
    message("warning: {} samples were not finite, or beyond 1e18, and count as black",
            result.stats.bad_samples);
  if (!materials.estimators().empty()) message("estimator: {}", materials.estimators());
  message("{} and {}: {:.2f} s, {:.3g} samples/s", options.output, png_beside(options.output),
          result.stats.seconds, result.stats.samples_per_second);
  if (!result.stats.stopped) return 0;
  message("stopped at {:.0f} %; go on with --resume {}", 100 * result.stats.fraction, options.output);
  return 130;  // as a shell tells an interrupted command
}

}  // namespace sunbeam
