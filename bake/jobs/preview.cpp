#include "bake/jobs/preview.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

std::string grid_override(const Axis& axis) {
  std::vector<std::string> nodes;
  for (const double node : axis.nodes) nodes.push_back(to_text(node));
  return fmt::format("grid.{}=[{}]", axis.name, fmt::join(nodes, ", "));
}

}  // namespace

Recipe preview_of(const Recipe& recipe) {
  constexpr std::array<std::size_t, 3> kMostNodes = {13, 8, 6};
  std::vector<std::string> overrides{"accuracy.noise=0.005"};
  for (std::size_t a = 0; a < kMostNodes.size(); ++a) {
    Axis axis = recipe.grid[a];
    if (axis.size() <= kMostNodes[a]) continue;
    axis.nodes = spaced_nodes(axis, axis.low(), axis.high(), kMostNodes[a]);
    overrides.push_back(grid_override(axis));
  }
  overrides.push_back(fmt::format("table.angles={}", std::min(recipe.table.angles, 10)));
  overrides.push_back(fmt::format("table.azimuths={}", std::min(recipe.table.azimuths, 8)));
  return parse_recipe(recipe.text, recipe.name, overrides);
}

}  // namespace sunbeam
