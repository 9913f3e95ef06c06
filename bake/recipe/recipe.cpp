#include "bake/recipe/recipe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bake/optics/layered/film_nodes.h"
#include "bake/recipe/film_keys.h"
#include "bake/recipe/material_keys.h"
#include "bake/recipe/range_of.h"
#include "runtime/config/config.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/hash.h"

namespace sunbeam {
namespace {

// The axes without nodes. Their coordinates follow how the rest depends on a parameter: like the square root
// of the base IOR's distance from index match, and ever more slowly with absorption; less so with that of a
// scattering pigment, whose remainder holds the decay itself.
std::array<Axis, 3> bare_axes(const Material& material) {
  Axis thickness{kParameterNames[0], "nm", {}};
  Axis base_ior{kParameterNames[1], "1", {}, 2, 0, material.exterior_ior};
  Axis absorption{kParameterNames[2], "1/nm", {}, material.scatters() ? 2.0 : 3.0};
  return {thickness, base_ior, absorption};
}

// Adds the kink of an axis to nodes on both sides of it: nothing interpolates across.
void add_kink(const Axis& axis, std::vector<double>& nodes) {
  if (axis.power == 1 || axis.origin <= nodes.front() || axis.origin >= nodes.back()) return;
  const auto at = std::lower_bound(nodes.begin(), nodes.end(), axis.origin);
  if (*at != axis.origin) nodes.insert(at, axis.origin);
}

std::vector<double> read_nodes(const ConfigTable& grid, const Axis& axis) {
  const std::string& key = axis.name;
  const Range allowed = range_of(key);
  if (!grid.is_table(key)) {
    auto nodes = grid.numbers(key, allowed);
    for (std::size_t i = 1; i < nodes.size(); ++i)
      if (nodes[i] <= nodes[i - 1])
        grid.fail(key,
                  fmt::format("found {} after {}; allowed: a list that increases", nodes[i], nodes[i - 1]));
    if (nodes.empty()) grid.fail(key, "the list is empty; allowed: at least one number");
    add_kink(axis, nodes);
    return nodes;
  }
  const ConfigTable range = grid.table(key);
  const double from = range.number("from", allowed);
  const double to = range.number("to", {from, allowed.high});
  const int count = range.integer("count", 1, 4096);
  if ((count == 1) != (from == to))
    range.fail(
        "count",
        fmt::format("found {} nodes from {} to {}; allowed: one node with from = to, several with from < to",
                    count, from, to));
  if (from < axis.origin && to > axis.origin && count < 3)
    range.fail("count",
               fmt::format("found {} nodes from {} to {}, across exterior_ior {}; allowed: 3 or more", count,
                           from, to, axis.origin));
  return spaced_nodes(axis, from, to, static_cast<std::size_t>(count));
}

// A grid varies numbers of the material, and those of its pigment where light reaches it.
void refuse_fixed(const ConfigTable& grid, const Material& material, const FilmDesign& film) {
  const auto& [thickness, base_ior, absorption] = kParameterNames;
  if (grid.has(base_ior) && (film.base || material.is_opaque()))
    grid.fail(base_ior, fmt::format("found, but the base {}; allowed with a number as material.base_ior and "
                                    "no base_extinction",
                                    material.is_opaque() ? "absorbs" : "has an index of its own"));
  if (grid.has(absorption) && material.is_opaque())
    grid.fail(absorption, "found, but the base absorbs, and nothing is seen below it; leave the key out");
}

std::vector<Axis> read_grid(const ConfigTable& grid, const Material& material, const FilmDesign& film) {
  refuse_fixed(grid, material, film);
  const auto defaults = Parameters::of(material).values();
  std::vector<Axis> axes;
  for (Axis axis : bare_axes(material)) {
    axis.nodes = grid.has(axis.name) ? read_nodes(grid, axis) : std::vector{defaults[axes.size()]};
    if (const std::string defect = axis.defect(); !defect.empty()) grid.fail(axis.name, defect);
    axes.push_back(std::move(axis));
  }
  require_proportions(grid, film, axes[0].high());
  return axes;
}

// The thickest film of the recipe, and where it is said.
struct Thickest {
  double nm;
  const ConfigTable& config;
  const char* key;
};

Thickest thickest_film(const ConfigTable& grid_config, const ConfigTable& material_config,
                       const Recipe& recipe) {
  const double in_grid = recipe.grid[0].high(), in_material = recipe.material.film_thickness_nm;
  if (in_grid >= in_material && grid_config.has(kParameterNames[0]))
    return {in_grid, grid_config, kParameterNames[0]};
  return {in_material, material_config, thickness_key(material_config)};
}

// The thickest film has to be resolved by kMostWavelengths wavelengths; a layered one whatever the mode.
double longest_path(const Thickest& thickest, const Material& material, const FilmDesign& film) {
  const double path = film.path_nm(material, thickest.nm), longest = resolved_path_nm(kMostWavelengths);
  if (path > longest)
    thickest.config.fail(thickest.key,
                         fmt::format("found {:g}; allowed with {}{}: up to {:g} nm{}", thickest.nm,
                                     film.is_layered(material) ? "" : "spectrum.mode \"full\" and ",
                                     film.layers.empty() ? fmt::format("film_ior {:g}", material.film_ior)
                                                         : "the indices of its layers",
                                     std::floor(longest / film.path_nm(material, 1)),
                                     film.layers.empty() ? "" : " in all layers and periods"));
  return path;
}

// Layers and opaque bases have no rule for their number of wavelengths, so that it is measured.
FilmNodes measured_nodes(const Thickest& thickest, const Material& material, const FilmDesign& film,
                         Illuminant illuminant, ColorSpace space) {
  const FilmNodes nodes = nodes_for_film(material, film, illuminant, space, thickest.nm);
  if (nodes.error > kMostFoldingError)
    thickest.config.fail(
        thickest.key,
        fmt::format("found a film of {:g} nm, of whose colours one in a hundred is off by "
                    "{:.2g} % or more at {} wavelengths; allowed: up to {:g} %",
                    thickest.nm, 100 * nodes.error, nodes.quadrature.size(), 100 * kMostFoldingError));
  return nodes;
}

constexpr const char* kAbsorptionSpectrum = "absorption_spectrum";
constexpr Range kWavelengthNm{1, 1e6};

AbsorptionShape read_absorption_shape(const ConfigTable& material) {
  if (!material.is_list(kAbsorptionSpectrum)) {
    const std::vector<std::string> names{"flat", "eumelanin", "pheomelanin"};
    const int choice = material.choice(kAbsorptionSpectrum, names, 0);
    return choice == 0 ? AbsorptionShape::flat() : AbsorptionShape::pigment(names[choice]);
  }
  const auto points = material.curve(kAbsorptionSpectrum, kWavelengthNm, {0, 1e9});
  try {
    return AbsorptionShape::table(points);
  } catch (const Error& error) {
    material.fail(kAbsorptionSpectrum, error.what());
  }
}

void refuse_outside_full(const ConfigTable& config, const char* key) {
  if (config.has(key)) config.fail(key, "found, but spectrum.mode is \"rgb3\"; allowed with \"full\" only");
}

Spectrum read_spectrum(const ConfigTable& config, const ConfigTable& material, const ConfigTable& grid,
                       const Recipe& recipe, const FilmDesign& film) {
  if (config.choice("mode", {"rgb3", "full"}, 0) == 0) {
    for (const char* key : {"illuminant", "color_space"}) refuse_outside_full(config, key);
    refuse_outside_full(material, kAbsorptionSpectrum);
    if (film.is_layered(recipe.material))
      longest_path(thickest_film(grid, material, recipe), recipe.material, film);
    Spectrum spectrum;
    spectrum.set_film(film, 0);
    return spectrum;
  }
  const auto illuminant = config.choice("illuminant", {"D65", "E"}, 0) == 0 ? Illuminant::d65 : Illuminant::e;
  const auto space =
      config.choice("color_space", {"acescg", "rec709"}, 0) == 0 ? ColorSpace::acescg : ColorSpace::rec709;
  const Thickest thickest = thickest_film(grid, material, recipe);
  const double path = longest_path(thickest, recipe.material, film);
  if (film == FilmDesign() && !recipe.material.is_opaque())
    return Spectrum(illuminant, space, path, read_absorption_shape(material));
  const FilmNodes nodes = measured_nodes(thickest, recipe.material, film, illuminant, space);
  Spectrum spectrum(illuminant, space, nodes.quadrature, read_absorption_shape(material));
  spectrum.set_film(film, nodes.path_nm);
  return spectrum;
}

// Reads the albedo into spectrum and material.
void read_albedo(const ConfigTable& config, Spectrum& spectrum, Material& material) {
  constexpr const char* kAlbedo = "albedo";
  if (material.is_opaque()) {
    if (spectrum.is_full()) spectrum.set_albedo(material.albedo);
    return;
  }
  if (config.is_list_of_lists(kAlbedo)) {
    if (!spectrum.is_full()) refuse_outside_full(config, kAlbedo);
    material.albedo = spectrum.set_albedo(config.curve(kAlbedo, kWavelengthNm, {0, 1}));
    return;
  }
  material.albedo = spectrum.from_rec709(config.rgb(kAlbedo, {0, 1}, material.albedo));
  if (!spectrum.is_full()) return;
  try {
    spectrum.set_albedo(material.albedo);
  } catch (const Error& error) {
    config.fail(kAlbedo, fmt::format("in {}: {}", to_string(spectrum.color_space()), error.what()));
  }
}

// Enough for the material's rest: a factored one is smooth in azimuth, but must be right to 0.1 %; a dense
// one pays for each, and so does path "product", for pairs of them.
int default_azimuths(const Material& material) {
  if (material.is_plain()) return 1;
  if (material.roughness.is_isotropic()) return 9;
  if (material.scatters() || material.has_multiple_facets()) return 8;
  return material.absorption_path == AbsorptionPath::sum ? 16 : 12;
}

// Only the noisiest cells have it.
double default_noise(double tolerance_median) { return std::min(tolerance_median, 0.005); }

// As many as the material's rest needs: see recipe.h.
int read_azimuths(const ConfigTable& config, const Material& material) {
  constexpr const char* kAzimuths = "azimuths";
  const bool isotropic = material.roughness.is_isotropic();
  const int azimuths = config.integer(kAzimuths, 1, kMostDirectionNodes, default_azimuths(material));
  if (!isotropic && azimuths % 4 != 0)
    config.fail(kAzimuths,
                fmt::format("found {}; allowed with an anisotropic roughness: a multiple of 4 up to {}",
                            azimuths, kMostDirectionNodes));
  if (!material.is_plain() && azimuths == 1)
    config.fail(kAzimuths,
                fmt::format("found 1, but the rest of a material with {} has azimuth; allowed: 2 to {}",
                            material.scatters() ? "scattering_per_nm > 0" : "microfacet \"multiple\"",
                            kMostDirectionNodes));
  return azimuths;
}

void read_table(const ConfigTable& table, Recipe& recipe) {
  recipe.table.angles = table.integer("angles", 2, kMostDirectionNodes, recipe.table.angles);
  recipe.table.azimuths = read_azimuths(table, recipe.material);
  recipe.table.precision = static_cast<Precision>(table.choice("precision", {"half", "float"}, 0));
  recipe.table.encoding = static_cast<Encoding>(table.choice("encoding", {"auto", "dense", "factored"}, 0));
  if (recipe.table.encoding == Encoding::factored && !has_factors(recipe.material))
    table.fail("encoding",
               fmt::format("found \"factored\", but the material has {}; allowed: \"auto\", \"dense\"",
                           recipe.material.scatters() ? "scattering_per_nm > 0" : "microfacet \"multiple\""));

  recipe.table.values = static_cast<TableValues>(table.choice("values", {"auto", "walks"}, 0));
}

// The remainder of a dense table lies at fixed cosines, which one critical angle suits but not several.
void refuse_dense_below(const ConfigTable& grid, const Recipe& recipe) {
  const Axis& base_ior = recipe.grid[1];
  const bool is_dense = recipe.table.encoding == Encoding::dense || !has_factors(recipe.material);
  if (is_dense && base_ior.size() > 1 && reaches_below(recipe))
    grid.fail(base_ior.name,
              fmt::format("found {} nodes from {}, which is below exterior_ior {}; allowed in a dense table: "
                          "one base_ior, or nodes from {} up",
                          base_ior.size(), base_ior.low(), base_ior.origin, base_ior.origin));
}

void read_accuracy(const ConfigTable& accuracy, Recipe& recipe) {
  recipe.accuracy.tolerance_median =
      accuracy.number("tolerance_median", {1e-6, 10}, recipe.accuracy.tolerance_median);
  recipe.accuracy.tolerance_p99 = accuracy.number("tolerance_p99", {1e-6, 10}, recipe.accuracy.tolerance_p99);
  recipe.accuracy.noise =
      accuracy.number("noise", {1e-6, 1}, default_noise(recipe.accuracy.tolerance_median));
  if (accuracy.choice("estimator", {"unidirectional", "bidirectional"}, 0) == 1)
    recipe.accuracy.estimator = Estimator::bidirectional;
}

struct RemovedKey {
  const char *section, *key;  // no section: at the top
  const char* reason;
};
constexpr RemovedKey kRemovedKeys[] = {
    {"table", "frame",
     "dense tables always hold what is left of their closed form, which takes fewer nodes; leave the key "
     "out"},
    {"accuracy", "interpolation",
     "a bake no longer chooses its nodes; list them in [grid], table.angles and table.azimuths, and ask "
     "sunbeam verify whether they are enough"},
    {"", "limits", "it bounded the nodes that accuracy.interpolation chose; leave the section out"},
};

enum class RemovedKeys { refused, passed_over };

void check_removed(const ConfigTable& section, const char* name, RemovedKeys removed) {
  for (const RemovedKey& gone : kRemovedKeys)
    if (gone.section == std::string_view(name) && section.has_removed(gone.key) &&
        removed == RemovedKeys::refused)
      section.fail(gone.key, fmt::format("removed in 0.2.0; {}", gone.reason));
}

Recipe read_recipe(const ConfigTable& config, const std::string& name, RemovedKeys removed) {
  const ConfigTable table = config.table("table"), accuracy = config.table("accuracy");
  check_removed(config, "", removed);
  check_removed(table, "table", removed);
  check_removed(accuracy, "accuracy", removed);
  Recipe recipe;
  recipe.name = name;
  const ConfigTable material = config.table("material"), grid = config.table("grid");
  const MaterialKeys keys = read_material(material);
  recipe.material = keys.material;
  recipe.grid = read_grid(grid, keys.material, keys.film);
  recipe.spectrum = read_spectrum(config.table("spectrum"), material, grid, recipe, keys.film);
  read_albedo(material, recipe.spectrum, recipe.material);
  read_table(table, recipe);
  refuse_dense_below(grid, recipe);
  read_accuracy(accuracy, recipe);

  config.finish();
  recipe.text = config.canonical_text();
  recipe.hash = content_hash(recipe.text);
  return recipe;
}

}  // namespace

Material at_lowest_base_ior(const Recipe& recipe) {
  Material material = recipe.material;
  material.base_ior = recipe.grid[1].low();
  return material;
}

bool reaches_below(const Recipe& recipe) {
  return reaches_below_exterior(recipe.material, recipe.grid[1].low());
}

Recipe parse_recipe(const std::string& text, const std::string& name,
                    const std::vector<std::string>& overrides) {
  return read_recipe(ConfigTable::parse(text, name, overrides), name, RemovedKeys::refused);
}

Recipe parse_stored_recipe(const std::string& text, const std::string& name) {
  return read_recipe(ConfigTable::parse(text, name), name, RemovedKeys::passed_over);
}

Recipe load_recipe(const std::string& path, const std::vector<std::string>& overrides) {
  return parse_recipe(read_text(path), path, overrides);
}

}  // namespace sunbeam
