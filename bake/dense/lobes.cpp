#include "bake/dense/lobes.h"

#include <fmt/format.h>

#include "bake/dense/nodes.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

// The largest distance between azimuths that holds what facets of slopes around alpha send to each other. Two
// reflections at grazing leave a lobe some 2 alpha^2 wide. Facets much flatter than the lowest cosines of a
// table have it only below them, where it matters less and less. The factors bound the light that a table
// adds; docs/limits.md has the measurement.
double largest_azimuth_step(double alpha) { return 40 * square(alpha) + 3e-4 / alpha; }

int fewest_azimuths(const Recipe& recipe) {
  const Roughness& roughness = recipe.material.roughness;
  const double step = largest_azimuth_step(std::min(roughness.u, roughness.v));
  if (symmetry_of(recipe) == Symmetry::isotropic) return static_cast<int>(std::ceil(kPi / step)) + 1;
  return 4 * static_cast<int>(std::ceil(2 * kPi / step / 4));
}

void require_wide_facet_lobes(const Recipe& recipe) {
  if (!recipe.material.has_multiple_facets()) return;
  const int fewest = fewest_azimuths(recipe);
  if (recipe.table.azimuths < fewest)
    throw Error(fmt::format(
        "{}: key 'table.azimuths': found {}, which cannot hold the lobes of microfacet \"multiple\"; allowed "
        "with roughness {}: {} to {}",
        recipe.name, recipe.table.azimuths, to_string(recipe.material.roughness), fewest,
        kMostDirectionNodes));
}

// The squared width of the lobe that a film of facets gives light which a phase function sends straight back,
// as far as facets bend light: twice, by half of alpha each between indices of 1 and 1.5.
double squared_width(const Recipe& recipe, double anisotropy) {
  const Material& m = recipe.material;
  const double own = square(1 - std::abs(anisotropy));
  if (m.transmission == Transmission::straight) return own;
  const Axis& base_ior = recipe.grid[1];
  const double nearest = std::clamp(m.exterior_ior, base_ior.low(), base_ior.high());
  const double bend = (nearest / m.exterior_ior - 1) * std::min(m.roughness.u, m.roughness.v);
  return own + 2 * square(bend);
}

// The albedo along the normal that the lobe of light sent straight back has in a table. Henyey and
// Greenstein's function is (1 + |g|) / (4 pi width^2) there, once scattered light has (1 - exp(-2 tau)) / 2
// of it, and the end node of a cubic stands for a third of the cap of cosines down to its neighbour.
double returned_by_lobe(const Recipe& recipe, double anisotropy) {
  const std::vector<double>& cosines = rest_axes(recipe)[3].nodes;
  const double cap = 2 * kPi * (1 - cosines[cosines.size() - 2]);
  const double once = -0.5 * std::expm1(-2 * recipe.material.scattering_depth());
  return once * (1 - anisotropy) / (4 * kPi * squared_width(recipe, anisotropy)) * cap / 3;
}

void require_wide_phase_function(const Recipe& recipe) {
  const double found = recipe.material.anisotropy;
  if (!recipe.material.scatters() || found >= 0 || returned_by_lobe(recipe, found) <= 1) return;
  int hundredths = static_cast<int>(std::ceil(100 * found));
  while (hundredths < 0 && returned_by_lobe(recipe, hundredths / 100.0) > 1) ++hundredths;
  throw Error(fmt::format(
      "{}: key 'material.anisotropy': found {:g}, whose lobe {} cosines cannot hold; allowed with them: {:g} "
      "to {:g} (table.angles sets their number)",
      recipe.name, found, recipe.table.angles, hundredths / 100.0, allowed_interval("anisotropy").high));
}

}  // namespace

void require_wide_lobes(const Recipe& recipe) {
  require_wide_facet_lobes(recipe);
  require_wide_phase_function(recipe);
}

}  // namespace sunbeam
