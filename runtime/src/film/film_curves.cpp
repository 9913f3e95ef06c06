#include "sunbeam/detail/film_curves.h"

#include <algorithm>

#include "sunbeam/detail/refraction.h"

namespace sunbeam {
inline namespace v1 {
namespace {

bool absorbs(const Wavelengths& wavelengths) {
  return std::ranges::any_of(wavelengths.layers, [](const std::vector<FilmLayer>& layers) {
    return std::ranges::any_of(layers, [](const FilmLayer& layer) { return layer.index.imag() > 0; });
  });
}

}  // namespace

FilmCurves::FilmCurves(const Material& material, const Wavelengths& wavelengths, const Precision& precision)
    : exterior_ior_(material.exterior_ior),
      base_ior_(bending_base_ior(material)),
      straight_(material.transmission == Transmission::straight),
      opaque_(material.is_opaque()),
      count_(wavelengths.size()),
      critical_(critical_cosine(denser_ior(), rarer_ior())) {
  const StackSpectrum film = stack_spectrum(material, wavelengths, precision.spread_orders);
  std::array<double, kMostWavelengths> above, through, below;
  const auto tabulate = [&](double x, std::span<double> values) {
    film.powers(rarer_ior(), x, above.data(), through.data(), below.data());
    if (opaque_) through.fill(0);
    for (std::size_t k = 0; k < count_; ++k) {
      values[k] = above[k];
      values[count_ + k] = through[k];
      values[2 * count_ + k] = below[k];
    }
  };
  passing_ = PanelCurve(3 * count_, tabulate, precision.panels);
  if (critical_ == 0 || !absorbs(wavelengths)) return;
  const auto tabulate_total = [&](double x, std::span<double> values) {
    film.powers(denser_ior(), x * critical_, above.data(), through.data(), below.data());
    // A dispersive base may pass some light that has no direction here.
    for (std::size_t k = 0; k < count_; ++k) values[k] = is_base_rarer() ? above[k] + through[k] : below[k];
  };
  total_ = PanelCurve(count_, tabulate_total, precision.panels);
}

// In "straight" mode light is below as it is outside.
bool FilmCurves::is_in_rarer(Side side) const {
  const bool is_below = side == Side::inside && !straight_;
  return critical_ == 0 || is_below == is_base_rarer();
}

std::vector<double> FilmCurves::edges(Side side) const {
  std::vector<double> cosines{0};
  const bool is_rarer = is_in_rarer(side);
  for (std::size_t p = 0; p < total_.panels() && !is_rarer; ++p) cosines.push_back(critical_ * total_.end(p));
  if (!is_rarer && total_.panels() == 0) cosines.push_back(critical_);
  for (std::size_t p = 0; p < passing_.panels(); ++p) {
    const double x = passing_.end(p);
    cosines.push_back(is_rarer ? x : std::sqrt(refracted_cosine_squared(rarer_ior(), denser_ior(), x)));
  }
  return cosines;
}

void FilmCurves::reflect_totally(double cosine, std::span<const int> wavelengths, FilmPowers& powers) const {
  const std::size_t count = wavelengths.size();
  std::fill_n(powers.reflectance.begin(), count, 1.0);
  std::fill_n(powers.transmittance.begin(), count, 0.0);
  if (total_.panels() > 0) {
    const PanelCurve::Place place = total_.find(cosine / critical_);
    for (std::size_t i = 0; i < count; ++i)
      powers.reflectance[i] = total_.value(place, static_cast<std::size_t>(wavelengths[i]));
  }
  std::copy_n(powers.reflectance.begin(), count, powers.reverse.begin());
}

void FilmCurves::at(Side side, double cosine, std::span<const int> wavelengths, FilmPowers& powers) const {
  double coordinate = cosine;
  if (!is_in_rarer(side)) {
    const double squared = refracted_cosine_squared(denser_ior(), rarer_ior(), cosine);
    if (squared <= 0) return reflect_totally(cosine, wavelengths, powers);
    coordinate = std::sqrt(squared);
  }
  const PanelCurve::Place place = passing_.find(coordinate);
  const std::size_t own = side == Side::inside ? 2 * count_ : 0;
  for (std::size_t i = 0; i < wavelengths.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(wavelengths[i]);
    powers.reflectance[i] = passing_.value(place, own + k);
    powers.transmittance[i] = passing_.value(place, count_ + k);
    powers.reverse[i] = passing_.value(place, 2 * count_ - own + k);
  }
}

void FilmCurves::at(const double* is_inside, std::span<const double> cosine, std::span<const int> wavelengths,
                    double* reflectance, double* transmittance) const {
  for (std::size_t k = 0; k < cosine.size(); ++k) {
    FilmPowers powers;
    at(is_inside[k] == 1 ? Side::inside : Side::outside, cosine[k], wavelengths, powers);
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
      reflectance[i * cosine.size() + k] = powers.reflectance[i];
      transmittance[i * cosine.size() + k] = powers.transmittance[i];
    }
  }
}

}  // namespace v1
}  // namespace sunbeam
