#include "runtime/src/rest/textured_grid.h"

#include <cmath>

#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kNodesPerFringe = 12;  // of the shortest wavelength
constexpr int kLeastThicknesses = 9;
constexpr int kIorNodes = 12, kAbsorptionNodes = 12, kCosines = 13;
constexpr int kIorNodesBelow = 24, kCosinesBelow = 25;  // where base IORs lie below the exterior's
constexpr int kPhis = 7;                                // of an anisotropic film
constexpr int kCosineStep = 2, kPhiStep = 3;
constexpr double kLeastCosine = 1e-4;

int nodes_between(const Table& table, double from_nm, double to_nm) {
  const auto& nm = table.factors.wavelengths.nm;
  const double fringes =
      fringe_order(table.material, 1) * (to_nm - from_nm) / *std::min_element(nm.begin(), nm.end());
  return std::max(kLeastThicknesses, static_cast<int>(std::ceil(fringes * kNodesPerFringe)) + 1);
}
int thickness_nodes(const Table& table) {
  return nodes_between(table, table.factors.grid[0].low(), table.factors.grid[0].high());
}

}  // namespace

TexturedGrid::TexturedGrid(const Table& table)
    : is_warped(FactorFrame(table.material, reaches_below(table)).is_warped()),
      cosines(reaches_below(table) ? kCosinesBelow : kCosines),
      axes{EvenAxis(table.factors.grid[0], thickness_nodes(table)),
           EvenAxis(table.factors.grid[1], reaches_below(table) ? kIorNodesBelow : kIorNodes),
           EvenAxis(table.factors.grid[2], kAbsorptionNodes)} {
  const bool has_azimuths = table.symmetry != Symmetry::isotropic;
  phis = has_azimuths ? kPhis : 1;
  cosine_step = (has_azimuths ? kCosineStep : 1) * (reaches_below(table) ? 2 : 1);
  phi_step = has_azimuths ? kPhiStep : 1;
  pair_cosines = (cosines - 1) / cosine_step + 1;
  pair_phis = (phis - 1) / phi_step + 1;
  const double from = axes[0].low() * textured_path(table.material, 0), to = axes[0].high();
  paths = nodes_between(table, from, to);
  first_path = static_cast<float>(from);
  if (to > from) per_extent = static_cast<float>(1 / (to - from));
}

double TexturedGrid::cosine(const FactorFrame& frame, int c) const {
  if (is_warped) return frame.cosine(coordinate(c));
  return std::max(square(coordinate(c)), kLeastCosine);
}

}  // namespace v1
}  // namespace sunbeam
