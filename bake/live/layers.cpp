#include "bake/live/layers.h"

#include "bake/live/events.h"

namespace sunbeam::walk {
namespace {

// Indices closer than this are the same medium: the half vector of a passage has no digits left.
constexpr double kIndexMatch = 1e-7;

bool is_even(const FilmPhases& phases) {
  const auto& k = phases.k;
  for (int j = 2; j < phases.count; ++j)
    if (std::abs(k[j] - 2 * k[j - 1] + k[j - 2]) > 1e-12 * k[j]) return false;
  return phases.count > 3;  // a recurrence for fewer saves nothing
}

ThinFilm film_of(const Material& material) {
  return {material.exterior_ior, material.film_ior, material.base_ior, material.film_thickness_nm};
}

FilmPhases phases_of(const Material& material, const Wavelengths& wavelengths) {
  FilmPhases phases;
  for (const double nm : wavelengths.nm)
    phases.k[phases.count++] = 2 * kPi * material.film_ior * material.film_thickness_nm / nm;
  phases.is_bare = material.film_thickness_nm == 0;
  phases.is_even = is_even(phases);
  return phases;
}

// exp(-visits tau / cos), mean over wavelengths of what `power` says of each.
template <class Power>
double attenuated(const Layers& layers, double cosine, double visits, Power power) {
  double sum = 0;
  for (int j = 0; j < layers.count; ++j) sum += power(j) * std::exp(-visits * layers.tau[j] / cosine);
  return sum;
}

double cosine_of_bin(int bin) { return std::sqrt((bin + 0.5) / Guide::kBins); }

Guide make_open_guide(const Layers& layers) {
  std::array<double, Guide::kBins> importance;
  for (int bin = 0; bin < Guide::kBins; ++bin)
    importance[bin] = attenuated(layers, cosine_of_bin(bin), 1, [](int) { return 1.0; });
  return Guide(importance);
}

// What comes back down from the film, through the pigment both times.
Guide make_guide(const Layers& layers) {
  constexpr int kDraws = 4;  // packets; noise here is harmless
  using Lanes = Packet<xsimd::default_arch>;
  const Events<Lanes> events(layers);
  Rng rng(1, 0);
  std::array<double, Guide::kBins> importance{};
  for (int bin = 0; bin < Guide::kBins; ++bin) {
    const double cosine = cosine_of_bin(bin);
    for (int draw = 0; draw < (layers.is_smooth() ? 1 : kDraws); ++draw) {
      const auto down = events.reflect_below(Lanes(cosine), rng);
      Spectrum<double> power;
      events.reflectances_below(down.film,
                                [&](int j, const Lanes& r) { power[j] = mean_of_lanes(r * down.weight); });
      importance[bin] += attenuated(layers, cosine, 2, [&](int j) { return power[j]; });
    }
  }
  return Guide(importance);
}

}  // namespace

Layers::Layers(const Material& material, const Wavelengths& wavelengths)
    : film(film_of(material)),
      film_below(film),
      phases(phases_of(material, wavelengths)),
      alpha(material.roughness),
      index_ratio(1),
      bends(false),
      straight(material.transmission == Transmission::straight),
      count(static_cast<int>(wavelengths.size())),
      albedo{},
      tau{},
      product(material.absorption_path == AbsorptionPath::product),
      radiance_scale(material.radiance_scale()),
      guide({}),
      open_guide({}) {
  if (!straight) {
    film_below = FilmSide(film_of(material).reversed());
    bends = std::abs(material.exterior_ior / material.base_ior - 1) > kIndexMatch;
    if (bends) index_ratio = material.exterior_ior / material.base_ior;
  }
  for (int j = 0; j < count; ++j) {
    albedo[j] = wavelengths.albedo[j];
    tau[j] = material.optical_depth() * wavelengths.absorption[j];
  }
  summarise();
  guide = make_guide(*this);
  open_guide = make_open_guide(*this);
}

void Layers::summarise() {
  least_tau = *std::min_element(tau.begin(), tau.begin() + count);
  same_tau = least_tau == *std::max_element(tau.begin(), tau.begin() + count);
  brightest_albedo = *std::max_element(albedo.begin(), albedo.begin() + count);
}

}  // namespace sunbeam::walk
