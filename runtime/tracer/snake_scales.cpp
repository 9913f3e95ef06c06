#include "runtime/tracer/snake_scales.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sunbeam/core/vec.h"

namespace sunbeam {
namespace {

constexpr double kRowSpacing = std::numbers::sqrt3 / 2;
constexpr double kBelly = 0.1;        // half the width of a scute, of the girth
constexpr double kScaleRadius = 0.5;  // whose weight counts as 0

// The middles of a row of hexagons from one side of the belly to the other; the first ones are wider.
std::vector<double> hexagon_row(int columns) {
  constexpr double kWidening = 0.5, kOver = 1.5;  // over so many scales
  const int count = static_cast<int>(std::lround((1 - 2 * kBelly) * columns));
  std::vector<double> edges = {0};
  for (int k = 0; k < count; ++k)
    edges.push_back(edges.back() + 1 + kWidening * std::exp(-std::min(k, count - 1 - k) / kOver));
  std::vector<double> middles;
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const double middle = 0.5 * (edges[k - 1] + edges[k]) / edges.back();
    middles.push_back(columns * (kBelly + (1 - 2 * kBelly) * middle));
  }
  return middles;
}

// Across the body, in pieces so short that all lie near their middles.
void add_scute(std::vector<ScaleSite>& sites, const Point2& middle, double half_width, double weight,
               int columns) {
  const int pieces = static_cast<int>(std::ceil(2 * half_width / 0.5));
  const double half_length = half_width / pieces;
  for (int k = 0; k < pieces; ++k) {
    const double from_middle = (2 * k + 1) * half_length - half_width, x = middle.x + from_middle;
    sites.push_back({.center = {x < 0 ? x + columns : x, middle.y},
                     .half_length = half_length,
                     .weight = weight,
                     .in_scale = {from_middle, 0}});
  }
}

// --- the head ---

// A shield on the head, with its mirror image unless it lies in the middle.
struct Shield {
  double from_back, v;  // the middle; |u - 1/2| and v
  double radius;        // in units of u and v
};
// After Xenopeltis unicolor, simplified. The eye lies at (0.14, 0.625), the mouth along 0.3.
constexpr Shield kShields[] = {
    // internasals, nasals, prefrontals, loreals
    {0.055, 0.85, 0.055},
    {0.155, 0.865, 0.05},
    {0.06, 0.74, 0.06},
    {0.165, 0.775, 0.05},
    // frontal, supraoculars, before the eye, the eye, behind it
    {0, 0.63, 0.058},
    {0.083, 0.635, 0.04},
    {0.16, 0.695, 0.034},
    {0.14, 0.625, 0.034},
    {0.135, 0.56, 0.032},
    {0.18, 0.565, 0.03},
    // parietals with one between them, temporals
    {0.055, 0.51, 0.053},
    {0.06, 0.4, 0.054},
    {0, 0.455, 0.032},
    {0.14, 0.48, 0.04},
    {0.16, 0.4, 0.045},
    // the nape: towards the size of the body's scales
    {0, 0.322, 0.022},
    {0.045, 0.322, 0.022},
    {0.09, 0.322, 0.022},
    {0.135, 0.322, 0.024},
    {0.185, 0.325, 0.024},
    {0.0185, 0.284, 0.018},
    {0.0555, 0.284, 0.018},
    {0.0925, 0.284, 0.018},
    {0.13, 0.282, 0.019},
    {0.17, 0.282, 0.019},
    {0.21, 0.284, 0.019},
    // upper lip
    {0.245, 0.34, 0.035},
    {0.245, 0.415, 0.04},
    {0.245, 0.49, 0.04},
    {0.245, 0.565, 0.04},
    {0.245, 0.64, 0.04},
    {0.245, 0.715, 0.04},
    {0.245, 0.79, 0.04},
    {0.245, 0.87, 0.045},
    // lower lip
    {0.35, 0.36, 0.035},
    {0.35, 0.44, 0.045},
    {0.35, 0.52, 0.045},
    {0.35, 0.6, 0.045},
    {0.35, 0.68, 0.045},
    {0.35, 0.76, 0.045},
    {0.35, 0.85, 0.05},
    {0.43, 0.875, 0.045},
    // chin
    {0.5, 0.9, 0.035},
    {0.445, 0.78, 0.055},
    {0.445, 0.66, 0.055},
};
constexpr Shield kRostral{0, 0.945, 0.02};  // around the tip of the snout

std::vector<ScaleSite> shield_sites(int columns, double height) {
  const auto weight = [&](const Shield& shield) {
    return square(shield.radius * columns) - square(kScaleRadius);
  };
  std::vector<ScaleSite> sites;
  add_scute(sites, {0.5 * columns, kRostral.v * height}, 0.5 * columns, weight(kRostral), columns);
  for (const Shield& shield : kShields) {
    const auto add = [&](double u) {
      sites.push_back({.center = {u * columns, shield.v * height}, .weight = weight(shield)});
    };
    add(0.5 - shield.from_back);
    if (shield.from_back > 0 && shield.from_back < 0.5) add(0.5 + shield.from_back);
  }
  return sites;
}

double radius_of(const ScaleSite& shield) { return std::sqrt(shield.weight + square(kScaleRadius)); }

// By a shield, or within a gap between shields so narrow that the scale would be a sliver.
bool is_covered(const ScaleSite& scale, const std::vector<ScaleSite>& shields, int columns) {
  const double gap = std::max(1.5 * kScaleRadius, 0.021 * columns);
  return std::any_of(shields.begin(), shields.end(), [&](const ScaleSite& shield) {
    const double across = std::abs(scale.center.x - shield.center.x);
    const double distance = std::hypot(std::min(across, columns - across), scale.center.y - shield.center.y);
    return distance < radius_of(shield) + gap;
  });
}

}  // namespace

std::vector<ScaleSite> snake_body_sites(int columns, int rows) {
  const std::vector<double> row = hexagon_row(columns);
  const double half_scute = 2 * kBelly * columns - row.front();  // the border lies half way to the hexagons
  std::vector<ScaleSite> sites;
  for (int j = 0; j < rows; ++j) {
    const double y = (j + 0.5) * kRowSpacing;
    if (j % 2 == 0) add_scute(sites, {0, y}, half_scute, 0, columns);
    for (std::size_t k = j % 2; k < row.size(); ++k)
      sites.push_back({.center = {j % 2 == 0 ? row[k] : 0.5 * (row[k - 1] + row[k]), y}});
  }
  return sites;
}

std::vector<ScaleSite> snake_head_sites(int columns, int rows) {
  std::vector<ScaleSite> sites = shield_sites(columns, rows * kRowSpacing);
  const std::vector<ScaleSite> shields = sites;
  const double last_row = (rows - 1) * kRowSpacing;  // stays, for the body begins beyond it
  for (const ScaleSite& scale : snake_body_sites(columns, rows))
    if (scale.center.y > last_row || !is_covered(scale, shields, columns)) sites.push_back(scale);
  return sites;
}

}  // namespace sunbeam
