#include "bake/live/walks/layers.h"

#include <numeric>

namespace sunbeam::walk {
namespace {

bool is_even(const FilmPhases& phases) {
  const auto& k = phases.k;
  for (int j = 2; j < phases.count; ++j)
    if (std::abs(k[j] - 2 * k[j - 1] + k[j - 2]) > 1e-12 * k[j]) return false;
  return phases.count > 3;  // a recurrence for fewer saves nothing
}

FilmPhases phases_of(const Material& material, const Wavelengths& wavelengths) {
  FilmPhases phases;
  for (const double nm : wavelengths.nm)
    phases.k[phases.count++] = 2 * kPi * material.film_ior * material.film_thickness_nm / nm;
  phases.is_bare = material.film_thickness_nm == 0;
  phases.is_even = is_even(phases);
  return phases;
}

}  // namespace

Layers::Layers(const Material& material, const Wavelengths& wavelengths)
    : film(ThinFilm::of(material)),
      film_below(ThinFilm::below(material)),
      phases(phases_of(material, wavelengths)),
      curves(sunbeam::is_layered(material, wavelengths)
                 ? std::make_shared<const FilmCurves>(material, wavelengths)
                 : nullptr),
      alpha(material.roughness.u),
      index_ratio(bending_index_ratio(material)),
      bends(index_ratio != 1),
      straight(material.transmission == Transmission::straight),
      opaque(material.is_opaque()),
      count(static_cast<int>(wavelengths.size())),
      albedo{},
      tau{},
      product(material.absorption_path == AbsorptionPath::product),
      radiance_scale(material.radiance_scale()),
      guide({}),
      open_guide({}),
      worth_below(1) {
  phases.curves = curves.get();
  std::iota(phases.number.begin(), phases.number.end(), 0);
  for (int j = 0; j < count; ++j) {
    albedo[j] = wavelengths.albedo[j];
    tau[j] = material.optical_depth() * wavelengths.absorption[j];
  }
  summarise();
  const BaseForecast forecast = forecast_base(*this);
  guide = forecast.going_on;
  open_guide = forecast.leaving;
  if (!material.scatters()) worth_below = std::clamp(forecast.worth, kLeastWorth, 1.0);
}

void Layers::summarise() {
  least_tau = *std::min_element(tau.begin(), tau.begin() + count);
  same_tau = least_tau == *std::max_element(tau.begin(), tau.begin() + count);
  brightest_albedo = *std::max_element(albedo.begin(), albedo.begin() + count);
}

}  // namespace sunbeam::walk
