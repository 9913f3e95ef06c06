// A film of layers as single photons of one wavelength meet it: only the powers of one stack of plates are
// the product's. Uneven platelets are drawn anew at each meeting, and nothing is tabulated. Slow.
#pragma once

#include "sunbeam/core/rng.h"
#include "sunbeam/detail/film_stack.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam::test {

class PlainStack {
 public:
  // Takes the wavelength of this number.
  PlainStack(const Material& material, const Wavelengths& wavelengths, std::size_t k)
      : stack_{material.exterior_ior, {}, {material.base_ior, material.base_extinction}},
        spread_(material.thickness_spread),
        nm_(wavelengths.nm[k]),
        base_ior_(material.is_opaque() ? material.exterior_ior : material.base_ior),
        straight_(material.transmission == Transmission::straight) {
    if (!wavelengths.base_index.empty()) stack_.base_index = wavelengths.base_index[k];
    const std::vector<FilmLayer> single{{material.film_thickness_nm, material.film_ior}};
    const auto& layers = wavelengths.layers.empty() ? single : wavelengths.layers[k];
    double whole = 0;
    for (int period = 0; period < wavelengths.film_periods; ++period)
      for (const FilmLayer& layer : layers) {
        stack_.layers.push_back(layer);
        whole += layer.thickness_nm;
      }
    const double scale = whole > 0 ? material.film_thickness_nm / whole : 0;
    for (FilmLayer& layer : stack_.layers) layer.thickness_nm *= scale;
  }

  struct Powers {
    double reflectance, transmittance;
  };

  // What one platelet does with light that meets it on this side at this cosine; in "straight" mode cosines
  // are those outside. Light that has no angle in the base is reflected there as it is outside.
  Powers meet(bool is_outside, double cosine, Rng& rng) const {
    const FilmStack stack = platelet(rng);
    if (is_outside) return above(stack, cosine);
    const double sine2 = (1 - cosine * cosine) * (straight_ ? 1 : square(base_ior_ / stack.exterior_ior));
    if (sine2 >= 1) return {totally_reflected(stack, cosine), 0};
    const double cos_exterior = std::sqrt(1 - sine2);
    const Powers down = above(stack, cos_exterior);
    return {reflectance_below(stack, cos_exterior, nm_).value_or(down.reflectance), down.transmittance};
  }

 private:
  Powers above(const FilmStack& stack, double cosine) const {
    const StackPower power = stack_power(stack, cosine, nm_);
    return {power.reflectance, power.transmittance};
  }

  // Light in the base that has no angle outside.
  double totally_reflected(const FilmStack& stack, double cosine) const {
    const FilmStack reversed{
        stack.base_index.real(), {stack.layers.rbegin(), stack.layers.rend()}, stack.exterior_ior};
    const double sine2 = (1 - cosine * cosine) * square(base_ior_ / stack.base_index.real());
    return sine2 < 1 ? above(reversed, std::sqrt(1 - sine2)).reflectance : 1;
  }

  FilmStack platelet(Rng& rng) const {
    FilmStack stack = stack_;
    if (spread_ == 0) return stack;
    const double factor = 1 + spread_ * cut_normal(rng);
    for (FilmLayer& layer : stack.layers) layer.thickness_nm *= factor;
    return stack;
  }

  // Of deviation 1, cut at three.
  static double cut_normal(Rng& rng) {
    for (;;) {
      const double radius = std::sqrt(-2 * std::log(1 - rng.uniform()));
      const double normal = radius * std::cos(2 * kPi * rng.uniform());
      if (std::abs(normal) <= 3) return normal;
    }
  }

  FilmStack stack_;
  double spread_, nm_, base_ior_;
  bool straight_;
};

}  // namespace sunbeam::test
