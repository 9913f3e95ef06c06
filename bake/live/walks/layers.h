// This file prepares the layered material as the walks need it: numbers only, made once.
#pragma once

#include <array>
#include <memory>

#include "bake/live/walks/base_guide.h"
#include "bake/live/walks/film_packets.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam::walk {

struct Layers {
  static constexpr double kLeastWorth = 0.05;

  Layers(const Material& material, const Wavelengths& wavelengths);  // 1 to kMostWavelengths of them

  FilmSide film;                             // as seen from outside
  FilmSide film_below;                       // as seen from below: reversed, or the same in "straight" mode
  FilmPhases phases;                         // of either
  std::shared_ptr<const FilmCurves> curves;  // of a layered film, else none
  double alpha;                              // 0: smooth
  double index_ratio;                        // n0 / n2 if passing light bends, else 1
  bool bends;
  bool straight;  // the crossing has no shadowing
  bool opaque;    // nothing is seen below

  int count;                                    // of wavelengths
  std::array<double, kMostWavelengths> albedo;  // of the base
  std::array<double, kMostWavelengths> tau;     // optical depth of the pigment
  double least_tau;
  double brightest_albedo;
  bool same_tau;  // at all wavelengths
  bool product;   // exp(-tau / (cos_i cos_o)); else exp(-tau (1 / cos_i + 1 / cos_o))
  double radiance_scale;

  // These forecast the power that ever visits the base, for walks that end (facets_walk.h): of light that is
  // there, 1 / (1 - share that comes back), and of light on its way back.
  std::array<double, kMostWavelengths> visits{}, later_visits{};
  BaseGuide guide;       // BaseForecast::going_on
  BaseGuide open_guide;  // BaseForecast::leaving
  double worth_below;  // of the light that enters the film, about what leaves again; at least kLeastWorth, 1
                       // if it scatters

  // Takes `picks` of the wavelengths of `all`, the same material: the k-th becomes its number which(k).
  template <class Which>
  void pick(const Layers& all, std::size_t picks, Which which) {
    count = phases.count = static_cast<int>(picks);
    phases.is_even = false;
    for (std::size_t k = 0; k < picks; ++k) {
      phases.k[k] = all.phases.k[which(k)];
      phases.number[k] = all.phases.number[which(k)];
      albedo[k] = all.albedo[which(k)];
      tau[k] = all.tau[which(k)];
      visits[k] = all.visits[which(k)];
      later_visits[k] = all.later_visits[which(k)];
    }
    summarise();
  }

  // Return means over the wavelengths, 0 to 1, which count by their `importance`.
  double mean(const double* importance, const FilmPowers::Numbers& powers) const {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += importance[k] * powers[k];
    return std::clamp(sum, 0.0, 1.0);
  }
  double mean_transmittance(const double* importance, const FilmPowers& film) const {
    return is_layered() ? mean(importance, film.transmittance) : 1 - mean(importance, film.reflectance);
  }

  // Returns the chance of mirroring at the upper surface, which gives equal shares to what reflects there and
  // to what comes back from below.
  double entry_chance(const double* importance, const FilmPowers& film) const {
    const double r = mean(importance, film.reflectance);
    const double both = r + mean_transmittance(importance, film) * worth_below;
    return both > 0 ? r / both : 1;
  }

  // Returns that of mirroring elsewhere. At a layered film it is the same from both sides, so that a density
  // may be followed in either direction.
  double mirror_chance(const double* importance, const FilmPowers& film) const {
    const double r = mean(importance, film.reflectance);
    if (!is_layered()) return r;
    const double both_sides = (r + mean(importance, film.reverse)) / 2;
    const double t = mean(importance, film.transmittance);
    return both_sides + t > 0 ? both_sides / (both_sides + t) : 1;
  }

  bool is_layered() const { return curves != nullptr; }
  bool is_smooth() const { return alpha == 0; }
  // Says whether facets bend what passes, so that a given direction outside has a density of directions
  // inside.
  bool has_glossy_crossing() const { return alpha > 0 && bends; }

 private:
  void summarise();  // over wavelengths
};

}  // namespace sunbeam::walk
