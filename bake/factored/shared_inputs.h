// This file holds what all tasks of a factored bake share.
#pragma once

#include "bake/factored/axes.h"
#include "bake/factored/replicates.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/factor_frame.h"

namespace sunbeam {

// Prepares the inputs of all tasks. `recipe` must outlive it.
struct SharedInputs {
  SharedInputs(const Recipe& recipe, std::uint64_t seed)
      : recipe(recipe), seed(seed), shapes(factor_shapes(recipe)) {
    for (std::size_t ior = 0; ior < iors(); ++ior) {
      const FactorFrame frame = frame_at(ior);
      const auto axes = direction_axes(recipe, "");
      std::vector<Vec3>& nodes = directions.emplace_back();
      for (const double c : axes[0].nodes)
        for (const double phi : axes[1].nodes) nodes.push_back(direction_from_cosine(frame.cosine(c), phi));
    }
  }

  bool has_exchange() const { return !shapes.exchange.empty(); }
  std::size_t iors() const { return recipe.grid[1].size(); }

  Material material_at(std::size_t ior) const {
    Material material = recipe.material;
    material.base_ior = recipe.grid[1].nodes[ior];
    return material;
  }
  FactorFrame frame_at(std::size_t ior) const { return {material_at(ior), reaches_below(recipe)}; }

  std::size_t direction_count() const { return directions.front().size(); }

  // These return one random stream a direction and replicate, and others for returns. They are the same at
  // every base IOR.
  Rng rng_of_arrivals(std::size_t direction, std::size_t replicate) const {
    return Rng(seed, direction * kReplicates + replicate);
  }
  Rng rng_of_returns(std::size_t replicate) const { return rng_of_arrivals(direction_count(), replicate); }

  const Recipe& recipe;
  std::uint64_t seed;
  FactorShapes shapes;
  std::vector<std::vector<Vec3>> directions;  // nodes of each base IOR, phi fastest
};

}  // namespace sunbeam
