#include "bake/compare/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "runtime/tracer/image_io.h"
#include "sunbeam/core/color_space.h"

namespace sunbeam {
namespace {

// Names and numbers of the paper: section 4.1 (contrast sensitivity, table 1), 4.2 (colour), 4.3 (features).
constexpr double kColorExponent = 0.7, kFeatureExponent = 0.5;  // q_c, q_f
constexpr double kCenter = 0.4, kTop = 0.95;                    // p_c, p_t of the remapping
constexpr double kFeatureWidthDeg = 0.082;                      // w, peak to trough of the detectors

// A term a sqrt(pi / b) exp(-pi^2 x^2 / b) of a contrast sensitivity in space, x in degrees.
struct CsfTerm {
  double a, b;
};
constexpr std::array<CsfTerm, 1> kAchromatic = {{{1, 0.0047}}};
constexpr std::array<CsfTerm, 1> kRedGreen = {{{1, 0.0053}}};
constexpr std::array<CsfTerm, 2> kBlueYellow = {{{34.1, 0.04}, {13.5, 0.025}}};
constexpr double kWidestB = 0.04;

// One number for each pixel.
struct Plane {
  int width, height;
  std::vector<double> values;

  Plane(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  double* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const double* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

// Weights for offsets -radius to radius.
using Kernel = std::vector<double>;
int radius_of(const Kernel& kernel) { return static_cast<int>(kernel.size() / 2); }

template <class F>
Kernel make_kernel(int radius, F weight) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(weight(double(x)));
  return kernel;
}

double sum(const Kernel& kernel) {
  double total = 0;
  for (const double w : kernel) total += w;
  return total;
}

// Positive weights then sum to 1 and negative ones, if any, to -1.
Kernel normalized(Kernel kernel) {
  double positive = 0, negative = 0;
  for (const double w : kernel) (w > 0 ? positive : negative) += w;
  for (double& w : kernel) w /= w > 0 ? positive : -negative;
  return kernel;
}

Plane filter_rows(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const int radius = radius_of(kernel);
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      double total = 0;
      for (int k = -radius; k <= radius; ++k)
        total += kernel[static_cast<std::size_t>(k + radius)] * in.row(y)[std::clamp(x + k, 0, in.width - 1)];
      out.row(y)[x] = total;
    }
  return out;
}

Plane filter_columns(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const int radius = radius_of(kernel);
  for (int y = 0; y < in.height; ++y)
    for (int k = -radius; k <= radius; ++k) {
      const double w = kernel[static_cast<std::size_t>(k + radius)];
      const double* from = in.row(std::clamp(y + k, 0, in.height - 1));
      for (int x = 0; x < in.width; ++x) out.row(y)[x] += w * from[x];
    }
  return out;
}

// Filters end at three standard deviations.
int csf_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3 * std::sqrt(kWidestB / (2 * kPi * kPi)) * pixels_per_degree));
}
double feature_sigma(double pixels_per_degree) { return 0.5 * kFeatureWidthDeg * pixels_per_degree; }
int feature_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3 * feature_sigma(pixels_per_degree)));
}

// The terms are Gaussians, so that each is a filter along rows and one along columns.
Plane filter_csf(const Plane& in, std::span<const CsfTerm> terms, double pixels_per_degree) {
  const int radius = csf_radius(pixels_per_degree);
  Plane out(in.width, in.height);
  double total = 0;
  for (const CsfTerm& term : terms) {
    const Kernel kernel = make_kernel(
        radius, [&](double x) { return std::exp(-square(kPi * x / pixels_per_degree) / term.b); });
    const double amplitude = term.a * std::sqrt(kPi / term.b);
    const Plane filtered = filter_columns(filter_rows(in, kernel), kernel);
    for (std::size_t k = 0; k < out.values.size(); ++k) out.values[k] += amplitude * filtered.values[k];
    total += amplitude * square(sum(kernel));
  }
  for (double& value : out.values) value /= total;
  return out;
}

// Rec.709 and its white.
struct Colorimetry {
  ColorMatrix to_xyz = rgb_to_xyz(ColorSpace::rec709), from_xyz = inverse(to_xyz);
  Vec3 white = sunbeam::white(ColorSpace::rec709);

  // Tristimulus values relative to white.
  Vec3 relative(const Rgb& rgb) const {
    const Vec3 xyz = to_xyz * Vec3{rgb.r, rgb.g, rgb.b};
    return {xyz.x / white.x, xyz.y / white.y, xyz.z / white.z};
  }
  Rgb rgb(const Vec3& relative) const {
    return from_xyz * Rgb{relative.x * white.x, relative.y * white.y, relative.z * white.z};
  }
};

// Relative tristimulus values as lightness and two opponents: L*a*b* if they passed its cube root, the linear
// YyCxCz if not; and back.
Vec3 opponents(const Vec3& t) { return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)}; }
Vec3 from_opponents(const Vec3& o) {
  const double y = (o.x + 16) / 116;
  return {y + o.y / 500, y, y - o.z / 200};
}

double lab_root(double t) {
  constexpr double kDelta = 6.0 / 29;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
}

// L*a*b* whose chroma shrinks with lightness (Hunt's effect).
Vec3 hunt_lab(const Colorimetry& colorimetry, const Rgb& rgb) {
  const Vec3 t = colorimetry.relative(rgb);
  const Vec3 lab = opponents({lab_root(t.x), lab_root(t.y), lab_root(t.z)});
  return {lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z};
}

double hyab(const Vec3& a, const Vec3& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

// What both pipelines need of one picture.
struct Appearance {
  std::vector<Vec3> lab;              // after the contrast sensitivities
  std::vector<double> edges, points;  // strength of features
};

// Strength of what a detector finds along x and along y.
std::vector<double> features(const Plane& lightness, const Kernel& detector, const Kernel& blur) {
  const Plane x = filter_columns(filter_rows(lightness, detector), blur);
  const Plane y = filter_rows(filter_columns(lightness, detector), blur);
  std::vector<double> strength;
  for (std::size_t k = 0; k < x.values.size(); ++k) strength.push_back(std::hypot(x.values[k], y.values[k]));
  return strength;
}

void add_features(Appearance& result, Plane lightness, double pixels_per_degree) {
  for (double& value : lightness.values) value = (value + 16) / 116;
  const double sigma = feature_sigma(pixels_per_degree);
  const int radius = feature_radius(pixels_per_degree);
  const auto gaussian = [&](double x) { return std::exp(-square(x / sigma) / 2); };
  const Kernel blur = normalized(make_kernel(radius, gaussian));
  const Kernel edge = normalized(make_kernel(radius, [&](double x) { return -x * gaussian(x); }));
  const Kernel point =
      normalized(make_kernel(radius, [&](double x) { return (square(x / sigma) - 1) * gaussian(x); }));
  result.edges = features(lightness, edge, blur);
  result.points = features(lightness, point, blur);
}

Appearance appearance(const Image& image, double pixels_per_degree, const Colorimetry& colorimetry) {
  Plane y(image.width, image.height), cx = y, cz = y;
  for (int row = 0; row < image.height; ++row)
    for (int x = 0; x < image.width; ++x) {
      const Vec3 o = opponents(colorimetry.relative(image.get(x, row)));
      y.row(row)[x] = o.x;
      cx.row(row)[x] = o.y;
      cz.row(row)[x] = o.z;
    }
  Appearance result;
  add_features(result, y, pixels_per_degree);
  y = filter_csf(y, kAchromatic, pixels_per_degree);
  cx = filter_csf(cx, kRedGreen, pixels_per_degree);
  cz = filter_csf(cz, kBlueYellow, pixels_per_degree);
  for (std::size_t k = 0; k < y.values.size(); ++k) {
    const Rgb rgb = colorimetry.rgb(from_opponents({y.values[k], cx.values[k], cz.values[k]}));
    result.lab.push_back(
        hunt_lab(colorimetry, transform(rgb, [](double c) { return std::clamp(c, 0.0, 1.0); })));
  }
  return result;
}

// Of the exponentiated distance of two colours, `most` being that of green and blue, the farthest apart.
double remapped(double distance, double most) {
  const double center = kCenter * most;
  if (distance < center) return kTop * distance / center;
  return kTop + (1 - kTop) * (distance - center) / (most - center);
}

std::vector<double> flip_at_once(const Image& test, const Image& reference, double pixels_per_degree) {
  const Colorimetry colorimetry;
  const Appearance a = appearance(test, pixels_per_degree, colorimetry);
  const Appearance b = appearance(reference, pixels_per_degree, colorimetry);
  const auto distance = [](const Vec3& x, const Vec3& y) { return std::pow(hyab(x, y), kColorExponent); };
  const double most = distance(hunt_lab(colorimetry, {0, 1, 0}), hunt_lab(colorimetry, {0, 0, 1}));
  std::vector<double> values;
  for (std::size_t k = 0; k < a.lab.size(); ++k) {
    const double color = remapped(distance(a.lab[k], b.lab[k]), most);
    const double feature = std::max(std::abs(a.edges[k] - b.edges[k]), std::abs(a.points[k] - b.points[k])) /
                           std::numbers::sqrt2;
    values.push_back(std::pow(color, 1 - std::pow(feature, kFeatureExponent)));
  }
  return values;
}

// Rows first to last, last left out; those beyond a border are the outermost ones.
Image rows_of(const Image& image, int first, int last) {
  Image rows(image.width, last - first);
  const std::size_t size = 3 * static_cast<std::size_t>(image.width);
  for (int y = first; y < last; ++y)
    std::copy_n(image.rgb.data() + size * static_cast<std::size_t>(std::clamp(y, 0, image.height - 1)), size,
                rows.rgb.data() + size * static_cast<std::size_t>(y - first));
  return rows;
}

}  // namespace

// Bands of rows bound the memory. No filter reaches farther than the rows that are added above and below.
std::vector<double> flip(const Image& test, const Image& reference, double pixels_per_degree) {
  constexpr int kRows = 128;
  const int reach = std::max(csf_radius(pixels_per_degree), feature_radius(pixels_per_degree));
  const auto width = static_cast<std::ptrdiff_t>(test.width);
  std::vector<double> values;
  values.reserve(test.rgb.size() / 3);
  for (int y = 0; y < test.height; y += kRows) {
    const int rows = std::min(kRows, test.height - y), first = y - reach, last = y + rows + reach;
    const std::vector<double> band =
        flip_at_once(rows_of(test, first, last), rows_of(reference, first, last), pixels_per_degree);
    values.insert(values.end(), band.begin() + reach * width, band.begin() + (reach + rows) * width);
  }
  return values;
}

Image displayed(const Image& image) {
  Image result(image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      result.set(x, y, display_color(clip_negative(image.get(x, y), ColorSpace::rec709).clipped));
  return result;
}

}  // namespace sunbeam
