#include "bake/cli/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "bake/base/version.h"
#include "bake/cli/console.h"
#include "runtime/tracer/image_io.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr const char* kSampleCount = "sample_count";
constexpr const char* kSeconds = "sunbeam.seconds";

// What must be the same for a picture to be continued.
std::map<std::string, std::string> identity(const PictureSource& source) {
  return {{"sunbeam.scene_hash", source.scene_hash},     {"sunbeam.material", source.material},
          {"sunbeam.estimator", source.estimators},      {"sunbeam.recipe_hash", source.table_hash},
          {"sunbeam.seed", std::to_string(source.seed)}, {"sunbeam.tool_version", kToolVersion}};
}

ExrImage as_exr(const RenderResult& picture, const PictureSource& source) {
  ExrImage exr{picture.mean, picture.variance, identity(source), {}, picture.window};
  exr.attributes["sunbeam.scene"] = source.scene;
  exr.attributes["sunbeam.spp"] =
      fmt::format("{:.0f}", *std::max_element(picture.sample_count.begin(), picture.sample_count.end()));
  exr.attributes[kSeconds] = fmt::format("{:12.3f}", picture.stats.seconds);
  exr.layers[kSampleCount] = picture.sample_count;
  if (!picture.first_hits) return exr;
  const FirstHits& first = *picture.first_hits;
  insert_layers(exr, "albedo", "RGB", first.albedo);
  insert_layers(exr, "normal", "XYZ", first.shading_normal);
  insert_layers(exr, "geometric_normal", "XYZ", first.geometric_normal);
  exr.layers["Z"] = first.depth;
  exr.layers["film_thickness_nm"] = first.film_thickness_nm;
  return exr;
}

// Says how much light the PNG shows that is not there, if it is more than rounding to bytes could hide.
void report_clipping(const std::string& png, const ClipAccount& account) {
  constexpr double kNegligible = 1e-4;
  if (account.luminance_added <= kNegligible * std::abs(account.luminance)) return;
  message(
      "{}: {} of {} pixels lie outside Rec.709 (lowest component {:.3g}); raising them to 0 added "
      "{:.2g} % of luminance. The .exr keeps their sign.",
      png, account.clipped, account.colors, account.lowest,
      100 * account.luminance_added / std::abs(account.luminance));
}

void require_same_source(const std::string& path, const ExrImage& exr, const PictureSource& source) {
  for (const auto& [name, value] : identity(source)) {
    const auto found = exr.attributes.find(name);
    if (found == exr.attributes.end())
      throw Error(fmt::format("{}: has no attribute {}; allowed: a picture of `sunbeam render`", path, name));
    if (found->second != value)
      throw Error(fmt::format("{}: cannot be continued: {} is '{}'; this render has '{}'", path, name,
                              found->second, value));
  }
  if (exr.variance.empty() || !exr.layers.contains(kSampleCount))
    throw Error(
        fmt::format("{}: has no variance or no {} layer; both are needed to go on", path, kSampleCount));
}

void require_sound(const std::string& path, const RenderResult& picture) {
  for (const float count : picture.sample_count)
    if (!(count >= 0 && count <= 0x1p24f && count == std::floor(count)))
      throw Error(fmt::format("{}: {} holds {:g}; allowed: whole numbers from 0", path, kSampleCount, count));
  for (const Image* image : {&picture.mean, &picture.variance})
    for (const float value : image->rgb)
      if (!std::isfinite(value))
        throw Error(fmt::format("{}: holds {}; allowed: finite values", path, value));
}

double seconds_of(const ExrImage& exr) {
  const auto found = exr.attributes.find(kSeconds);
  if (found == exr.attributes.end()) return 0;
  const std::string& text = found->second;
  double seconds = 0;
  const std::size_t start = std::min(text.find_first_not_of(' '), text.size());
  std::from_chars(text.data() + start, text.data() + text.size(), seconds);
  return seconds;
}

}  // namespace

std::string png_beside(const std::string& output) {
  return std::filesystem::path(output).replace_extension(".png").string();
}

void write_picture(const std::string& output, const RenderResult& picture, const PictureSource& source,
                   bool report) {
  write_exr(output, as_exr(picture, source));
  const std::string png = png_beside(output);
  const ClipAccount account = write_png(png, picture.mean);
  if (report) report_clipping(png, account);
}

RenderResult read_picture(const std::string& path, const PictureSource& source) {
  ExrImage exr = read_exr(path);
  require_same_source(path, exr, source);
  RenderResult picture;
  picture.window = *exr.window;
  picture.stats.seconds = seconds_of(exr);
  FirstHits first{extract_layers(exr, "albedo", "RGB"), extract_layers(exr, "normal", "XYZ"),
                  extract_layers(exr, "geometric_normal", "XYZ"), exr.layers["Z"],
                  exr.layers["film_thickness_nm"]};
  const bool complete = !first.albedo.empty() && !first.shading_normal.empty() &&
                        !first.geometric_normal.empty() && !first.depth.empty() &&
                        !first.film_thickness_nm.empty();
  if (complete) picture.first_hits = std::move(first);
  picture.sample_count = std::move(exr.layers[kSampleCount]);
  picture.mean = std::move(exr.mean);
  picture.variance = std::move(exr.variance);
  require_sound(path, picture);
  return picture;
}

}  // namespace sunbeam
