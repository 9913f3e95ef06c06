#include "bake/factored/returned.h"

#include "bake/base/error_floor.h"
#include "bake/blocks/block_bytes.h"
#include "bake/live/exact/dense.h"

namespace sunbeam {
namespace {

constexpr Strata kUpStrata{16, 256}, kSmoothUpStrata{256, 1 << 16};

// The same range with fewer nodes.
Axis thinned(Axis orders) {
  constexpr std::size_t kMost = 32;
  if (orders.size() > kMost) orders.nodes = spaced_nodes(orders.low(), orders.high(), kMost);
  return orders;
}

// What the film sends back, all told, at each order.
Replicates all_returned(const SharedInputs& bake, const FilmLegs& legs, FringePowers& powers, std::size_t up,
                        std::uint64_t& walks) {
  Replicates returned(powers.reflectance.size());
  for (std::size_t r = 0; r < kReplicates; ++r) {
    std::vector<double> one(powers.reflectance.size());
    legs.visit_returns(up, bake.rng_of_returns(r), [&](const Leg& leg) {
      powers.at(leg.facet_cosine);
      add_scaled(leg.weight, powers.reflectance.data(), static_cast<int>(one.size()), one.data());
      ++walks;
    });
    returned.add(one);
  }
  return returned;
}

// As it tells in 1 / (1 - kd returned).
double worst_error(const Replicates& returned, double kd) {
  double worst = 0;
  for (std::size_t k = 0; k < returned.mean().size(); ++k) {
    const double kept = std::max(1 - kd * returned.mean()[k], kDarkestAlbedo);
    worst = std::max(worst, kd * std::sqrt(returned.variance(k)) / kept);
  }
  return worst;
}

}  // namespace

std::size_t strata_of_returns(const SharedInputs& bake, const LegFilm& film, const FilmLegs& legs,
                              BlockSummary& summary) {
  const FactorShapes& shapes = bake.shapes;
  const Axis& orders =
      bake.has_exchange() ? shapes.exchange.axes()[order_axis(shapes.exchange)] : shapes.returned.axes()[2];
  FringePowers powers = film.powers(Side::inside, thinned(orders));
  const std::vector<double>& albedos = shapes.wavelengths.albedo;
  const double kd = *std::max_element(albedos.begin(), albedos.end());
  const Strata range = film.material.is_smooth() ? kSmoothUpStrata : kUpStrata;
  for (std::size_t up = range.least;; up *= 2) {
    summary.worst_error = worst_error(all_returned(bake, legs, powers, up, summary.walks), kd);
    if (summary.worst_error <= bake.recipe.accuracy.noise || up == range.most) return up;
  }
}

Block walk_returned(const SharedInputs& bake, std::size_t ior) {
  const std::vector<Axis>& axes = bake.shapes.returned.axes();
  const std::vector<double>& depths = axes[1].nodes;
  const std::size_t orders = axes[2].size();
  std::vector<double> sum(depths.size() * orders);
  Block block;
  visit_returns(bake, LegFilm{bake.material_at(ior)}, axes[2], block.summary,
                [&](const Leg& leg, const std::vector<double>& reflectance) {
                  for (std::size_t t = 0; t < depths.size(); ++t)
                    add_scaled(leg.weight * std::exp(-depths[t] * (1 / leg.from + 1 / leg.to)),
                               reflectance.data(), static_cast<int>(orders), sum.data() + t * orders);
                });
  append(block.values, std::span<const double>(sum));
  return block;
}

void add_returned(std::size_t ior, const std::string& bytes, NdArray& array) {
  const auto values = unpacked<double>(bytes, array.stride(0));
  for (std::size_t k = 0; k < values.size(); ++k) array.set(ior * array.stride(0) + k, Rgb(values[k]));
}

}  // namespace sunbeam
