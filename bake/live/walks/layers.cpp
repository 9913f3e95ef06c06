#include "bake/live/walks/layers.h"

#include "bake/live/walks/film_events.h"

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

double cosine_of_bin(int bin) { return std::sqrt((bin + 0.5) / Guide::kBins); }

// What directions below the film are worth, per bin of the guides. Importance only: noise here is harmless.
class BelowFilm {
 public:
  explicit BelowFilm(const Layers& layers) : layers_(layers) {
    const Events<Lanes> events(layers);
    const int draws = layers.is_smooth() ? 1 : kDraws;
    Rng rng(1, 0);
    for (int bin = 0; bin < Guide::kBins; ++bin) {
      reflected_[bin].fill(0);
      for (int draw = 0; draw < draws; ++draw) {
        const auto down = events.reflect_below(Lanes(cosine_of_bin(bin)), rng);
        events.reflectances_below(down.film, [&](int j, const Lanes& r) {
          reflected_[bin][j] += mean_of_lanes(r * down.weight) / draws;
        });
      }
    }
  }

  // To walks that go on: what comes back down, through the pigment both times.
  Guide going_on() const {
    return guide([&](int bin, int j) { return reflected_[bin][j] * square(attenuation(bin, j)); });
  }

  // To walks that may leave: what gets out, now or after later visits of the base.
  Guide leaving() const {
    std::array<double, kMostWavelengths> later;
    for (int j = 0; j < layers_.count; ++j) later[j] = leaves_later(j);
    return guide([&](int bin, int j) {
      const double reflected = reflected_[bin][j], attenuated = attenuation(bin, j);
      return attenuated * (1 - reflected + reflected * attenuated * later[j]);
    });
  }

  // Of light that enters steeply, mean over wavelengths.
  double worth() const {
    double sum = 0;
    for (int j = 0; j < layers_.count; ++j) sum += std::exp(-layers_.tau[j]) * leaves_later(j);
    return sum / layers_.count;
  }

 private:
  using Lanes = Packet<Baseline>;
  static constexpr int kDraws = 4;  // packets

  double attenuation(int bin, int j) const { return std::exp(-layers_.tau[j] / cosine_of_bin(bin)); }

  // kd times the share of what the base sends up that gets out at last: v = out + back kd v.
  double leaves_later(int j) const {
    double out = 0, back = 0;
    for (int bin = 0; bin < Guide::kBins; ++bin) {
      out += attenuation(bin, j) * (1 - reflected_[bin][j]) / Guide::kBins;
      back += square(attenuation(bin, j)) * reflected_[bin][j] / Guide::kBins;
    }
    return layers_.albedo[j] * out / std::max(1 - layers_.albedo[j] * back, 1e-3);
  }

  template <class Importance>
  Guide guide(Importance importance) const {
    std::array<double, Guide::kBins> sums{};
    for (int bin = 0; bin < Guide::kBins; ++bin)
      for (int j = 0; j < layers_.count; ++j) sums[bin] += importance(bin, j);
    return Guide(sums);
  }

  const Layers& layers_;
  std::array<std::array<double, kMostWavelengths>, Guide::kBins> reflected_;
};

}  // namespace

Layers::Layers(const Material& material, const Wavelengths& wavelengths)
    : film(ThinFilm::of(material)),
      film_below(ThinFilm::below(material)),
      phases(phases_of(material, wavelengths)),
      alpha(material.roughness.u),
      index_ratio(bending_index_ratio(material)),
      bends(index_ratio != 1),
      straight(material.transmission == Transmission::straight),
      count(static_cast<int>(wavelengths.size())),
      albedo{},
      tau{},
      product(material.absorption_path == AbsorptionPath::product),
      radiance_scale(material.radiance_scale()),
      guide({}),
      open_guide({}),
      worth_below(1) {
  for (int j = 0; j < count; ++j) {
    albedo[j] = wavelengths.albedo[j];
    tau[j] = material.optical_depth() * wavelengths.absorption[j];
  }
  summarise();
  const BelowFilm below(*this);
  guide = below.going_on();
  open_guide = below.leaving();
  worth_below = material.scatters() ? 1 : std::clamp(below.worth(), kLeastWorth, 1.0);
}

void Layers::summarise() {
  least_tau = *std::min_element(tau.begin(), tau.begin() + count);
  same_tau = least_tau == *std::max_element(tau.begin(), tau.begin() + count);
  brightest_albedo = *std::max_element(albedo.begin(), albedo.begin() + count);
}

}  // namespace sunbeam::walk
