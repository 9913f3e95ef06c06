// This file holds what of the film and the pigment a textured table folds in closed form at every look-up: P
// of a smooth film and a (sunbeam/textured_table.h).
#pragma once

#include <algorithm>

#include "runtime/src/base/color4.h"
#include "runtime/src/film/film_spectrum.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

// Returns a: the weighted mean of the pigment's spectrum in each channel, and their mean.
Color4 mean_absorption(const Wavelengths& wavelengths);

struct TexturedMedia {
  TexturedMedia(const Table& table, Arithmetic arithmetic);

  // Returns the film's transmittance folded, from its reflectance. It is kept above 0 and above a share of
  // the channels' mean, since a folded colour may pass through 0.
  Color4 passing(const FloatRgb& reflectance) const {
    constexpr float kRounding = 1e-7f, kMost = 1e-4f;
    const Color4 all{total.r - reflectance.r, total.g - reflectance.g, total.b - reflectance.b, 0};
    const float least = std::clamp(kLeastShare * mean(all), kRounding, kMost);
    return select(all > least, all, Color4{} + least);
  }
  static float mean(const Color4& color) { return (color[0] + color[1] + color[2]) / 3; }

  static constexpr float kLeastShare = 0.01f;

  FilmSpectrum film;
  FloatRgb total;     // the fold of 1
  Color4 absorption;  // a of each channel, and their mean
};

}  // namespace v1
}  // namespace sunbeam
