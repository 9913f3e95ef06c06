// What all parts of the general walk share: the material at some wavelengths, what a walk carries, and how
// the film splits it.
#pragma once

#include "bake/live/film/microsurface.h"
#include "bake/live/film/visible_normals.h"
#include "bake/live/general/slab.h"
#include "bake/live/walks/kernels.h"

namespace sunbeam::walk {

using Powers = std::array<double, kMostWavelengths>;

// What the general walk has beyond Layers.
struct GeneralLayers {
  explicit GeneralLayers(const Material& material)
      : facets(material.roughness),
        multiple(material.has_multiple_facets()),
        slab{material.scattering_depth(), material.anisotropy},
        critical_cosine(material.is_smooth() ? 0 : sunbeam::critical_cosine(ThinFilm::of(material))) {}

  Microsurface facets;
  bool multiple;
  Slab slab;
  double
      critical_cosine;  // a rough film's, from outside: below it light passes tilted facets alone; 0 if none
};

// What a walk carries: power, or the chance of sample().
//
// sample() takes every turn at random, so the density of its directions has no closed form. But that density
// is the value of another material: one "wavelength" whose film reflects with the chance that sample()
// mirrors, over a pigment and a base that absorb nothing, for a walk that always goes on. With `chance` the
// same code therefore estimates densities where it estimates the rest with `power`; single facets lose
// nothing, since sample() pays for shadowing by weight.
enum class Carrying { power, chance };

// Walks in one estimate.
inline constexpr int kGeneralWalks = 4;

// A walk that has lost all but this of its power goes on by roulette.
inline constexpr double kFaint = 0.15;

struct WalkContext {
  const Layers& layers;
  const GeneralLayers& general;
  const double* importance;  // of each wavelength in choices
  const Kernels& kernels;
  bool is_chance;
  int count;  // of powers

  double total(const Powers& power) const {
    double sum = 0;
    for (int j = 0; j < count; ++j) sum += power[j];
    return sum;
  }

  void scale(Powers& power, double factor) const {
    for (int j = 0; j < count; ++j) power[j] *= factor;
  }

  // Keeps `power` at `least` in the mean by ending walks below it. False if this one ends, as all without
  // power do.
  bool survives(Powers& power, double least, Rng& rng) const {
    const double left = total(power);
    if (left >= least && left > 0) return true;
    if (!(rng.uniform() * least < left)) return false;
    scale(power, least / left);
    return true;
  }

  // How often sample() takes a facet to mirror.
  double mirror_chance(const Place& at, const FilmPowers& film) const {
    return at.is_entry ? layers.entry_chance(importance, film) : layers.mirror_chance(importance, film);
  }

  // What a facet does with light that meets it at this cosine.
  void film_at(const Place& at, double cosine, FilmPowers& powers) const {
    const FilmSide& film = at.side == Side::outside ? layers.film : layers.film_below;
    film_powers(kernels, film, layers.phases, at.side, std::clamp(cosine, 0.0, 1.0), powers);
    if (!is_chance) return;
    powers.reflectance[0] = mirror_chance(at, powers);
    powers.transmittance[0] = 1 - powers.reflectance[0];
  }

  // What the pigment takes over this length.
  void attenuate(double length, Powers& power) const {
    if (is_chance || layers.product) return;
    if (!layers.same_tau)
      kernels.attenuate(layers.tau.data(), length, count, power.data());
    else if (layers.least_tau > 0)
      scale(power, std::exp(-layers.least_tau * length));
  }
};

}  // namespace sunbeam::walk
