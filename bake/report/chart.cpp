#include "bake/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bake/report/markup.h"

namespace sunbeam {
namespace {

constexpr double kTicks = 5;  // about as many on a linear axis

// 1, 2 or 5 times a power of ten.
double round_step(double step) {
  const double power = std::pow(10, std::floor(std::log10(step)));
  const double digit = step / power;
  return power * (digit > 5 ? 10 : digit > 2 ? 5 : digit > 1 ? 2 : 1);
}

std::string path_of(std::string_view data, std::string_view color, double width, double opacity) {
  return fmt::format(
      R"(<path d="{}" fill="none" stroke="{}" stroke-width="{}" stroke-opacity="{}" stroke-linejoin="round" stroke-linecap="round"/>)",
      data, color, width, opacity);
}

std::string svg_element(double width, double height, std::string_view attributes, std::string_view title,
                        std::string_view content) {
  return fmt::format(
      R"(<svg viewBox="0 0 {0:g} {1:g}" width="{0:g}" height="{1:g}" font-family="system-ui, sans-serif" font-size="11" role="img"{2}><title>{3}</title>{4}</svg>)",
      width, height, attributes, escape_markup(title), content);
}

}  // namespace

double ChartAxis::share(double value) const {
  const double share = logarithmic ? std::log(std::max(value, low) / low) / std::log(high / low)
                                   : (value - low) / (high - low);
  return std::clamp(share, 0.0, 1.0);
}

std::vector<double> ChartAxis::ticks() const {
  std::vector<double> ticks;
  if (logarithmic) {
    for (double power = std::round(std::log10(low)); power <= std::log10(high) + 1e-9; ++power)
      ticks.push_back(std::pow(10, power));
    return ticks;
  }
  const double step = round_step((high - low) / kTicks);
  for (double k = std::ceil(low / step - 1e-9); k <= high / step + 1e-9; ++k)
    ticks.push_back(k * step + 0.0);  // no -0
  return ticks;
}

Chart::Chart(ChartAxis x, ChartAxis y, ChartBox box) : x_(std::move(x)), y_(std::move(y)), box_(box) {}

double Chart::px(double x) const { return box_.x + x_.share(x) * box_.width; }
double Chart::py(double y) const { return box_.y + (1 - y_.share(y)) * box_.height; }

// Lines of no length with round ends: a tenth of the bytes of circles.
void Chart::dots(std::span<const ChartPoint> points, std::string_view color) {
  std::string data;
  for (const auto& p : points) data += fmt::format("M{:.1f} {:.1f}h0", px(p.x), py(p.y));
  if (!data.empty()) content_ += path_of(data, color, 3.2, 0.45);
}

void Chart::line(std::span<const ChartPoint> points, std::string_view color, double width, double opacity) {
  std::string data;
  for (const auto& p : points)
    data += fmt::format("{}{:.1f} {:.1f}", data.empty() ? "M" : "L", px(p.x), py(p.y));
  if (!data.empty()) content_ += path_of(data, color, width, opacity);
}

void Chart::level(double y, std::string_view color, std::string_view label) {
  content_ += fmt::format(
      R"(<path d="M{0:.1f} {1:.1f}h{2:.1f}" stroke="{3}" stroke-dasharray="5 4" fill="none"/><text x="{4:.1f}" y="{5:.1f}" text-anchor="end" fill="{3}">{6}</text>)",
      box_.x, py(y), box_.width, color, box_.x + box_.width - 5, py(y) - 4, escape_markup(label));
}

void Chart::marks(std::span<const double> x) {
  std::string data;
  for (const double value : x) data += fmt::format("M{:.1f} {:.1f}v-5", px(value), box_.y + box_.height);
  content_ += path_of(data, "currentColor", 1, 0.7);
}

void Chart::note(std::string_view text) { content_ += svg_text(box_.x + 6, box_.y + 14, "start", text); }

void Chart::picture(std::string_view data_uri) {
  content_ += fmt::format(
      R"(<image x="{:g}" y="{:g}" width="{:g}" height="{:g}" preserveAspectRatio="none" href="{}"/>)", box_.x,
      box_.y, box_.width, box_.height, data_uri);
}

std::string Chart::frame() const {
  std::string grid, labels;
  for (const double tick : x_.ticks()) {
    grid += fmt::format("M{:.1f} {:g}v{:g}", px(tick), box_.y, box_.height);
    labels += svg_text(px(tick), box_.y + box_.height + 14, "middle", fmt::format("{:.4g}", tick));
  }
  for (const double tick : y_.ticks()) {
    grid += fmt::format("M{:g} {:.1f}h{:g}", box_.x, py(tick), box_.width);
    labels += svg_text(box_.x - 6, py(tick) + 4, "end", fmt::format("{:.4g}", tick));
  }
  const double middle = box_.y + box_.height / 2, left = box_.x - 46;
  labels += fmt::format(
      R"svg(<text x="{0:g}" y="{1:g}" text-anchor="middle" fill="currentColor" transform="rotate(-90 {0:g} {1:g})">{2}</text>)svg",
      left, middle, escape_markup(y_.label));
  if (!x_.label.empty())
    labels += svg_text(box_.x + box_.width / 2, box_.y + box_.height + 30, "middle", x_.label);
  return path_of(grid, "currentColor", 1, 0.12) + labels;
}

std::string Chart::svg() const { return frame() + content_; }

std::string svg_text(double x, double y, std::string_view anchor, std::string_view text) {
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="currentColor">{}</text>)", x, y,
                     anchor, escape_markup(text));
}

std::string svg_legend(double x, double y, std::span<const LegendEntry> entries) {
  std::string result;
  for (const auto& [color, name] : entries) {
    result += path_of(fmt::format("M{:.1f} {:.1f}h14", x, y - 4), color, 3, 1);
    result += svg_text(x + 20, y, "start", name);
    x += 40 + 6.2 * static_cast<double>(name.size());
  }
  return result;
}

std::string inline_svg(double width, double height, std::string_view title, std::string_view content) {
  return svg_element(width, height, "", title, content);
}

std::string svg_document(double width, double height, std::string_view title, std::string_view content) {
  const std::string white = R"(<rect width="100%" height="100%" fill="#fff"/>)";
  return svg_element(width, height, R"( xmlns="http://www.w3.org/2000/svg" color="#222")", title,
                     white + std::string(content)) +
         "\n";
}

}  // namespace sunbeam
