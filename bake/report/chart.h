// This file draws line and scatter charts as SVG fragments. Frame and text take the colour of their
// surroundings (currentColor), so that a chart suits a light page and a dark one.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {

// These colours are readable on white and on near-black.
inline constexpr std::string_view kRgbColors[3] = {"#e5484d", "#30a46c", "#3e82f7"};
inline constexpr std::string_view kPointColor = "#7c8db5";
inline constexpr std::string_view kMedianColor = "#3e82f7";
inline constexpr std::string_view kHighColor = "#e5783a";  // of a high quantile, and of limits

struct ChartAxis {
  std::string label;
  double low, high;
  bool logarithmic = false;

  double share(double value) const;  // of the way from low to high; clamped to it
  std::vector<double> ticks() const;
};

struct ChartPoint {
  double x, y;
};

struct ChartBox {
  double x, y, width, height;  // of the frame; labels stand outside it
};

class Chart {
 public:
  Chart(ChartAxis x, ChartAxis y, ChartBox box);

  void dots(std::span<const ChartPoint> points, std::string_view color);
  void line(std::span<const ChartPoint> points, std::string_view color, double width = 1.6,
            double opacity = 1);
  void level(double y, std::string_view color, std::string_view label);  // across the whole chart
  void marks(std::span<const double> x);                                 // short ones on the lower edge
  void note(std::string_view text);                                      // inside, top left
  void picture(std::string_view data_uri);                               // fills the frame

  std::string svg() const;

 private:
  double px(double x) const;
  double py(double y) const;
  std::string frame() const;

  ChartAxis x_, y_;
  ChartBox box_;
  std::string content_;
};

// Returns one text; `anchor` is start, middle or end.
std::string svg_text(double x, double y, std::string_view anchor, std::string_view text);
// A legend shows a short coloured line and its name for each entry, in one row that starts at (x, y).
struct LegendEntry {
  std::string_view color, name;
};
std::string svg_legend(double x, double y, std::span<const LegendEntry> entries);

// Returns a fragment for use inside a page; `title` is what a screen reader says.
std::string inline_svg(double width, double height, std::string_view title, std::string_view content);
// Returns the same as a file of its own, on white.
std::string svg_document(double width, double height, std::string_view title, std::string_view content);

}  // namespace sunbeam
