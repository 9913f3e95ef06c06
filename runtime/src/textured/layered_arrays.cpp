#include "runtime/src/textured/layered_arrays.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/textured/layered_factor.h"
#include "runtime/src/textured/layered_pairs.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kShareStep =
    4;  // cosines that a rough film's P is found at, if it has no knee; it is cubic between

Axis even_axis(const LayeredGrid& grid, int step) {
  Axis axis{"", "1", {}};
  axis.is_cubic = true;
  for (int c = 0; c < grid.cosines; c += step) axis.nodes.push_back(grid.cosine(c));
  return axis;
}

// R at a point.
void take_film(const LayeredWaves& waves, const LayeredGrid& grid, const KneeCosines& knee, Color4* film) {
  for (int c = 0; c < grid.cosines; ++c) film[c] = to_color4(waves.reflectance(knee.cosine(grid.cosine(c))));
}

// P at a point, of one azimuth. Facets blur what the film does to light, at a price for each cosine.
void take_shares(const LayeredWaves& waves, const LayeredFactor& factor, const LayeredGrid& grid, double phi,
                 const KneeCosines& knee, int step, Color4* shares) {
  const Axis axis = even_axis(grid, step);
  std::vector<Rgb> found;
  for (const double place : axis.nodes)
    found.push_back(factor.fold(waves.passage(std::max(knee.cosine(place), kLeastTexturedCosine), phi)));
  for (int c = 0; c < grid.cosines; ++c) {
    const Stencil at = axis.stencil(grid.cosine(c));
    Rgb sum;
    for (std::size_t k = 0; k < at.count; ++k) sum += at.weight[k] * found[at.node[k]];
    shares[c] = to_color4(transform(sum, [](double p) { return std::max(p, 0.0); }));
  }
}

}  // namespace

LayeredArrays::LayeredArrays(const Table& table, const LayeredGrid& grid, const Color4& absorption)
    : film(grid.film_cells()), shares(grid.share_cells()), logs(grid.log_cells()), pairs(grid.pair_cells()) {
  const auto columns = static_cast<std::size_t>(grid.columns()),
             ends = static_cast<std::size_t>(grid.ends() * grid.ends());
  const int share_step = table.material.is_smooth() || grid.has_knee ? 1 : kShareStep;
  for (int point = 0; point < grid.points(); ++point) {
    const LayeredWaves waves(table, grid.parameters(point, 0).applied_to(table.material));
    const auto at = static_cast<std::size_t>(point);
    const double base_ior = grid.parameters(point, 0).base_ior;
    const KneeCosines knee = grid.knee(base_ior);
    take_film(waves, grid, knee, &film[at * static_cast<std::size_t>(grid.cosines)]);
    if (!grid.has_rest) continue;
    const LayeredDirections directions(waves, grid, table.material, base_ior);
    std::vector<Rgb> least;  // B at the least absorption
    for (int s = 0; s < grid.absorptions(); ++s) {
      const LayeredFactor factor(table, grid, waves, directions, grid.parameters(point, s), absorption);
      if (s == 0) {
        least = factor.values();
        for (int p = 0; p < grid.phis; ++p)
          take_shares(waves, factor, grid, grid.phi(p), knee, share_step,
                      &shares[static_cast<std::size_t>((point * grid.phis + p) * grid.cosines)]);
      }
      const std::size_t row = at * static_cast<std::size_t>(grid.absorptions()) + static_cast<std::size_t>(s);
      factor.take_logs(least, &logs[row * columns]);
      LayeredPairs(table, grid, factor).take(&pairs[row * ends]);
    }
  }
}

}  // namespace v1
}  // namespace sunbeam
