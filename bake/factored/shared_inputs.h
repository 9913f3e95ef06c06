// This file holds what all tasks of a factored bake share.
#pragma once

#include "bake/factored/axes.h"
#include "bake/factored/replicates.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {

// Prepares the inputs of all tasks. `recipe` must outlive it.
struct SharedInputs {
  SharedInputs(const Recipe& recipe, std::uint64_t seed)
      : recipe(recipe), seed(seed), shapes(factor_shapes(recipe)) {
    const auto axes = direction_axes(recipe, "");
    for (const double c : axes[0].nodes)
      for (const double phi : axes[1].nodes) directions.push_back(direction_from_cosine(c, phi));
  }

  bool has_exchange() const { return !shapes.exchange.empty(); }
  std::size_t iors() const { return recipe.grid[1].size(); }

  Material material_at(std::size_t ior) const {
    Material material = recipe.material;
    material.base_ior = recipe.grid[1].nodes[ior];
    return material;
  }

  // These return one random stream a direction and replicate, and others for returns. They are the same at
  // every base IOR.
  Rng rng_of_arrivals(std::size_t direction, std::size_t replicate) const {
    return Rng(seed, direction * kReplicates + replicate);
  }
  Rng rng_of_returns(std::size_t replicate) const { return rng_of_arrivals(directions.size(), replicate); }

  const Recipe& recipe;
  std::uint64_t seed;
  FactorShapes shapes;
  std::vector<Vec3> directions;  // nodes, phi fastest
};

}  // namespace sunbeam
