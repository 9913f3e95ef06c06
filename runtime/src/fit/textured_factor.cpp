#include "runtime/src/fit/textured_factor.h"

#include <cmath>

#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastShare = 0.01;  // of the channels' mean: a folded colour may pass through 0
// Of L. At grazing a pigment of many colours would leave it with poles, where no light is left.
constexpr double kLeastLog = -80, kMostLog = 20;
constexpr double kLeastChance = 0.02;  // of either technique: their estimates may be far off
constexpr double kLeastValue = 1e-18;  // of B over its frame

// Of a node in the mean over the quadrant, by trapezoids.
double phi_share(int p, int phis) {
  if (phis == 1) return 1;
  return (p == 0 || p == phis - 1 ? 0.5 : 1.0) / (phis - 1);
}

}  // namespace

TexturedFactor::TexturedFactor(const TexturedWaves& waves, const TexturedMedia& media, bool is_product)
    : waves_(waves), media_(media), grid_(waves.grid()), is_product_(is_product) {
  take_cosines();
  take_quadrature();
  for (int d = 0; d < grid_.axes[0].size(); ++d) weigh(d);
}

void TexturedFactor::take_cosines() {
  const Material& material = waves_.field().material();
  const FilmCosines film(material);
  const PigmentCosines pigment(film, material.base_ior, material.optical_depth());
  for (int c = 0; c < kCosines; ++c) {
    const auto cosine = static_cast<float>(grid_.cosine(c));
    film_cosines_[c] = std::min(std::sqrt(film.film_cosine_squared(cosine)), 1.0f);
    per_pigment_cosine_[c] = 1 / std::sqrt(pigment.pigment_cosine_squared(cosine));
  }
}

// Trapezoids in the root: cos dw = 4 pi u^3 du. Relative to the least decay at normal incidence, so that no
// pigment makes an integral vanish.
void TexturedFactor::take_quadrature() {
  for (int c = 0; c < kCosines; ++c) {
    const double root = static_cast<double>(c) / (kCosines - 1), end = c == kCosines - 1 ? 0.5 : 1;
    quadrature_[c] = 4 * kPi / (kCosines - 1) * end * root * root * root *
                     std::exp(waves_.least_decay(kCosines - 1) - waves_.least_decay(c));
  }
}

// Int A cos dw.
double TexturedFactor::hemispherical(const float* values) const {
  double sum = 0;
  for (int p = 0; p < grid_.phis; ++p)
    for (int c = 0; c < kCosines; ++c)
      sum += phi_share(p, grid_.phis) * quadrature_[c] * double{values[p * kCosines + c]};
  return sum;
}

void TexturedFactor::weigh(int d) {
  const auto columns = static_cast<std::size_t>(grid_.columns());
  const Wavelengths& wavelengths = waves_.field().wavelengths();
  shares_.push_back(waves_.at_thickness(d));
  Rgb norm;
  for (std::size_t k = 0; k < wavelengths.size(); ++k) {
    const double gain = waves_.gain(d, k), arriving = hemispherical(shares_.back().data() + k * columns);
    weights_.push_back(gain * arriving);
    norm += gain * arriving * arriving * wavelengths.weight[k];
  }
  norms_.push_back(norm);
}

std::vector<Color4> TexturedFactor::nodes() const {
  std::vector<Color4> nodes(static_cast<std::size_t>(grid_.paths * grid_.columns()));
  for (int p = 0; p < grid_.paths; ++p) fold(p, nodes.data() + p * grid_.columns());
  return nodes;
}

FloatRgb TexturedFactor::reflectance(double thickness_nm, int c) const {
  FloatRgb reflectance;
  media_.film.fold(thickness_nm, waves_.field().material().base_ior, {&film_cosines_[c], 1}, &reflectance);
  return reflectance;
}

void TexturedFactor::fold(int p, Color4* to) const {
  const auto columns = static_cast<std::size_t>(grid_.columns());
  const Wavelengths& wavelengths = waves_.field().wavelengths();
  const std::vector<float> shares = waves_.at_path(p);
  for (int c = 0; c < kCosines; ++c) {
    const double thickness = waves_.thickness_nm(p, c);
    const EvenAxis& axis = grid_.axes[0];
    const EvenPosition d = axis.locate(axis.clamped(thickness));
    const double upper{d.upper_weight};
    const double* weights = weights_.data() + d.lower * wavelengths.size();
    const Rgb norm = (1 - upper) * norms_[d.lower] + upper * norms_[d.lower + 1];
    const FloatRgb reflectance = this->reflectance(thickness, c);
    for (std::size_t column = c; column < columns; column += kCosines) {
      Rgb b;
      for (std::size_t k = 0; k < wavelengths.size(); ++k)
        b += lerp(upper, weights[k], weights[k + wavelengths.size()]) * double{shares[k * columns + column]} *
             wavelengths.weight[k];
      to[column] = node(b, norm, c, reflectance);
    }
  }
}

// `b` is the rest's directional albedo, `norm` its hemispherical integral; both without the least decay.
Color4 TexturedFactor::node(const Rgb& b, const Rgb& norm, int c, const FloatRgb& reflectance) const {
  const Color4 passing = this->passing(c, reflectance);
  Color4 result{};
  for (int channel = 0; channel < 3; ++channel) {
    const double albedo = std::max({b[channel], kLeastShare * mean(b), kLeastValue});
    const double scale = std::sqrt(std::max({norm[channel], kLeastShare * mean(norm), square(kLeastValue)}));
    const double decay = waves_.least_decay(c) - this->decay(channel, c);
    const double value = std::log(albedo / scale / double{passing[channel]}) - decay;
    result[channel] = static_cast<float>(std::clamp(value, kLeastLog, kMostLog));
  }
  result[3] = static_cast<float>(first_chance(reflectance, mean(b), c));
  return result;
}

Rgb TexturedFactor::value(const std::vector<Color4>& nodes, int d, int c, int column) const {
  const double thickness = grid_.axes[0].node(d);
  const auto path = static_cast<float>(textured_path(waves_.field().material(), grid_.cosine(c)));
  const EvenPosition at = grid_.locate_path(static_cast<float>(thickness), path);
  const Color4* lower = nodes.data() + at.lower * grid_.columns() + column;
  const Rgb logs = to_rgb(lower[0] + at.upper_weight * (lower[grid_.columns()] - lower[0]));
  const Rgb passing = to_rgb(this->passing(c, reflectance(thickness, c)));
  Rgb b;
  for (int channel = 0; channel < 3; ++channel)
    b[channel] = std::exp(logs[channel] + waves_.least_decay(c) - decay(channel, c)) * passing[channel];
  return b;
}

// a tau / m~.
double TexturedFactor::decay(int channel, int c) const {
  return waves_.field().material().optical_depth() * double{media_.absorption[channel]} *
         per_pigment_cosine_[c];
}

Color4 TexturedFactor::passing(int c, const FloatRgb& reflectance) const {
  return waves_.field().material().is_smooth() ? media_.passing(reflectance)
                                               : FilmCosines::passing(film_cosines_[c]) + Color4{};
}

double TexturedFactor::first_chance(const FloatRgb& r, double rest, int c) const {
  const Material& material = waves_.field().material();
  const double of_first = std::max(0.0, double{r.r + r.g + r.b} / 3);
  double of_rest = std::max(0.0, rest) * std::exp(-waves_.least_decay(c) - waves_.least_decay(kCosines - 1));
  if (is_product_)  // the bracket, without X, at a mean cosine of the light
    of_rest *= one_visit_of_product(material.optical_depth() * double{media_.absorption[3]},
                                    material.cosine_below(grid_.cosine(c)), material.cosine_below(2.0 / 3));
  return std::clamp(of_first / (of_first + of_rest + kLeastValue), kLeastChance, 1 - kLeastChance);
}

}  // namespace v1
}  // namespace sunbeam
