#include "runtime/src/fit/textured_exchange.h"

#include <cmath>

#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// X as a float that stays one when it is multiplied by two factors of exp(20). Sums of floats that pass their
// range have no value.
double bounded(double x) {
  constexpr double kMost = 1e18;
  return std::isfinite(x) ? std::clamp(x, -kMost, kMost) : 0;
}

}  // namespace

TexturedExchange::TexturedExchange(const NdArray& exchange, const TexturedWaves& waves,
                                   const TexturedMedia& media, const TexturedFactor& factor,
                                   const std::vector<Color4>& nodes)
    : waves_(waves), media_(media), grid_(waves.grid()), factor_(factor), nodes_(nodes) {
  for (int p = 0; p < grid_.phis; p += grid_.phi_step)
    for (int c = 0; c < grid_.cosines; c += grid_.cosine_step)
      ends_.push_back({c, p, static_cast<std::size_t>(p * grid_.cosines + c)});
  const FactorFrame& frame = waves.field().frame();
  const Material& material = waves.field().material();
  const FilmCosines film(material, grid_.is_warped);
  for (int c = 0; c < grid_.cosines; ++c) {
    below_.push_back(frame.one_visit_cosine(waves.cosine(c)));
    visit_below_.push_back(std::hypot(material.cosine_below(waves.cosine(c)), std::sqrt(film.visit_blur2)));
  }
  const Wavelengths& w = waves.field().wavelengths();
  for (std::size_t k = 0; k < w.size(); ++k) {
    const bool is_known = k > 0 && w.absorption[k] == w.absorption[k - 1] && w.albedo[k] == w.albedo[k - 1];
    if (!is_known) brackets_.push_back(brackets(exchange, k));
    brackets_of_.push_back(brackets_.size() - 1);
  }
}

std::vector<float> TexturedExchange::brackets(const NdArray& exchange, std::size_t k) const {
  const double depth = waves_.field().depth(k);
  const NdArray slice = exchange.slice(std::array{depth, waves_.field().wavelengths().albedo[k]});
  const std::size_t orders = slice.axes()[0].size(), nodes = slice.stride(2), ends = ends_.size();
  std::vector<std::vector<DirectionTap>> taps;
  for (const End& end : ends_)
    taps.push_back(direction_taps(slice.axes()[1], slice.axes()[2],
                                  waves_.field().frame().coordinate(waves_.cosine(end.c)), grid_.phi(end.p)));
  std::vector<float> result((orders + kMoreOrders) * ends * ends);
  std::vector<double> row(nodes);
  float* to = result.data();
  for (std::size_t o = 0; o < orders; ++o)
    for (std::size_t a = 0; a < ends; ++a) {
      std::fill(row.begin(), row.end(), 0);
      contract(slice.values().subspan(o * slice.stride(0), slice.stride(0)), taps[a], row);
      for (std::size_t b = 0; b < ends; ++b)
        *to++ = static_cast<float>(bracket(depth, below_[ends_[a].c], below_[ends_[b].c], row, taps[b]));
    }
  return result;
}

void TexturedExchange::find_pairs(int d, Color4* pairs) const {
  const std::size_t ends = ends_.size();
  std::vector<Rgb> sum(ends * ends), scales;
  for (std::size_t k = 0; k < waves_.field().size(); ++k) add_wavelength(d, k, sum);
  for (const End& end : ends_)
    scales.push_back(factor_.value(nodes_, d, end.c, static_cast<int>(end.column)));
  for (std::size_t a = 0; a < ends; ++a)
    for (std::size_t b = 0; b < ends; ++b)
      pairs[a * ends + b] = to_color4(
          transform(sum[a * ends + b] / (scales[a] * scales[b]) - one_visit(ends_[a], ends_[b]), bounded));
}

// What of a pair X leaves to its closed form.
Rgb TexturedExchange::one_visit(const End& a, const End& b) const {
  const double depth = waves_.field().material().optical_depth();
  Rgb result;
  for (int channel = 0; channel < 3; ++channel)
    result[channel] = one_visit_of_product(depth * double{media_.absorption[channel]}, visit_below_[a.c],
                                           visit_below_[b.c]);
  return result;
}

// Adds one wavelength's part of the rest, without the least decay.
void TexturedExchange::add_wavelength(int d, std::size_t k, std::vector<Rgb>& sum) const {
  const std::vector<float>& brackets = brackets_[brackets_of_[k]];
  const float* share = factor_.shares(d).data() + k * static_cast<std::size_t>(grid_.columns());
  const OrderStencil& order = waves_.orders().visits_at(d, k);
  std::vector<float> here(sum.size());
  for (std::size_t j = 0; j < here.size(); ++j) here[j] = blend(brackets, order, here.size(), j);
  const Rgb scale = waves_.gain(d, k) * waves_.field().wavelengths().weight[k];
  const std::size_t ends = ends_.size();
  for (std::size_t a = 0; a < ends; ++a)
    for (std::size_t b = 0; b < ends; ++b)
      sum[a * ends + b] +=
          double{share[ends_[a].column] * share[ends_[b].column] * here[a * ends + b]} * scale;
}

}  // namespace v1
}  // namespace sunbeam
