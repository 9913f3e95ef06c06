#include "runtime/src/fit/textured_fit.h"

#include <optional>

#include "runtime/src/fit/textured_exchange.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// The table's material at nodes of the base IOR and the absorption.
Material material_at(const Table& table, const TexturedGrid& grid, int n, int s) {
  Material material = table.material;
  material.base_ior = grid.axes[1].node(n);
  material.absorption_per_nm = grid.axes[2].node(s);
  return material;
}

}  // namespace

TexturedFit fit_textured(const Table& table, const TexturedGrid& grid, const TexturedMedia& media) {
  const bool is_product = !table.factors.exchange.empty();
  std::optional<TexturedOrders> orders;
  TexturedFit fit{std::vector<Color4>(grid.cells()), std::vector<Color4>(is_product ? grid.pair_cells() : 0)};
  for (int n = 0; n < grid.axes[1].size(); ++n) {
    const FactorFrame frame(material_at(table, grid, n, 0), reaches_below(table));
    if (!orders || grid.is_warped) orders.emplace(table, grid, frame);
    NdArray exchange;
    if (is_product) exchange = table.factors.exchange.slice(std::array{grid.axes[1].node(n)});
    for (int s = 0; s < grid.axes[2].size(); ++s) {
      const TexturedWaves waves(table, material_at(table, grid, n, s), grid, *orders, media.film);
      const TexturedFactor factor(waves, media, is_product);
      const std::vector<Color4> nodes = factor.nodes();
      for (int p = 0; p < grid.paths; ++p)
        std::copy_n(nodes.begin() + p * grid.columns(), grid.columns(),
                    fit.nodes.data() + static_cast<std::size_t>(p) * grid.path_stride() + grid.row(n, s));
      if (!is_product) continue;
      const TexturedExchange pairs(exchange, waves, media, factor, nodes);
      for (int d = 0; d < grid.axes[0].size(); ++d) pairs.find_pairs(d, &fit.pairs[grid.first_pair(d, n, s)]);
    }
  }
  return fit;
}

}  // namespace v1
}  // namespace sunbeam
