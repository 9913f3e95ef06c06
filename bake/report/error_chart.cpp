#include "bake/report/error_chart.h"

#include <fmt/format.h>

#include "bake/report/chart.h"

namespace sunbeam {
namespace {

constexpr std::size_t kBins = 14;
constexpr std::size_t kMostDots =
    2000;  // more only make the page heavy; points are random, the first will do
constexpr double kLeft = 60, kFrameWidth = 430;

using Member = double VerifyPoint::*;

double degrees_of(const VerifyPoint& point) { return std::acos(point.cos_i) * 180 / kPi; }

std::vector<ChartPoint> all_points(const ErrorAxis& axis, const VerifyReport& report, Member member,
                                   double factor) {
  std::vector<ChartPoint> points;
  for (std::size_t k = 0; k < report.points.size(); ++k)
    points.push_back({axis.values[k], factor * report.points[k].*member});
  return points;
}

std::vector<ChartPoint> few(std::vector<ChartPoint> points) {
  points.resize(std::min(points.size(), kMostDots));
  return points;
}

// A quantile in every stretch of the axis that holds points.
std::vector<ChartPoint> binned(const std::vector<ChartPoint>& points, const ErrorAxis& axis, double q) {
  std::vector<std::vector<double>> bins(kBins);
  for (const auto& p : points) {
    const double share = (p.x - axis.low) / (axis.high - axis.low);
    bins[std::min(kBins - 1, static_cast<std::size_t>(share * kBins))].push_back(p.y);
  }
  std::vector<ChartPoint> line;
  for (std::size_t k = 0; k < kBins; ++k)
    if (!bins[k].empty())
      line.push_back(
          {lerp((static_cast<double>(k) + 0.5) / kBins, axis.low, axis.high), quantile(bins[k], q)});
  return line;
}

// Whole decades around all values and the tolerance, in percent; what is nearly 0 lies on the lower edge.
ChartAxis percent_axis(std::string label, const VerifyReport& report, Member member, double top) {
  constexpr double kLeast = 1e-4, kMostDecades = 4;
  double low = top;
  for (const auto& point : report.points) {
    const double percent = 100 * (point.*member);
    if (percent > 0) low = std::min(low, percent);
    top = std::max(top, percent);
  }
  const double high = std::pow(10, std::ceil(std::log10(std::max(top, 10 * kLeast))));
  low = std::pow(10, std::floor(std::log10(std::max(low, kLeast))));
  return {std::move(label), std::clamp(low, high * std::pow(10, -kMostDecades), high / 10), high, true};
}

bool has_noise(const VerifyReport& report) { return report.noise_floor.max > 0; }

std::string noise_panel(const ErrorAxis& axis, const VerifyReport& report, const ChartAxis& x) {
  Chart chart(x, percent_axis("noise (%)", report, &VerifyPoint::noise_floor, 0),
              {kLeft, 250, kFrameWidth, 76});
  if (has_noise(report)) {
    const auto points = all_points(axis, report, &VerifyPoint::noise_floor, 100);
    chart.dots(few(points), kPointColor);
    chart.line(binned(points, axis, 0.5), kMedianColor, 2.2);
    chart.line(binned(points, axis, 0.99), kHighColor, 2.2);
  } else {
    chart.note("none: the truth of this report is exact");
  }
  return chart.svg();
}

}  // namespace

std::vector<ErrorAxis> error_axes(const Table& table, const VerifyReport& report) {
  std::vector<ErrorAxis> axes;
  for (std::size_t k = 0; k < kParameterNames.size(); ++k) {
    const Axis& axis = table.parameter_axis(k);
    if (axis.size() < 2) continue;
    std::vector<double> values;
    for (const auto& point : report.points) values.push_back(point.parameters.values()[k]);
    axes.push_back({axis.name, axis.unit == "1" ? "" : axis.unit, axis.low(), axis.high(), axis.nodes,
                    std::move(values)});
  }
  std::vector<double> angles;
  for (const auto& point : report.points) angles.push_back(degrees_of(point));
  axes.push_back({"theta_i", "degrees", 0, 90, {}, std::move(angles)});
  return axes;
}

std::string error_chart(const ErrorAxis& axis, const VerifyReport& report, double tolerance_p99) {
  const std::string label = axis.unit.empty() ? axis.name : fmt::format("{} ({})", axis.name, axis.unit);
  const auto points = all_points(axis, report, &VerifyPoint::error, 100);
  Chart chart({"", axis.low, axis.high},
              percent_axis("error (%)", report, &VerifyPoint::error, 100 * tolerance_p99),
              {kLeft, 26, kFrameWidth, 196});
  chart.dots(few(points), kPointColor);
  chart.level(100 * tolerance_p99, kHighColor, "tolerance of p99");
  chart.line(binned(points, axis, 0.5), kMedianColor, 2.2);
  chart.line(binned(points, axis, 0.99), kHighColor, 2.2);
  chart.marks(axis.nodes);
  const LegendEntry legend[] = {{kPointColor, "a point"}, {kMedianColor, "median"}, {kHighColor, "p99"}};
  return svg_legend(kLeft, 14, legend) + chart.svg() +
         noise_panel(axis, report, {label, axis.low, axis.high});
}

std::string albedo_chart(const VerifyReport& report) {
  std::vector<ChartPoint> points;
  for (const auto& point : report.points) points.push_back({degrees_of(point), point.albedo});
  Chart chart({"theta_i (degrees)", 0, 90}, {"albedo of the table", 0, std::max(1.1, report.energy_max)},
              {kLeft, 10, kFrameWidth, 170});
  chart.dots(few(points), kPointColor);
  chart.level(1, kHighColor, "1: nothing is lost, nothing gained");
  return chart.svg();
}

}  // namespace sunbeam
