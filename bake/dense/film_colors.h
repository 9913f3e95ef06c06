// This file folds the powers of a film, single or layered, over the wavelengths, as light outside meets it.
#pragma once

#include <optional>

#include "bake/optics/wavelength_quadrature.h"
#include "sunbeam/detail/layered_film.h"

namespace sunbeam {

// A node of arrays at cosine 0 holds the powers at this one: the limit from above, which is 0 without
// interfaces.
inline constexpr double kLeastFilmCosine = 1e-8;

class FilmColors {
 public:
  FilmColors(const Material& material, const Wavelengths& wavelengths);

  // Returns the powers at a cosine > 0. Layers that absorb have R + T < 1, and nothing passes into an opaque
  // base or beyond the critical angle.
  FilmPower at(double cosine) const;

 private:
  Material material_;
  WavelengthQuadrature spectrum_;
  std::optional<StackSpectrum> stack_;  // of a layered film
};

}  // namespace sunbeam
