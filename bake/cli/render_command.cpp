#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "bake/cli/commands.h"
#include "bake/cli/progress.h"
#include "bake/estimator.h"
#include "bake/live/exact_bsdf.h"
#include "bake/live/live_bsdf.h"
#include "bake/recipe.h"
#include "bake/version.h"
#include "runtime/tracer/image_io.h"
#include "runtime/tracer/render.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/color_converted_bsdf.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/file.h"
#include "sunbeam/lambert.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

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

Table load_scene_table(const Scene& scene, const std::string& scene_path) {
  if (scene.table.empty()) throw Error(scene_path + ": key 'table' is missing; --material live needs none");
  if (!std::filesystem::exists(scene.table))
    throw Error(fmt::format("{}: the scene's table {} does not exist; bake it: sunbeam bake {} -o {}",
                            scene_path, scene.table, scene.recipe.empty() ? "RECIPE" : scene.recipe,
                            scene.table));
  return load_table(scene.table);
}

// A skin's own values over those of the recipe or table.
Material skin_material(const SceneMaterial& skin, Material material) {
  material.film_thickness_nm = skin.film_thickness_nm.value_or(material.film_thickness_nm);
  material.base_ior = skin.base_ior.value_or(material.base_ior);
  material.absorption_per_nm = skin.absorption_per_nm.value_or(material.absorption_per_nm);
  return material;
}

std::unique_ptr<Bsdf> table_skin(const Table& table, const SceneMaterial& skin,
                                 const std::string& scene_path) {
  try {
    return std::make_unique<TableBsdf>(table, Parameters::of(skin_material(skin, table.material)),
                                       OutsideGrid::refuse);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: material '{}': {}", scene_path, skin.name, error.what()));
  }
}

std::unique_ptr<Bsdf> live_skin(const Material& material, const Spectrum& spectrum, Estimator estimator) {
  const Wavelengths wavelengths = spectrum.wavelengths(material);
  if (estimator == Estimator::exact) return std::make_unique<ExactBsdf>(material, wavelengths);
  return std::make_unique<LiveBsdf>(material, wavelengths, technique_of(estimator));
}

// One BSDF for each material of the scene.
class Materials {
 public:
  Materials(const Scene& scene, const std::string& scene_path, const std::string& mode, Estimator estimator) {
    std::optional<Table> table;
    std::optional<Recipe> recipe;
    for (const SceneMaterial& m : scene.materials) {
      if (m.type == SceneMaterial::Type::diffuse) {
        add(std::make_unique<Lambert>(m.albedo));
      } else if (mode == "diffuse") {
        add(std::make_unique<Lambert>(scene.diffuse_albedo));
      } else if (mode == "live") {
        if (scene.recipe.empty())
          throw Error(scene_path + ": key 'recipe' is missing; --material live needs it");
        if (!recipe) recipe = load_recipe(scene.recipe);
        add_live(skin_material(m, recipe->material), recipe->spectrum, estimator,
                 scene_path + ": material '" + m.name + "': ");
      } else {
        if (!table) table = load_scene_table(scene, scene_path);
        add_skin(table_skin(*table, m, scene_path), table->color_space());
      }
    }
    if (table) table_hash_ = table->info.at("recipe_hash");
  }

  std::span<const Bsdf* const> bsdfs() const { return pointers_; }
  const std::string& table_hash() const { return table_hash_; }
  // The live skins' evaluators, by name; empty if there are none.
  std::string estimators() const { return fmt::format("{}", fmt::join(estimators_, ", ")); }

 private:
  void add_live(const Material& material, const Spectrum& spectrum, Estimator wanted,
                const std::string& where) {
    try {
      const Estimator estimator = estimator_for_render(wanted, material);
      add_skin(live_skin(material, spectrum, estimator), spectrum.color_space());
      estimators_.insert(name_of(estimator));
    } catch (const Error& error) {
      throw Error(where + error.what());
    }
  }
  void add(std::unique_ptr<Bsdf> bsdf) {
    pointers_.push_back(bsdf.get());
    owned_.push_back(std::move(bsdf));
  }

  // The tracer works in linear Rec.709.
  void add_skin(std::unique_ptr<Bsdf> bsdf, ColorSpace space) {
    if (space != ColorSpace::rec709)
      bsdf = std::make_unique<ColorConvertedBsdf>(std::move(bsdf), space, ColorSpace::rec709);
    add(std::move(bsdf));
  }

  std::vector<std::unique_ptr<Bsdf>> owned_;
  std::vector<const Bsdf*> pointers_;
  std::string table_hash_;
  std::set<std::string> estimators_;
};

std::string stats_json(const RenderStats& s, const std::string& estimators) {
  nlohmann::ordered_json json;
  json["seconds"] = s.seconds;
  json["cpu_seconds"] = s.cpu_seconds;
  json["samples"] = s.samples;
  json["rays"] = s.rays;
  json["vertices"] = s.vertices;
  json["samples_per_second"] = s.samples_per_second;
  json["peak_rss_mb"] = s.peak_rss_mb;
  json["bad_samples"] = s.bad_samples;
  if (!estimators.empty()) json["estimator"] = estimators;
  return json.dump(2) + "\n";
}

// Says how much light the PNG shows that is not there, if it is more than rounding to bytes could hide.
void report_clipping(const std::string& png, const ClipAccount& account) {
  constexpr double kNegligible = 1e-4;
  if (account.luminance_added <= kNegligible * std::abs(account.luminance)) return;
  fmt::print(stderr,
             "{}: {} of {} pixels lie outside Rec.709 (lowest component {:.3g}); raising them to 0 added "
             "{:.2g} % of "
             "luminance. The .exr keeps their sign.\n",
             png, account.clipped, account.colors, account.lowest,
             100 * account.luminance_added / std::abs(account.luminance));
}

}  // namespace

int run_render(const RenderOptions& options) {
  if (extension(options.output) != ".exr")
    throw Error(options.output + ": extension is '" + extension(options.output) +
                "'; allowed for an image: .exr");
  RenderSettings settings;
  if (options.size) {
    const ImageSize size = parse_size(*options.size);
    settings.width = size.width;
    settings.height = size.height;
  }
  Scene scene = load_scene(options.scene);
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "warning: {}\n", warning);
  if (!options.table.empty()) scene.table = options.table;
  if (options.estimator != "auto" && options.material != "live")
    throw Error("--estimator: found '" + options.estimator + "' with --material " + options.material +
                "; allowed with --material live");
  const Materials materials(scene, options.scene, options.material, estimator_of(options.estimator));
  const std::string png = std::filesystem::path(options.output).replace_extension(".png").string();
  for (const auto& path : {options.output, png}) require_writable(path);
  if (!options.stats.empty()) require_writable(options.stats);

  settings.spp = options.samples_per_pixel;
  settings.threads = options.threads;
  settings.seed = options.seed;
  settings.progress = Progress("render", "%", 100);
  const RenderResult result = render(scene, materials.bsdfs(), settings);

  write_exr(options.output, {result.mean,
                             result.variance,
                             {{"sunbeam.scene", options.scene},
                              {"sunbeam.material", options.material},
                              {"sunbeam.estimator", materials.estimators()},
                              {"sunbeam.recipe_hash", materials.table_hash()},
                              {"sunbeam.seed", std::to_string(options.seed)},
                              {"sunbeam.tool_version", kToolVersion}}});
  report_clipping(png, write_png(png, result.mean));
  if (!options.stats.empty())
    write_file_atomically(options.stats, stats_json(result.stats, materials.estimators()));
  if (result.stats.bad_samples > 0)
    fmt::print(stderr, "warning: {} samples were not finite and count as black\n", result.stats.bad_samples);
  if (!materials.estimators().empty()) fmt::print(stderr, "estimator: {}\n", materials.estimators());
  fmt::print(stderr, "{} and {}: {:.2f} s, {:.3g} samples/s\n", options.output, png, result.stats.seconds,
             result.stats.samples_per_second);
  return 0;
}

}  // namespace sunbeam
