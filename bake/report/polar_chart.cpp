#include "bake/report/polar_chart.h"

#include <fmt/format.h>

#include "bake/report/chart.h"

namespace sunbeam {
namespace {

constexpr int kSteps = 359;  // of theta_o, even ones; -90 and 90 degrees themselves are left out
constexpr double kRadius = 140, kCentreX = kPolarWidth / 2, kCentreY = 168;

double theta_of(std::size_t k) { return (static_cast<double>(k) + 0.5) / kSteps * kPi - kPi / 2; }

struct PolarPoint {
  double x, y;
};
PolarPoint at(double theta, double radius) {
  return {kCentreX + radius * std::sin(theta), kCentreY - radius * std::cos(theta)};
}

using Curve = std::vector<Rgb>;

// Positive theta_o on the mirror side.
Curve curve_of(const Appearance& skin, const Vec3& wi) {
  const double phi = std::atan2(-wi.y, -wi.x);
  std::vector<Vec3> wo;
  for (std::size_t k = 0; k < kSteps; ++k) wo.push_back(spherical_direction(theta_of(k), phi));
  Curve curve = skin.rest(wi, wo);
  for (std::size_t k = 0; k < kSteps; ++k) curve[k] = wo[k].z * (curve[k] + skin.first(wo[k], wi));
  return curve;
}

double peak_of(const Curve& curve) {
  double peak = 0;
  for (const Rgb& value : curve) peak = std::max(peak, max_component(value));
  return peak;
}

std::string curve_path(const Curve& curve, int channel, double peak, double width, double opacity) {
  std::string data;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const double share = std::sqrt(std::max(0.0, curve[k][channel]) / peak);
    const auto [x, y] = at(theta_of(k), kRadius * share);
    data += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", x, y);
  }
  return fmt::format(
      R"(<path d="{}" fill="none" stroke="{}" stroke-width="{}" stroke-opacity="{}" stroke-linejoin="round"/>)",
      data, kRgbColors[channel], width, opacity);
}

// Half circles at quarters of the peak's root, rays every 30 degrees.
std::string grid(double peak) {
  std::string data, labels;
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    data += fmt::format("M{0:g} {1:g}A{2:g} {2:g} 0 0 1 {3:g} {1:g}", kCentreX - share * kRadius, kCentreY,
                        share * kRadius, kCentreX + share * kRadius);
    if (share == 0.5 || share == 1)
      labels += svg_text(kCentreX + share * kRadius, kCentreY + 14, "middle",
                         fmt::format("{:.2g}", peak * square(share)));
  }
  for (int degrees = -90; degrees <= 90; degrees += 30) {
    const auto [x, y] = at(degrees * kPi / 180, kRadius);
    data += fmt::format("M{:g} {:g}L{:.1f} {:.1f}", kCentreX, kCentreY, x, y);
    const auto [text_x, text_y] = at(degrees * kPi / 180, kRadius + 13);
    if (std::abs(degrees) < 90)
      labels += svg_text(text_x, text_y + 4, "middle", fmt::format("{}\u00b0", degrees));
  }
  return fmt::format(R"(<path d="{}" fill="none" stroke="currentColor" stroke-opacity="0.15"/>)", data) +
         labels;
}

std::string ray(double theta, std::string_view attributes) {
  const auto [x, y] = at(theta, kRadius);
  return fmt::format(R"(<path d="M{:g} {:g}L{:.1f} {:.1f}" stroke="currentColor" {}/>)", kCentreX, kCentreY,
                     x, y, attributes);
}

std::string legend(double x, double y) {
  return fmt::format(
             R"(<path d="M{0:g} {1:g}h18" stroke="currentColor" stroke-width="5" stroke-opacity="0.3"/><path d="M{2:g} {1:g}h18" stroke="currentColor" stroke-width="1.3"/>)",
             x, y - 4, x + 62) +
         svg_text(x + 24, y, "start", "live") + svg_text(x + 86, y, "start", "table");
}

}  // namespace

std::string polar_chart(const Appearance& table, const Appearance& live, const Vec3& wi) {
  const Curve table_curve = curve_of(table, wi), live_curve = curve_of(live, wi);
  const double peak = std::max({peak_of(table_curve), peak_of(live_curve), 1e-12});
  const double theta_i = std::acos(wi.z);
  std::string svg = grid(peak) + ray(-theta_i, R"(stroke-opacity="0.6" stroke-width="1.5")");
  if (table.material().is_smooth()) svg += ray(theta_i, R"(stroke-opacity="0.6" stroke-dasharray="4 4")");
  for (int c = 0; c < 3; ++c) svg += curve_path(live_curve, c, peak, 5, 0.3);
  for (int c = 0; c < 3; ++c) svg += curve_path(table_curve, c, peak, 1.3, 1);
  const LegendEntry channels[] = {{kRgbColors[0], "R"}, {kRgbColors[1], "G"}, {kRgbColors[2], "B"}};
  return svg + legend(20, kPolarHeight - 12) + svg_legend(170, kPolarHeight - 12, channels);
}

}  // namespace sunbeam
