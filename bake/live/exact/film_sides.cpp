#include "bake/live/exact/film_sides.h"

#include <algorithm>
#include <array>

namespace sunbeam {

Wavelengths three_wavelengths(const Wavelengths& wavelengths, std::size_t first) {
  const std::size_t last = wavelengths.size() - 1;
  const std::array numbers{first, std::min(first + 1, last), std::min(first + 2, last)};
  const auto of = [&](auto list) {
    if (list.empty()) return list;
    return decltype(list){list[numbers[0]], list[numbers[1]], list[numbers[2]]};
  };
  return {of(wavelengths.nm),        of(wavelengths.albedo), of(wavelengths.absorption),
          of(wavelengths.weight),    of(wavelengths.layers), wavelengths.film_periods,
          of(wavelengths.base_index)};
}

ThinFilm outline(const Material& material, const Wavelengths& wavelengths) {
  ThinFilm film = ThinFilm::of(material);
  if (wavelengths.layers.empty()) return film;
  film.film_ior = std::max(film.exterior_ior, film.base_ior);
  for (const auto& layers : wavelengths.layers)
    for (const FilmLayer& layer : layers)
      if (layer.index.imag() == 0) film.film_ior = std::min(film.film_ior, layer.index.real());
  return film;
}

FilmSides::FilmSides(const Material& material, const Wavelengths& three)
    : outside_(outline(material, three)),
      inside_(material.transmission == Transmission::straight ? outside_ : outside_.reversed()),
      wavelengths_nm_(three.triple(three.nm, 0)) {
  if (!sunbeam::is_layered(material, three)) return;
  curves_.emplace(material, three);
  edges_outside_ = curves_->edges(sunbeam::Side::outside);
  edges_inside_ = curves_->edges(sunbeam::Side::inside);
}

FilmPower FilmSides::at(sunbeam::Side side, double cosine) const {
  if (!is_layered()) return airy(outline_from(side), cosine, wavelengths_nm_);
  constexpr std::array three{0, 1, 2};
  FilmPowers powers;
  curves_->at(side, cosine, three, powers);
  const auto& [r, t, reverse] = powers;
  return {{r[0], r[1], r[2]}, {t[0], t[1], t[2]}};
}

}  // namespace sunbeam
