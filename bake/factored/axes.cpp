#include "bake/factored/axes.h"

#include <fmt/format.h>

#include "bake/factored/orders/exchange_axes.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/factor_frame.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/table_ranges.h"

namespace sunbeam {
namespace {

constexpr double kNodesPerFringe = 10;              // of arrival and returned: cubic to 4e-4 of a fringe
constexpr double kExchangeNodesPerFringe = 3;       // most of exchange has no fringes
constexpr double kMoreNodesPerFringeOverWhite = 8;  // 3 alone would be off by 1 % of the albedo there
constexpr std::size_t kLeastFringeNodes = 6;
constexpr std::size_t kAlbedoNodes = 3;           // where wavelengths differ; the series in kd converges fast
constexpr std::size_t kDepthNodesOfOneValue = 5;  // where only wavelengths make depths differ
constexpr std::size_t kLeastDepthNodesOfDecay = 12;  // where `arrival` holds what the pigment absorbs
constexpr std::size_t kFacetRanks = 33, kReturnRanks = 65;
constexpr std::size_t kLeastDepthNodesOfReturning = 16;  // it decays with the depth
constexpr double kAngleNodesPerRoughness = 1.5;  // lobes of facets change over an angle of the roughness
constexpr std::size_t kLeastAngleNodes = 32, kMostAngleNodes = 160;
constexpr double kMostCells = 1 << 28;

Axis cubic(Axis axis) {
  axis.is_cubic = axis.size() > 2;
  return axis;
}

Axis orders_axis(const Recipe& recipe, const Wavelengths& w, double least_cosine, double per_fringe) {
  const auto [shortest, longest] = std::minmax_element(w.nm.begin(), w.nm.end());
  const double low = fringe_order(recipe.material, least_cosine) * recipe.grid[0].low() / *longest;
  const double high = fringe_order(recipe.material, 1) * recipe.grid[0].high() / *shortest;
  Axis axis{"fringe_order", "1", {low}};
  if (high > low) {
    const auto count =
        std::max(kLeastFringeNodes, static_cast<std::size_t>(std::ceil((high - low) * per_fringe)) + 1);
    const double step = (high - low) / static_cast<double>(count - 1);
    axis.nodes = spaced_nodes(low, high + step, count + 1);  // one beyond: a cubic is best inside its nodes
  }
  return cubic(axis);
}

// Later visits carry the fringes, and their series ends the later the brighter the base.
double exchange_nodes_per_fringe(const Wavelengths& w) {
  return kExchangeNodesPerFringe +
         kMoreNodesPerFringeOverWhite * square(*std::max_element(w.albedo.begin(), w.albedo.end()));
}

Axis depths_axis(const Recipe& recipe, const Wavelengths& w, std::size_t least_count = 0) {
  const Axis& absorption = recipe.grid[2];
  const auto [least, most] = std::minmax_element(w.absorption.begin(), w.absorption.end());
  const double thickness = recipe.material.pigment_thickness_nm;
  const double low = absorption.low() * thickness * *least, high = absorption.high() * thickness * *most;
  Axis axis{"optical_depth", "1", {low}, 3};
  const std::size_t count = absorption.size() > 1 ? absorption.size() : kDepthNodesOfOneValue;
  if (high > low) axis.nodes = spaced_nodes(low, high, std::max(count, least_count), axis.power);
  return cubic(axis);
}

Axis arrival_depths_axis(const Recipe& recipe, const Wavelengths& w) {
  if (recipe.material.transmission == Transmission::straight) return {"optical_depth", "1", {0}, 3};
  const bool holds_decay = FactorFrame(recipe.material, reaches_below(recipe)).is_warped();
  return depths_axis(recipe, w, holds_decay ? kLeastDepthNodesOfDecay : 0);
}

Axis albedos_axis(const Wavelengths& w) {
  const auto [least, most] = std::minmax_element(w.albedo.begin(), w.albedo.end());
  Axis axis{"albedo", "1", {*least}};
  constexpr double kSameAlbedo = 1e-6;  // as good as grey
  if (*most - *least > kSameAlbedo) axis.nodes = spaced_nodes(*least, *most, kAlbedoNodes);
  return cubic(axis);
}

ArrayShape shape_of(const Recipe& recipe, const char* name, const std::vector<Axis>& axes,
                    Precision precision) {
  double cells = 1;
  for (const Axis& axis : axes) cells *= static_cast<double>(axis.size());
  if (cells > kMostCells)
    throw Error(fmt::format("{}: [grid] and [table] ask for {:.3g} cells of '{}'; allowed: up to {:.3g}",
                            recipe.name, cells, name, kMostCells));
  return {name, axes, precision, 1};
}

std::vector<Axis> joined(std::vector<Axis> axes, const std::vector<Axis>& more) {
  axes.insert(axes.end(), more.begin(), more.end());
  return axes;
}

ArrayShape arrival_shape(const Recipe& recipe, const Wavelengths& w) {
  const std::vector<Axis> axes{cubic(recipe.grid[1]), arrival_depths_axis(recipe, w),
                               orders_axis(recipe, w, 0, kNodesPerFringe)};
  return shape_of(recipe, "arrival", joined(axes, direction_axes(recipe, "")), recipe.table.precision);
}

ArrayShape returned_shape(const Recipe& recipe, const Wavelengths& w) {
  return shape_of(recipe, "returned",
                  {cubic(recipe.grid[1]), depths_axis(recipe, w), orders_axis(recipe, w, 1, kNodesPerFringe)},
                  Precision::single_float);
}

// What comes before the axes of directions.
std::vector<Axis> exchange_media(const Recipe& recipe, const Wavelengths& w) {
  const Axis iors = cubic(recipe.grid[1]), depths = depths_axis(recipe, w);
  if (!is_layered(recipe.material, w))
    return {iors, depths, albedos_axis(w), orders_axis(recipe, w, 1, exchange_nodes_per_fringe(w))};
  const ExchangeAxes axes = exchange_axes(recipe, w, depths.low());
  return {iors, depths, axes.albedo, axes.wavelength, axes.fringe_order};
}

ArrayShape exchange_shape(const Recipe& recipe, const Wavelengths& w) {
  if (!has_factored_depths(recipe))
    throw Error(
        fmt::format("{}: key 'grid.absorption_per_nm': found an optical depth of {:.4g} with path product; "
                    "allowed in a factored table: up to {}",
                    recipe.name, depths_axis(recipe, w).high(), kDeepestProduct));
  const auto with_wi = joined(exchange_media(recipe, w), direction_axes(recipe, "_i"));
  return shape_of(recipe, "exchange", joined(with_wi, direction_axes(recipe, "_o")), recipe.table.precision);
}

Axis facet_ranks(std::size_t count) { return cubic({"facet_rank", "1", spaced_nodes(0, 1, count)}); }

// (theta, phi) of facet_cosine and crossing.
std::vector<Axis> angle_axes(const Recipe& recipe) {
  const Roughness& roughness = recipe.material.roughness;
  const double nodes = kPi / 2 / std::min(roughness.u, roughness.v) * kAngleNodesPerRoughness;
  const auto count = std::clamp(static_cast<std::size_t>(nodes), kLeastAngleNodes, kMostAngleNodes);
  return {cubic({"theta", "rad", spaced_nodes(0, std::acos(kLowestArrayCosine), count)}),
          direction_axes(recipe, "")[1]};
}

// The base of an opaque one's table is not met: one cell stands for what it would return.
void add_returning_shapes(const Recipe& recipe, FactorShapes& factors) {
  Axis ranks = facet_ranks(kReturnRanks),
       depths = depths_axis(recipe, factors.wavelengths, kLeastDepthNodesOfReturning);
  if (recipe.material.is_opaque()) {
    ranks.nodes = {1};
    depths.nodes = {0};
  }
  factors.return_cosine = shape_of(recipe, "return_cosine", {cubic(ranks)}, Precision::single_float);
  factors.returning = shape_of(recipe, "returning", {cubic(depths), cubic(ranks)}, Precision::single_float);
}

void add_layered_shapes(const Recipe& recipe, FactorShapes& factors) {
  const Material& material = recipe.material;
  if (!material.is_smooth() && !material.is_opaque()) {
    const auto angles = angle_axes(recipe);
    const std::vector<Axis> ranks{facet_ranks(kFacetRanks)};
    factors.facet_cosine = shape_of(recipe, "facet_cosine", joined(angles, ranks), Precision::single_float);
    const std::vector<Axis> media{cubic(recipe.grid[1]), arrival_depths_axis(recipe, factors.wavelengths)};
    factors.crossing =
        shape_of(recipe, "crossing", joined(media, joined(angles, ranks)), Precision::single_float);
  }
  if (material.absorption_path == AbsorptionPath::sum || material.is_opaque())
    add_returning_shapes(recipe, factors);
  else
    factors.exchange = exchange_shape(recipe, factors.wavelengths);
}

}  // namespace

bool has_factored_depths(const Recipe& recipe) {
  return recipe.material.absorption_path == AbsorptionPath::sum || recipe.material.is_opaque() ||
         depths_axis(recipe, recipe.spectrum.wavelengths(recipe.material)).high() <= kDeepestProduct;
}

std::vector<Axis> direction_axes(const Recipe& recipe, const std::string& suffix) {
  const auto count = static_cast<std::size_t>(recipe.table.angles);
  Axis phi{"phi" + suffix, "rad", {0}};
  if (!recipe.material.roughness.is_isotropic())
    phi.nodes = spaced_nodes(0, kPi / 2, static_cast<std::size_t>(recipe.table.azimuths) / 4 + 1);
  if (FactorFrame(recipe.material, reaches_below(recipe)).is_warped())
    return {cubic({"warped_cos" + suffix, "1", spaced_nodes(0, 1, count)}), cubic(phi)};
  return {cubic({"cos_theta" + suffix, "1", spaced_nodes(kLowestArrayCosine, 1, count, 2), 2}), cubic(phi)};
}

FactorShapes factor_shapes(const Recipe& recipe) {
  FactorShapes factors;
  factors.grid = recipe.grid;
  factors.wavelengths = recipe.spectrum.wavelengths(recipe.material);
  const Wavelengths& w = factors.wavelengths;
  if (is_layered(recipe.material, w)) {
    add_layered_shapes(recipe, factors);
    return factors;
  }
  if (!recipe.material.is_smooth()) factors.arrival = arrival_shape(recipe, w);
  if (recipe.material.absorption_path == AbsorptionPath::sum)
    factors.returned = returned_shape(recipe, w);
  else
    factors.exchange = exchange_shape(recipe, w);
  return factors;
}

}  // namespace sunbeam
