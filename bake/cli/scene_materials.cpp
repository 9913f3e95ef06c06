#include "bake/cli/scene_materials.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>

#include "bake/live/exact_bsdf.h"
#include "bake/live/live_bsdf.h"
#include "bake/recipe.h"
#include "sunbeam/color_converted_bsdf.h"
#include "sunbeam/core/error.h"
#include "sunbeam/lambert.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

Table load_scene_table(const Scene& scene, const std::string& scene_path) {
  if (scene.table.empty()) throw Error(scene_path + ": key 'table' is missing; --material live needs none");
  if (!std::filesystem::exists(scene.table))
    throw Error(fmt::format("{}: the scene's table {} does not exist; bake it: sunbeam bake {} -o {}",
                            scene_path, scene.table, scene.recipe.empty() ? "RECIPE" : scene.recipe,
                            scene.table));
  return load_table(scene.table);
}

// A skin's own values over those of the recipe or table; where it has none it takes theirs.
Material complete(SceneMaterial& skin, Material material) {
  const auto settle = [](std::optional<double>& own, double& value) {
    value = own.value_or(value);
    own = value;
  };
  settle(skin.film_thickness_nm, material.film_thickness_nm);
  settle(skin.base_ior, material.base_ior);
  settle(skin.absorption_per_nm, material.absorption_per_nm);
  return material;
}

std::unique_ptr<Bsdf> table_skin(const Table& table, SceneMaterial& skin, const std::string& scene_path) {
  try {
    return std::make_unique<TableBsdf>(table, Parameters::of(complete(skin, table.material)),
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

}  // namespace

SceneMaterials::SceneMaterials(Scene& scene, const std::string& scene_path, const std::string& mode,
                               Estimator estimator) {
  std::optional<Table> table;
  std::optional<Recipe> recipe;
  for (SceneMaterial& m : scene.materials) {
    if (m.type == SceneMaterial::Type::diffuse) {
      add(std::make_unique<Lambert>(m.albedo));
    } else if (mode == "diffuse") {
      add(std::make_unique<Lambert>(scene.diffuse_albedo));
    } else if (mode == "live") {
      if (scene.recipe.empty())
        throw Error(scene_path + ": key 'recipe' is missing; --material live needs it");
      if (!recipe) recipe = load_recipe(scene.recipe);
      add_live(complete(m, recipe->material), recipe->spectrum, estimator,
               scene_path + ": material '" + m.name + "': ");
    } else {
      if (!table) table = load_scene_table(scene, scene_path);
      add_skin(table_skin(*table, m, scene_path), table->color_space());
    }
  }
  if (table) table_hash_ = table->info.at("recipe_hash");
}

std::string SceneMaterials::estimators() const { return fmt::format("{}", fmt::join(estimators_, ", ")); }

void SceneMaterials::add_live(const Material& material, const Spectrum& spectrum, Estimator wanted,
                              const std::string& where) {
  try {
    const Estimator estimator = estimator_for_render(wanted, material);
    add_skin(live_skin(material, spectrum, estimator), spectrum.color_space());
    estimators_.insert(name_of(estimator));
  } catch (const Error& error) {
    throw Error(where + error.what());
  }
}

void SceneMaterials::add(std::unique_ptr<Bsdf> bsdf) {
  pointers_.push_back(bsdf.get());
  owned_.push_back(std::move(bsdf));
}

void SceneMaterials::add_skin(std::unique_ptr<Bsdf> bsdf, ColorSpace space) {
  if (space != ColorSpace::rec709)
    bsdf = std::make_unique<ColorConvertedBsdf>(std::move(bsdf), space, ColorSpace::rec709);
  add(std::move(bsdf));
}

}  // namespace sunbeam
