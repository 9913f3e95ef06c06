#include "bake/dense/film_colors.h"

#include <array>

#include "sunbeam/detail/refraction.h"

namespace sunbeam {

FilmColors::FilmColors(const Material& material, const Wavelengths& wavelengths)
    : material_(material), spectrum_{wavelengths.nm, wavelengths.weight} {
  if (is_layered(material, wavelengths)) stack_.emplace(stack_spectrum(material, wavelengths));
}

// All that is reflected totally is reflected, though the index of a dispersive base may be that of no such
// angle.
FilmPower FilmColors::at(double cosine) const {
  if (!stack_) return spectrum_.fold_film(ThinFilm::of(material_), cosine);
  std::array<double, kMostWavelengths> above, through, below;
  stack_->powers(material_.exterior_ior, cosine, above.data(), through.data(), below.data());
  if (refracted_cosine_squared(material_.exterior_ior, bending_base_ior(material_), cosine) <= 0)
    for (std::size_t k = 0; k < spectrum_.size(); ++k) above[k] += std::exchange(through[k], 0);
  if (material_.is_opaque()) through.fill(0);
  return {spectrum_.fold(above), spectrum_.fold(through)};
}

}  // namespace sunbeam
