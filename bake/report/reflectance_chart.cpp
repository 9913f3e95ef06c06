#include "bake/report/reflectance_chart.h"

#include <fmt/format.h>

#include "bake/base/parallel_tasks.h"
#include "bake/report/appearance.h"
#include "bake/report/chart.h"
#include "bake/report/markup.h"

namespace sunbeam {
namespace {

constexpr int kColumns = 240, kRows = 120;
constexpr std::size_t kCurvePoints = 181;
constexpr double kLeft = 60, kFrameWidth = 480;

// One thickness still makes a strip: its neighbours are copies.
std::pair<double, double> thickness_range(const Axis& axis) {
  return axis.size() > 1 ? std::pair(axis.low(), axis.high()) : std::pair(axis.low() - 1, axis.low() + 1);
}

Image color_map(const Table& table, Parameters parameters) {
  const auto [low, high] = thickness_range(table.parameter_axis(0));
  const int different = table.parameter_axis(0).size() > 1 ? kColumns : 1;
  Image image(kColumns, kRows);
  run_parallel_tasks(static_cast<std::size_t>(different), 0, {}, [&](std::size_t column) {
    Parameters at = parameters;
    at.film_thickness_nm = lerp((static_cast<double>(column) + 0.5) / kColumns, low, high);
    const TableAppearance film(table, at, OutsideGrid::clamp);
    for (int y = 0; y < kRows; ++y)
      image.set(static_cast<int>(column), y,
                film.film_reflectance(std::cos((1 - (y + 0.5) / kRows) * kPi / 2)));
  });
  for (int column = different; column < kColumns; ++column)
    for (int y = 0; y < kRows; ++y) image.set(column, y, image.get(0, y));
  return image;
}

double curve_degrees(std::size_t k) { return 90.0 * static_cast<double>(k) / (kCurvePoints - 1); }

std::vector<Rgb> reflectances(const TableAppearance& film) {
  std::vector<Rgb> values;
  for (std::size_t k = 0; k < kCurvePoints; ++k)
    values.push_back(film.film_reflectance(std::cos(curve_degrees(k) * kPi / 180)));
  return values;
}

}  // namespace

std::string reflectance_chart(const Table& table, const Parameters& parameters) {
  const TableAppearance film(table, parameters, OutsideGrid::refuse);
  const auto [low, high] = thickness_range(table.parameter_axis(0));
  Chart map({"film_thickness_nm (nm)", low, high}, {"theta (degrees)", 0, 90}, {kLeft, 16, kFrameWidth, 190});
  map.picture(png_data_uri(color_map(table, parameters)));

  // Colours outside Rec.709 leave 0 to 1.
  const std::vector<Rgb> values = reflectances(film);
  double lowest = 0, highest = 1;
  for (const Rgb& value : values) {
    lowest = std::min({lowest, value.r, value.g, value.b});
    highest = std::max(highest, max_component(value));
  }
  Chart curves({"theta (degrees)", 0, 90}, {"reflectance", lowest, highest}, {kLeft, 276, kFrameWidth, 190});
  for (int c = 0; c < 3; ++c) {
    std::vector<ChartPoint> points;
    for (std::size_t k = 0; k < values.size(); ++k) points.push_back({curve_degrees(k), values[k][c]});
    curves.line(points, kRgbColors[c], 2);
  }
  curves.note(fmt::format("film_thickness_nm {:g}, base_ior {:g}", parameters.film_thickness_nm,
                          parameters.base_ior));
  const LegendEntry channels[] = {{kRgbColors[0], "R"}, {kRgbColors[1], "G"}, {kRgbColors[2], "B"}};
  return map.svg() + curves.svg() + svg_legend(kLeft, kReflectanceHeight - 8, channels);
}

}  // namespace sunbeam
