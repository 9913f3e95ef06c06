// This file gives the powers of a film at three wavelengths to quadrature, whichever kind of film it is: one
// clear layer in closed form, any other by its curves.
#pragma once

#include <optional>
#include <vector>

#include "bake/optics/thin_film.h"
#include "sunbeam/detail/film_curves.h"

namespace sunbeam {

// Returns three of the wavelengths from `first` on with all that belongs to them; beyond the end the last is
// repeated.
Wavelengths three_wavelengths(const Wavelengths& wavelengths, std::size_t first);

// Returns the clear film that bends, tunnels and reflects totally where this one does: its index is the
// lowest of all clear layers and wavelengths.
ThinFilm outline(const Material& material, const Wavelengths& wavelengths);

class FilmSides {
 public:
  // Takes three wavelengths.
  FilmSides(const Material& material, const Wavelengths& three);

  // False of a film that airy() serves, which absorbs nothing.
  bool is_layered() const { return curves_.has_value(); }

  // Returns the powers for light that travels on this side at a cosine with the normal.
  FilmPower at(sunbeam::Side side, double cosine) const;

  // Returns the cosines, from 0 to 1, between which the powers of a layered film are as good as polynomials.
  const std::vector<double>& edges(sunbeam::Side side) const {
    return side == sunbeam::Side::outside ? edges_outside_ : edges_inside_;
  }

  // Returns the outline as light on this side meets it; in "straight" mode it is that of the outside.
  const ThinFilm& outline_from(sunbeam::Side side) const {
    return side == sunbeam::Side::outside ? outside_ : inside_;
  }
  const Rgb& wavelengths_nm() const { return wavelengths_nm_; }

 private:
  ThinFilm outside_, inside_;
  Rgb wavelengths_nm_;
  std::optional<FilmCurves> curves_;
  std::vector<double> edges_outside_, edges_inside_;
};

}  // namespace sunbeam
