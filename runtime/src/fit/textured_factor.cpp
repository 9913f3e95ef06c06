#include "runtime/src/fit/textured_factor.h"

#include <cmath>

namespace sunbeam::inline v1 {
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

TexturedFactor::TexturedFactor(const Table& table, const TexturedRest& rest, const TexturedShares& shares)
    : table_(table), waves_(table.factors.wavelengths), rest_(rest), grid_(rest.grid()), shares_(shares) {
  if (rest.is_product()) return;
  const double straight_down = fringe_order(table.material, 1);
  for (int d = 0; d < grid_.axes[0].size(); ++d)
    for (const double nm : waves_.nm) {
      const double per = grid_.axes[0].node(d) / nm;
      returned_at_.push_back(order_stencil(table.factors.returned.axes()[2], straight_down * per));
    }
}

void TexturedFactor::move() {
  find_frames();
  find_quadrature();
  if (!rest_.is_product()) take_returned();
  weights_.clear();
  norms_.clear();
  for (int d = 0; d < grid_.axes[0].size(); ++d) weigh(d);
}

void TexturedFactor::find_frames() {
  const TexturedMaterial shared(table_.material);
  const TexturedFrame frame(shared, shares_.material().base_ior, shares_.depth());
  for (int c = 0; c < kCosines; ++c) {
    const auto cosine = static_cast<float>(grid_.cosine(c));
    film_cosines_[c] = std::min(std::sqrt(shared.film_cosine_squared(cosine)), 1.0f);
    path_[c] = 1 / std::sqrt(frame.pigment_cosine_squared(cosine));
  }
}

// Trapezoids in the root: cos dw = 4 pi u^3 du. Relative to the least decay at normal incidence, so that no
// pigment makes an integral vanish.
void TexturedFactor::find_quadrature() {
  for (int c = 0; c < kCosines; ++c) {
    const double root = static_cast<double>(c) / (kCosines - 1), end = c == kCosines - 1 ? 0.5 : 1;
    quadrature_[c] = 4 * kPi / (kCosines - 1) * end * root * root * root *
                     std::exp(shares_.least_decay(kCosines - 1) - shares_.least_decay(c));
  }
}

void TexturedFactor::take_returned() {
  returned_.clear();
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    if (k > 0 && waves_.absorption[k] == waves_.absorption[k - 1]) {
      returned_.push_back(returned_.back());
      continue;
    }
    const double depth = shares_.depth() * waves_.absorption[k];
    const NdArray returned = table_.factors.returned.slice(std::array{shares_.material().base_ior, depth});
    returned_.emplace_back(returned.values().begin(), returned.values().end());
    returned_.back().resize(returned.cells() + kMoreOrders);
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

double TexturedFactor::gain(int d, std::size_t k) const {
  const double once = shares_.material().radiance_scale() * waves_.albedo[k] * kInvPi;
  if (rest_.is_product()) return once;
  return once / (1 - waves_.albedo[k] * blend(returned_[k], returned_at_[d * waves_.size() + k], 1, 0));
}

void TexturedFactor::weigh(int d) {
  const auto columns = static_cast<std::size_t>(grid_.columns());
  const std::vector<float> shares = shares_.at_thickness(d);
  Rgb norm;
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    const double gain = this->gain(d, k), arriving = hemispherical(shares.data() + k * columns);
    weights_.push_back(gain * arriving);
    norm += gain * arriving * arriving * waves_.weight[k];
  }
  norms_.push_back(norm);
}

FloatRgb TexturedFactor::reflectance(double thickness_nm, int c) const {
  FloatRgb reflectance;
  rest_.film().fold(thickness_nm, shares_.material().base_ior, {&film_cosines_[c], 1}, &reflectance);
  return reflectance;
}

void TexturedFactor::fold(int p, Color4* to) const {
  const auto columns = static_cast<std::size_t>(grid_.columns());
  const std::vector<float> shares = shares_.at_path(p);
  for (int c = 0; c < kCosines; ++c) {
    const double thickness = shares_.thickness_nm(p, c);
    const EvenAxis& axis = grid_.axes[0];
    const EvenPosition d = axis.locate(axis.clamped(thickness));
    const double upper{d.upper_weight};
    const double* weights = weights_.data() + d.lower * waves_.size();
    const Rgb norm = (1 - upper) * norms_[d.lower] + upper * norms_[d.lower + 1];
    const FloatRgb reflectance = this->reflectance(thickness, c);
    for (std::size_t column = c; column < columns; column += kCosines) {
      Rgb b;
      for (std::size_t k = 0; k < waves_.size(); ++k)
        b += lerp(upper, weights[k], weights[k + waves_.size()]) * double{shares[k * columns + column]} *
             waves_.weight[k];
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
    const double decay = shares_.least_decay(c) - this->decay(channel, c);
    const double value = std::log(albedo / scale / double{passing[channel]}) - decay;
    result[channel] = static_cast<float>(std::clamp(value, kLeastLog, kMostLog));
  }
  result[3] = static_cast<float>(first_chance(reflectance, mean(b), c));
  return result;
}

Rgb TexturedFactor::value(const Color4& log, int c, double thickness_nm) const {
  const Rgb logs = to_rgb(log), passing = to_rgb(this->passing(c, reflectance(thickness_nm, c)));
  Rgb b;
  for (int channel = 0; channel < 3; ++channel)
    b[channel] = std::exp(logs[channel] + shares_.least_decay(c) - decay(channel, c)) * passing[channel];
  return b;
}

// a tau / m~.
double TexturedFactor::decay(int channel, int c) const {
  return shares_.depth() * double{rest_.absorption()[channel]} * path_[c];
}

Color4 TexturedFactor::passing(int c, const FloatRgb& reflectance) const {
  return shares_.material().is_smooth() ? rest_.passing(reflectance)
                                        : TexturedMaterial::passing(film_cosines_[c]) + Color4{};
}

double TexturedFactor::first_chance(const FloatRgb& r, double rest, int c) const {
  const Material& material = shares_.material();
  const double of_first = std::max(0.0, double{r.r + r.g + r.b} / 3);
  double of_rest =
      std::max(0.0, rest) * std::exp(-shares_.least_decay(c) - shares_.least_decay(kCosines - 1));
  if (rest_.is_product())  // the bracket, without X, at a mean cosine of the light
    of_rest *= one_visit_of_product(shares_.depth() * double{rest_.absorption()[3]},
                                    material.cosine_below(grid_.cosine(c)), material.cosine_below(2.0 / 3));
  return std::clamp(of_first / (of_first + of_rest + kLeastValue), kLeastChance, 1 - kLeastChance);
}

}  // namespace sunbeam::inline v1
