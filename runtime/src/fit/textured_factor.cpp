#include "runtime/src/fit/textured_factor.h"

#include <cmath>

#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastShare = 0.01;  // of the channels' mean: a folded colour may pass through 0
// Of L. At grazing a pigment of many colours would leave it with poles, where no light is left.
constexpr double kLeastLog = -80, kMostLog = 20;
constexpr double kLeastChance = 0.02;   // of either technique: their estimates may be far off
constexpr double kLeastValue = 1e-18;   // of B over its frame
constexpr double kLeastScale = 1e-150;  // of B, which is divided by twice

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
  const FilmCosines film(material, grid_.is_warped);
  const PigmentCosines pigment(film, material.base_ior, material.optical_depth());
  for (int c = 0; c < cosines(); ++c) {
    const auto cosine = static_cast<float>(waves_.cosine(c));
    film_cosines_.push_back(std::min(std::sqrt(film.film_cosine_squared(cosine)), 1.0f));
    per_pigment_cosine_.push_back(1 / std::sqrt(pigment.pigment_cosine_squared(cosine)));
  }
}

// Trapezoids. Relative to the least decay at normal incidence, so that no pigment makes an integral vanish.
void TexturedFactor::take_quadrature() {
  const int last = cosines() - 1;
  for (int c = 0; c <= last; ++c) {
    const double end = c == 0 || c == last ? 0.5 : 1;
    quadrature_.push_back(end / last * waves_.measure(c) *
                          std::exp(waves_.least_decay(last) - waves_.least_decay(c)));
  }
}

// Int A cos dw.
double TexturedFactor::hemispherical(const float* values) const {
  double sum = 0;
  for (int p = 0; p < grid_.phis; ++p)
    for (int c = 0; c < cosines(); ++c)
      sum += phi_share(p, grid_.phis) * quadrature_[c] * double{values[p * cosines() + c]};
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
  for (int c = 0; c < cosines(); ++c) {
    const double thickness = waves_.thickness_nm(p, c);
    const EvenAxis& axis = grid_.axes[0];
    const EvenPosition d = axis.locate(axis.clamped(thickness));
    const double upper{d.upper_weight};
    const double* weights = weights_.data() + d.lower * wavelengths.size();
    const Rgb norm = (1 - upper) * norms_[d.lower] + upper * norms_[d.lower + 1];
    const FloatRgb reflectance = this->reflectance(thickness, c);
    const Rgb passing = this->passing(c, thickness, reflectance);
    for (std::size_t column = c; column < columns; column += grid_.cosines) {
      Folded b{{}, {}, passing};
      for (std::size_t k = 0; k < wavelengths.size(); ++k) {
        const double weight = lerp(upper, weights[k], weights[k + wavelengths.size()]);
        b.arriving += weight * double{shares[k * columns + column]} * wavelengths.weight[k];
        b.all += weight * wavelengths.weight[k];
      }
      to[column] = node(b, norm, c, reflectance);
    }
  }
}

// `norm` is the hemispherical integral of what arrives.
Color4 TexturedFactor::node(const Folded& b, const Rgb& norm, int c, const FloatRgb& reflectance) const {
  Color4 result{};
  for (int channel = 0; channel < 3; ++channel) {
    const double scale = std::sqrt(std::max({norm[channel], kLeastShare * mean(norm), square(kLeastValue)}));
    const double decay = waves_.least_decay(c) - this->decay(channel, c);
    double albedo = std::max({b.arriving[channel], kLeastShare * mean(b.arriving), kLeastValue});
    if (grid_.is_warped)
      albedo += waves_.field().frame().floor() * std::max({b.all[channel], kLeastShare * mean(b.all), 0.0}) *
                std::exp(std::min(decay, -kLeastLog));
    const double value = std::log(albedo / scale / b.passing[channel]) - decay;
    result[channel] = static_cast<float>(std::clamp(value, kLeastLog, kMostLog));
  }
  result[3] = static_cast<float>(first_chance(reflectance, mean(b.arriving), c));
  return result;
}

Rgb TexturedFactor::value(const std::vector<Color4>& nodes, int d, int c, int column) const {
  const double thickness = grid_.axes[0].node(d);
  const auto path = static_cast<float>(textured_path(waves_.field().material(), waves_.cosine(c)));
  const EvenPosition at = grid_.locate_path(static_cast<float>(thickness), path);
  const Color4* lower = nodes.data() + at.lower * grid_.columns() + column;
  const Rgb logs = to_rgb(lower[0] + at.upper_weight * (lower[grid_.columns()] - lower[0]));
  const Rgb passing = this->passing(c, thickness, reflectance(thickness, c));
  Rgb b;
  for (int channel = 0; channel < 3; ++channel)
    b[channel] = std::max(
        std::exp(logs[channel] + waves_.least_decay(c) - decay(channel, c)) * passing[channel], kLeastScale);
  return b;
}

// a tau / m~.
double TexturedFactor::decay(int channel, int c) const {
  return waves_.field().material().optical_depth() * double{media_.absorption[channel]} *
         per_pigment_cosine_[c];
}

Rgb TexturedFactor::passing(int c, double thickness_nm, const FloatRgb& reflectance) const {
  if (!waves_.field().material().is_smooth()) return Rgb(double{FilmCosines::passing(film_cosines_[c])});
  constexpr float kFaint = 0.01f;
  const Color4 passing = media_.passing(reflectance);
  return TexturedMedia::mean(passing) < kFaint ? faint_passing(c, thickness_nm) : to_rgb(passing);
}

// What a smooth film hardly lets pass is not the difference of two floats here, so that L goes on smoothly.
Rgb TexturedFactor::faint_passing(int c, double thickness_nm) const {
  constexpr double kLeast = 1e-15;  // as B is, it is kept above 0
  const Wavelengths& wavelengths = waves_.field().wavelengths();
  std::array<float, kMostWavelengths> powers;
  media_.film.powers(thickness_nm, waves_.field().material().base_ior, static_cast<float>(waves_.cosine(c)),
                     powers.data());
  Rgb sum;
  for (std::size_t k = 0; k < wavelengths.size(); ++k) sum += double{powers[k]} * wavelengths.weight[k];
  const double least = std::max(double{TexturedMedia::kLeastShare} * mean(sum), kLeast);
  return transform(sum, [least](double p) { return std::max(p, least); });
}

double TexturedFactor::first_chance(const FloatRgb& r, double rest, int c) const {
  const Material& material = waves_.field().material();
  const double of_first = std::max(0.0, double{r.r + r.g + r.b} / 3);
  double of_rest = std::max(0.0, rest) * std::exp(-waves_.least_decay(c) - waves_.least_decay(cosines() - 1));
  if (is_product_)  // the bracket, without X, at a mean cosine of the light
    of_rest *= one_visit_of_product(material.optical_depth() * double{media_.absorption[3]},
                                    material.cosine_below(waves_.cosine(c)), material.cosine_below(2.0 / 3));
  return std::clamp(of_first / (of_first + of_rest + kLeastValue), kLeastChance, 1 - kLeastChance);
}

}  // namespace v1
}  // namespace sunbeam
