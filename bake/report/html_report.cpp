#include "bake/report/html_report.h"

#include <fmt/format.h>

#include "bake/base/version.h"
#include "bake/report/appearance.h"
#include "bake/report/chart.h"
#include "bake/report/error_chart.h"
#include "bake/report/html_style.h"
#include "bake/report/markup.h"
#include "bake/report/polar_chart.h"
#include "bake/report/slice.h"
#include "bake/report/sphere.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr std::size_t kWorstPoints = 6;
constexpr int kSpherePixels = 132, kSliceHeight = 96;

std::string percent(double share) {
  constexpr double kLeast = 1e-8;
  return share > 0 && share < kLeast ? "under 1e-6 %" : fmt::format("{:.3g} %", 100 * share);
}

Markup section(std::string_view id, std::string_view title, const Markup& text, const Markup& content) {
  return format_markup("<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n{}\n</section>\n", id, title, text,
                       content);
}

Markup image(const Image& picture, std::string_view description) {
  return format_markup(R"(<img src="{}" width="{}" height="{}" alt="{}">)", png_data_uri(picture),
                       picture.width, picture.height, description);
}

// A drawing inside a page.
Markup drawing(double width, double height, std::string_view title, std::string_view content) {
  return {inline_svg(width, height, title, content)};
}

Markup in_grid(const Markup& figures) { return format_markup("<div class=\"grid\">\n{}</div>", figures); }

// A parameter point in the words of a caption: what the table sweeps.
std::string describe(const Table& table, const Parameters& parameters) {
  std::string text;
  for (std::size_t k = 0; k < kParameterNames.size(); ++k)
    if (table.parameter_axis(k).size() > 1)
      text +=
          fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", kParameterNames[k], parameters.values()[k]);
  return text.empty() ? "the table's own parameters" : text;
}

// The middle of the table's cell nearest to `share` of the way along an axis: there interpolation is weakest.
double between_nodes(const Axis& axis, double share) {
  if (axis.size() < 2) return axis.low();
  const double wanted = lerp(share, axis.low(), axis.high());
  double nearest = axis.low();
  for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
    const double middle = (axis.nodes[k] + axis.nodes[k + 1]) / 2;
    if (k == 0 || std::abs(middle - wanted) < std::abs(nearest - wanted)) nearest = middle;
  }
  return nearest;
}

// Different middles of cells along an axis, rising.
std::vector<double> stops(const Axis& axis, std::vector<double> shares) {
  std::vector<double> values;
  for (const double share : shares)
    if (const double value = between_nodes(axis, share); values.empty() || value > values.back())
      values.push_back(value);
  return values;
}

// Three thicknesses at two indices, absorption as the table has it by default.
std::vector<Parameters> showcase(const Table& table) {
  const Axis& absorption = table.parameter_axis(2);
  const double sigma = std::clamp(table.material.absorption_per_nm, absorption.low(), absorption.high());
  std::vector<Parameters> result;
  for (const double ior : stops(table.parameter_axis(1), {0.2, 0.8}))
    for (const double thickness : stops(table.parameter_axis(0), {0.15, 0.5, 0.85}))
      result.push_back({thickness, ior, sigma});
  return result;
}

Markup card(std::string_view id, std::string_view label, double value, std::string_view shown,
            std::string_view note) {
  return format_markup(
      R"(<div class="card"><span>{}</span><data id="{}" value="{}">{}</data><small>{}</small></div>)", label,
      id, to_text(value), shown, note);
}

Markup cards(const ReportSource& source) {
  const auto& [table, recipe, settings, report, name, bytes, command] = source;
  const auto allowed = [](double tolerance) { return "allowed " + percent(tolerance); };
  return Markup{"<div class=\"cards\">\n"} +
         card("error_median", "median error", report.error.median, percent(report.error.median),
              allowed(settings.tolerance_median)) +
         card("error_p95", "95th percentile", report.error.p95, percent(report.error.p95), "") +
         card("error_p99", "99th percentile", report.error.p99, percent(report.error.p99),
              allowed(settings.tolerance_p99)) +
         card("error_max", "largest", report.error.max, percent(report.error.max), "") +
         card("error_textured_median", "median, textured", report.textured_error.median,
              percent(report.textured_error.median), "parameters from textures") +
         card("error_textured_p99", "99th percentile, textured", report.textured_error.p99,
              percent(report.textured_error.p99), "parameters from textures") +
         card("noise_floor", "noise floor, median", report.noise_floor.median,
              percent(report.noise_floor.median), "of the comparison") +
         card("points", "random points", static_cast<double>(report.points.size()),
              std::to_string(report.points.size()), "between the grid's nodes") +
         Markup{"\n</div>\n"};
}

Markup summary(const ReportSource& source) {
  const bool passed = within_tolerance(source.report, source.settings);
  return format_markup(
             "<header id=\"summary\">\n<p class=\"badge {}\">{}</p>\n<h1>{}</h1>\n"
             "<p class=\"lead\">A table of {} bytes against live evaluation "
             "(<code id=\"truth\">{}</code>).</p>\n",
             passed ? "pass" : "fail", passed ? "PASS" : "FAIL", source.table_name, source.table_bytes,
             source.report.truth) +
         cards(source) + Markup{"</header>\n"};
}

Markup error_section(const ReportSource& source) {
  Markup figures;
  for (const auto& axis : error_axes(source.table, source.report))
    figures += format_markup("<figure>{}</figure>\n",
                             drawing(kErrorChartWidth, kErrorChartHeight, "Error over " + axis.name,
                                     error_chart(axis, source.report, source.settings.tolerance_p99)));
  return section(
      "error", "Where the error lies",
      {"Error of a point: the absolute difference between table and live, times the cosine, over "
       "all outgoing directions, as a share of the live reflection. Below, apart, the noise of the "
       "comparison itself: how far two live runs differ. What stands above it is the table's. Ticks "
       "on the lower edge are the table's nodes. Parameters that the table holds fixed are left out."},
      in_grid(figures));
}

std::vector<VerifyPoint> worst_points(const VerifyReport& report) {
  auto points = report.points;
  const std::size_t count = std::min(kWorstPoints, points.size());
  std::partial_sort(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), points.end(),
                    [](const auto& a, const auto& b) { return a.error > b.error; });
  points.resize(count);
  return points;
}

Markup worst_row(std::size_t rank, const VerifyPoint& p) {
  return format_markup(
      "<tr><td>{}</td><td>{:.2f}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.2f}</td><td>{:.2f}</td>"
      "<td>{}</td><td>{}</td><td>{:.2g}</td></tr>\n",
      rank, p.parameters.film_thickness_nm, p.parameters.base_ior, p.parameters.absorption_per_nm,
      std::acos(p.cos_i) * 180 / kPi, p.phi_i * 180 / kPi, percent(p.error), percent(p.noise_floor),
      p.dirac_error);
}

Markup worst_plot(const ReportSource& source, std::size_t rank, const VerifyPoint& p) {
  const TableAppearance table(source.table, p.parameters, OutsideGrid::clamp);
  const LiveAppearance live(table.material(), source.recipe.spectrum, kCurveEstimates);
  const std::string caption =
      fmt::format("{}: {}, theta_i {:.1f}\u00b0, error {}", rank, describe(source.table, p.parameters),
                  std::acos(p.cos_i) * 180 / kPi, percent(p.error));
  return format_markup("<figure>{}<figcaption>{}</figcaption></figure>\n",
                       drawing(kPolarWidth, kPolarHeight, caption,
                               polar_chart(table, live, direction_from_cosine(p.cos_i, p.phi_i))),
                       caption);
}

Markup worst_section(const ReportSource& source) {
  Markup rows, plots;
  std::size_t rank = 0;
  for (const auto& point : worst_points(source.report)) {
    rows += worst_row(++rank, point);
    plots += worst_plot(source, rank, point);
  }
  return section(
      "worst", "The worst points",
      format_markup(
          "BRDF times cosine in the plane of incidence, linear Rec.709; the radius is the square root "
          "of the value. The grey ray is the light, a dashed one a smooth film's mirror direction. "
          "Live: {}.",
          live_method(source.table.material, kCurveEstimates)),
      format_markup(
          "<div class=\"wide\"><table>\n<thead><tr><th></th><th>film_thickness_nm</th><th>base_ior</th>"
          "<th>absorption_per_nm</th><th>theta_i (\u00b0)</th><th>phi_i (\u00b0)</th><th>error</th>"
          "<th>noise</th><th>Dirac error</th></tr></thead>\n<tbody>\n{}"
          "</tbody>\n</table></div>\n{}",
          rows, in_grid(plots)));
}

Markup slices_section(const ReportSource& source) {
  const auto points = showcase(source.table);
  const int threads = source.settings.threads;
  std::vector<Image> slices;
  double peak = 1e-12;
  for (const Parameters& p : points) {
    slices.push_back(
        slice_image(TableAppearance(source.table, p, OutsideGrid::clamp), kSliceHeight, threads));
    peak = std::max(peak, brightest(slices.back()));
  }
  Markup figures;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::string caption = describe(source.table, points[k]);
    figures += format_markup("<figure>{}<figcaption>{}</figcaption></figure>\n",
                             image(scaled(slices[k], 1 / peak), "Slice at " + caption), caption);
  }
  return section(
      "slices", "Below the film",
      format_markup("The table's <code>rest</code>, all light that has been below the film, times pi: "
                    "theta_o from -90\u00b0 (the side of the light) to 90\u00b0 (the mirror side) to "
                    "the right, theta_i from 0 to 90\u00b0 upwards. All pictures are scaled alike; "
                    "white stands for {:.3g}.",
                    peak),
      in_grid(figures));
}

struct SpherePair {
  Image table, live;
};

Image difference(const SpherePair& pair) {
  Image result = pair.table;
  for (std::size_t k = 0; k < result.rgb.size(); ++k)
    result.rgb[k] = std::abs(pair.table.rgb[k] - pair.live.rgb[k]);
  return result;
}

// 1, 2 or 5 times a power of ten that takes `largest` to no more than 1.
double amplification(double largest) {
  double factor = 1;
  for (int digit = 0; factor < 1e5; ++digit) {
    const double next = factor * (digit % 3 == 1 ? 2.5 : 2);
    if (next * largest > 1) break;
    factor = next;
  }
  return factor;
}

Markup sphere_row(const SpherePair& pair, double factor, const std::string& caption) {
  return format_markup("<figure><div class=\"trio\">{}{}{}</div><figcaption>{}</figcaption></figure>\n",
                       image(pair.table, "Sphere from the table, " + caption),
                       image(pair.live, "Sphere from the live model, " + caption),
                       image(scaled(difference(pair), factor), "Amplified difference, " + caption), caption);
}

Markup spheres_section(const ReportSource& source) {
  const auto points = showcase(source.table);
  const int threads = source.settings.threads;
  std::vector<SpherePair> pairs;
  double largest = 0;
  for (const Parameters& p : points) {
    const TableAppearance table(source.table, p, OutsideGrid::clamp);
    const LiveAppearance live(table.material(), source.recipe.spectrum, kPictureEstimates);
    pairs.push_back(
        {sphere_image(table, kSpherePixels, threads), sphere_image(live, kSpherePixels, threads)});
    largest = std::max(largest, brightest(difference(pairs.back())));
  }
  const double factor = amplification(largest);
  Markup figures;
  for (std::size_t k = 0; k < points.size(); ++k)
    figures += sphere_row(pairs[k], factor, describe(source.table, points[k]));
  return section(
      "spheres", "On a sphere",
      format_markup("Table, live, and their difference times {:g}, under one light and a grey sky; "
                    "parameters half-way between nodes, where interpolation is weakest. Live: {}.",
                    factor, live_method(source.table.material, kPictureEstimates)),
      in_grid(figures));
}

Markup energy_section(const ReportSource& source) {
  const VerifyReport& report = source.report;
  return section(
      "energy", "Energy and reciprocity",
      {"A surface sends back no more than it receives, and the same whichever way light travels."},
      Markup{"<div class=\"cards\">\n"} +
          card("energy_max", "largest albedo", report.energy_max, fmt::format("{:.4g}", report.energy_max),
               report.energy_max <= 1 ? "below 1" : "above 1") +
          card("reciprocity_max", "largest asymmetry", report.reciprocity_max,
               fmt::format("{:.2g}", report.reciprocity_max), "of f(wi, wo) and f(wo, wi), relative") +
          card("dirac_error_p99", "film reflectance error, p99", report.dirac_error_p99,
               fmt::format("{:.2g}", report.dirac_error_p99), "absolute") +
          card("rest_error_median", "error below the film, median", report.rest_error.median,
               percent(report.rest_error.median), "p99 " + percent(report.rest_error.p99)) +
          format_markup(
              "\n</div>\n<figure>{}</figure>",
              drawing(kAlbedoChartWidth, kAlbedoChartHeight, "Albedo over theta_i", albedo_chart(report))));
}

Markup material_rows(const Table& table) {
  Markup rows;
  for (const auto& key : material_keys())
    if (is_in_tables(key, table.schema_version))
      rows += format_markup("<tr><th>{}</th><td>{}</td></tr>\n", key, get_text(table.material, key));
  return rows;
}

Markup provenance_section(const ReportSource& source) {
  const auto& info = source.table.info;
  return section(
      "provenance", "Where this comes from",
      format_markup(
          "Written by sunbeam {}; the table by sunbeam {}, seed {}, {} estimates. To write this page "
          "again:",
          kToolVersion, info.at("tool_version"), info.at("seed"), info.at("samples")),
      format_markup("<pre id=\"command\">{}</pre>\n<details><summary>Material</summary>\n<div "
                    "class=\"wide\"><table class=\"keys\">\n<tbody>\n{}</tbody>\n</table></div></details>\n"
                    "<details><summary>Recipe {}</summary>\n<pre id=\"recipe\">{}</pre></details>",
                    source.command, material_rows(source.table), source.recipe.hash, source.recipe.text));
}

}  // namespace

std::string html_report(const ReportSource& source) {
  const Markup body = summary(source) + spheres_section(source) + error_section(source) +
                      worst_section(source) + slices_section(source) + energy_section(source) +
                      provenance_section(source);
  return format_markup(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
             "<style>\n{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
             source.table_name + ": verification", Markup{kHtmlStyle}, body)
      .text;
}

}  // namespace sunbeam
