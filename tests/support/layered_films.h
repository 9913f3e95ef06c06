// Films of several layers that tests share, as materials and what their wavelengths carry.
#pragma once

#include <string>
#include <vector>

#include "sunbeam/detail/wavelengths.h"

namespace sunbeam::test {

struct LayeredFilm {
  std::string name;
  Material material;
  Wavelengths wavelengths;
};

// The layers are those of one period; the film is as thick as all of them.
inline LayeredFilm layered_film(const std::string& name, Material material,
                                const std::vector<FilmLayer>& layers, int periods = 1) {
  Wavelengths wavelengths = Wavelengths::rgb3(material);
  wavelengths.layers.assign(wavelengths.size(), layers);
  wavelengths.film_periods = periods;
  material.film_thickness_nm = 0;
  for (const FilmLayer& layer : layers) material.film_thickness_nm += periods * layer.thickness_nm;
  return {name, material, wavelengths};
}

// Half a film twice, which is the film itself.
inline Wavelengths two_halves(const Material& material, Wavelengths wavelengths) {
  wavelengths.layers.assign(wavelengths.size(), {{1, material.film_ior}, {1, material.film_ior}});
  return wavelengths;
}

inline LayeredFilm clear_mirror(const Material& material) {
  return layered_film("clear mirror", material, {{90, 1.45}, {60, 2.3}}, 12);
}
inline LayeredFilm butterfly(const Material& material) {
  return layered_film("chitin and air", material, {{80, 1.56}, {95, 1}}, 6);
}
inline LayeredFilm beetle(const Material& material) {
  return layered_film("chitin and melanin", material, {{80, 1.56}, {70, {1.7, 0.05}}}, 8);
}
inline LayeredFilm silver_cavity(const Material& material) {
  return layered_film("silver cavity", material, {{25, {0.06, 3.5}}, {300, 1.5}, {20, {0.06, 3.5}}});
}
inline LayeredFilm uneven_platelets(Material material) {
  material.thickness_spread = 0.1;
  return layered_film("uneven platelets", material, {{90, 1.68}, {60, 1.33}}, 4);
}
inline LayeredFilm dispersive(const Material& material) {
  LayeredFilm design = layered_film("dispersive", material, {{200, 1.6}, {150, {1.9, 0.02}}});
  design.wavelengths.layers[2][0].index = 1.65;
  design.wavelengths.base_index = {material.base_ior - 0.02, material.base_ior, material.base_ior + 0.03};
  return design;
}
// An oxide on a metal.
inline LayeredFilm opaque(Material material) {
  material.base_ior = 2.2;
  material.base_extinction = 3;
  material.albedo = Rgb(0);
  material.absorption_per_nm = 0;
  LayeredFilm design = layered_film("oxide on metal", material, {{120, 2.4}, {30, {1.8, 0.1}}});
  design.wavelengths.base_index = {{2.6, 3.4}, {2.2, 3}, {2, 2.7}};
  return design;
}

// Those on a clear base.
inline std::vector<LayeredFilm> layered_films(const Material& material) {
  return {clear_mirror(material),  butterfly(material),        beetle(material),
          silver_cavity(material), uneven_platelets(material), dispersive(material)};
}

}  // namespace sunbeam::test
