#include "bake/scene/materials.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>

#include "bake/live/exact/exact_bsdf.h"
#include "bake/live/live_bsdf.h"
#include "runtime/tracer/gloss.h"
#include "runtime/tracer/lambert.h"
#include "sunbeam/color_converted_bsdf.h"
#include "sunbeam/core/error.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_vdb.h"
#include "sunbeam/textured_table.h"

namespace sunbeam {
namespace {

constexpr BindOptions kInRec709 = {.color_space = ColorSpace::rec709};

Table load_scene_table(const Scene& scene, const std::string& scene_path) {
  if (scene.table.empty()) throw Error(scene_path + ": key 'table' is missing; --material live needs none");
  if (!std::filesystem::exists(scene.table))
    throw Error(fmt::format("{}: the scene's table {} does not exist; bake it: sunbeam bake {} -o {}",
                            scene_path, scene.table, scene.recipe.empty() ? "RECIPE" : scene.recipe,
                            scene.table));
  return load_table(scene.table);
}

// A skin's own parameters over those of the recipe or table; where it has none it takes theirs.
void complete(SceneMaterial& skin, const Material& material) {
  const auto defaults = Parameters::of(material).values();
  for (std::size_t k = 0; k < defaults.size(); ++k)
    if (!skin.parameters[k]) skin.parameters[k] = ParameterField::of(defaults[k]);
}

template <class B>
std::unique_ptr<Bsdf> in_rec709(B bsdf, ColorSpace space) {
  if (space == ColorSpace::rec709) return std::make_unique<B>(std::move(bsdf));
  return std::make_unique<ColorConvertedBsdf<B>>(std::move(bsdf), space, ColorSpace::rec709);
}

class VaryingTableSkin final : public VaryingBsdf {
 public:
  explicit VaryingTableSkin(const Table& table) : table_(table, kInRec709) {}
  const Bsdf& at(const Parameters& parameters, BsdfRoom& room) const override {
    return room.emplace<TexturedTable::At>(table_.at(parameters));
  }

 private:
  TexturedTable table_;
};

std::unique_ptr<Bsdf> live_bsdf(const Material& material, const Spectrum& spectrum, Estimator estimator) {
  const Wavelengths wavelengths = spectrum.wavelengths(material);
  if (estimator == Estimator::exact)
    return in_rec709(ExactBsdf(material, wavelengths), spectrum.color_space());
  return in_rec709(LiveBsdf(material, wavelengths, technique_of(estimator)), spectrum.color_space());
}

class VaryingLiveSkin final : public VaryingBsdf {
 public:
  VaryingLiveSkin(const Recipe& recipe, Estimator estimator)
      : material_(recipe.material), spectrum_(recipe.spectrum), estimator_(estimator) {}
  const Bsdf& at(const Parameters& parameters, BsdfRoom& room) const override {
    return room.adopt(live_bsdf(parameters.applied_to(material_), spectrum_, estimator_));
  }

 private:
  Material material_;
  Spectrum spectrum_;
  Estimator estimator_;
};

// The corner of a skin's parameters where film and base are optically thickest.
Material highest(const SceneMaterial& skin, const Material& material) {
  const auto high = [&](std::size_t k) { return skin.parameters[k]->bounds().second; };
  return Parameters{high(0), high(1), high(2)}.applied_to(material);
}

// A scene's own parameters may not contradict what the recipe says of the base.
void require_same_base(const SceneMaterial& skin, const Recipe& recipe) {
  const auto& base_ior = skin.parameters[1];
  if (recipe.spectrum.film().base && base_ior &&
      base_ior->bounds() != std::pair(recipe.material.base_ior, recipe.material.base_ior))
    throw Error(
        "key 'base_ior': found beside a recipe whose base has an index over the wavelength; leave the key "
        "out");
  const auto defect = highest(skin, recipe.material).defect();
  if (defect) throw Error(defect->message());
}

}  // namespace

SceneMaterials::SceneMaterials(Scene& scene, const std::string& scene_path, const std::string& mode,
                               Estimator estimator) {
  std::optional<Table> table;
  std::optional<Recipe> recipe;
  for (SceneMaterial& skin : scene.materials) {
    if (skin.type == SceneMaterial::Type::diffuse) {
      add(std::make_unique<Lambert>(skin.albedo));
      continue;
    }
    if (skin.type == SceneMaterial::Type::gloss) {
      add(std::make_unique<Gloss>(skin.ior, skin.roughness));
      continue;
    }
    if (mode == "diffuse") {
      add(std::make_unique<Lambert>(scene.diffuse_albedo));
      continue;
    }
    if (mode == "live") {
      if (scene.recipe.empty())
        throw Error(scene_path + ": key 'recipe' is missing; --material live needs it");
      if (!recipe) recipe = load_recipe(scene.recipe);
    } else if (!table) {
      table = load_scene_table(scene, scene_path);
    }
    complete(skin, table ? table->material : recipe->material);
    try {
      table ? add_table_skin(skin, *table) : add_live_skin(skin, *recipe, estimator);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: material '{}': {}", scene_path, skin.name, error.what()));
    }
  }
  if (table) table_hash_ = table->info.at("recipe_hash");
}

std::string SceneMaterials::estimators() const { return fmt::format("{}", fmt::join(estimators_, ", ")); }

void SceneMaterials::add(std::unique_ptr<Bsdf> bsdf) {
  bsdfs_.push_back(bsdf.get());
  uniform_.push_back(std::move(bsdf));
}

void SceneMaterials::add(std::unique_ptr<VaryingBsdf> bsdf) {
  bsdfs_.push_back(bsdf.get());
  varying_.push_back(std::move(bsdf));
}

void SceneMaterials::add_table_skin(const SceneMaterial& skin, const Table& table) {
  if (!skin.varies()) return add(std::make_unique<TableBsdf>(table, skin.parameters_at({}), kInRec709));
  for (std::size_t k = 0; k < kParameterNames.size(); ++k) {
    const auto [low, high] = skin.parameters[k]->bounds();
    const auto& nodes = table.parameter_axis(k).nodes;
    if (low < nodes.front() || high > nodes.back())
      warnings_.push_back(
          fmt::format("material '{}': {} runs from {:g} to {:g}; clamped to the table's {:g} to {:g}",
                      skin.name, kParameterNames[k], low, high, nodes.front(), nodes.back()));
  }
  add(std::make_unique<VaryingTableSkin>(table));
}

void SceneMaterials::add_live_skin(const SceneMaterial& skin, const Recipe& recipe, Estimator wanted) {
  require_same_base(skin, recipe);
  const Material material = highest(skin, recipe.material);
  Estimator estimator = estimator_for_render(wanted, material);
  // An exact evaluator is prepared for many look-ups, which those of one hit cannot repay.
  if (skin.varies() && wanted == Estimator::automatic) estimator = Estimator::pfmc;
  estimators_.insert(name_of(estimator));
  if (!skin.varies()) return add(live_bsdf(material, recipe.spectrum, estimator));
  recipe.spectrum.wavelengths(material);  // refuses films that it does not resolve
  add(std::make_unique<VaryingLiveSkin>(recipe, estimator));
}

}  // namespace sunbeam
