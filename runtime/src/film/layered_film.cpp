#include "sunbeam/detail/layered_film.h"

namespace sunbeam {
inline namespace v1 {
FilmStack film_stack(const Material& material, const Wavelengths& wavelengths, std::size_t k) {
  FilmStack stack{material.exterior_ior, {}, {material.base_ior, material.base_extinction}, 1};
  if (!wavelengths.base_index.empty()) stack.base_index = wavelengths.base_index[k];
  if (wavelengths.layers.empty()) {
    stack.layers = {{material.film_thickness_nm, material.film_ior}};
    return stack;
  }
  stack.layers = wavelengths.layers[k];
  stack.periods = wavelengths.film_periods;
  double sum = 0;
  for (const FilmLayer& layer : stack.layers) sum += stack.periods * layer.thickness_nm;
  const double scale = sum > 0 ? material.film_thickness_nm / sum : 0;
  for (FilmLayer& layer : stack.layers) layer.thickness_nm *= scale;
  return stack;
}

bool is_layered(const Material& material, const Wavelengths& wavelengths) {
  return !wavelengths.layers.empty() || !wavelengths.base_index.empty() || material.is_opaque() ||
         material.thickness_spread > 0;
}

double path_per_thickness(const Material& material, const Wavelengths& wavelengths, std::size_t k) {
  if (wavelengths.layers.empty()) return 2 * material.film_ior;
  double path = 0, thickness = 0;
  for (const FilmLayer& layer : wavelengths.layers[k]) {
    path += 2 * layer.index.real() * layer.thickness_nm;
    thickness += layer.thickness_nm;
  }
  return thickness > 0 ? path / thickness : 0;
}

StackSpectrum stack_spectrum(const Material& material, const Wavelengths& wavelengths, double spread_orders) {
  std::vector<FilmStack> stacks;
  for (std::size_t k = 0; k < wavelengths.size(); ++k) stacks.push_back(film_stack(material, wavelengths, k));
  return {stacks, wavelengths.nm, material.thickness_spread, spread_orders};
}

}  // namespace v1
}  // namespace sunbeam
