#include "bake/recipe/film_keys.h"

#include <fmt/format.h>

#include "bake/optics/dispersion/visible.h"
#include "bake/recipe/optical_index_key.h"
#include "bake/recipe/range_of.h"

namespace sunbeam {
namespace {

constexpr const char* kFilm = "film";
constexpr const char* kThickness = "film_thickness_nm";
constexpr const char* kPeriods = "film_periods";
constexpr const char* kFilmIor = "film_ior";
constexpr const char* kFilmExtinction = "film_extinction";
constexpr const char* kBaseIor = "base_ior";
constexpr const char* kBaseExtinction = "base_extinction";
constexpr double kReferenceNm = 510;

bool is_number_or_absent(const ConfigTable& config, const char* key) {
  return !config.has(key) || config.is_number(key);
}

// [[material.film]].
void read_layers(const ConfigTable& config, FilmDesign& film) {
  for (const char* key : {kFilmIor, kFilmExtinction})
    if (config.has(key))
      config.fail(key,
                  "found beside [[material.film]], whose layers have their own; allowed: one of the two");
  for (const ConfigTable& layer : config.tables(kFilm))
    film.layers.push_back(
        {layer.number("thickness_nm", range_of(kThickness)), read_optical_index(layer, "ior", "extinction")});
  film.periods = config.integer(kPeriods, 1, kMostFilmLayers, 1);
  const std::size_t layers = film.layers.size() * static_cast<std::size_t>(film.periods);
  if (layers == 0 || layers > kMostFilmLayers)
    config.fail(kFilm, fmt::format("found {} layers{}; allowed: 1 to {}", layers,
                                   film.periods > 1 ? fmt::format(" in {} periods", film.periods) : "",
                                   kMostFilmLayers));
}

// film_ior and film_extinction.
void read_one_layer(const ConfigTable& config, Material& material, FilmDesign& film) {
  if (config.has(kPeriods)) config.fail(kPeriods, "found without [[material.film]], whose layers it repeats");
  if (is_number_or_absent(config, kFilmIor) && config.number(kFilmExtinction, {0, kMostExtinction}, 0) == 0)
    material.film_ior = config.number(kFilmIor, range_of(kFilmIor), material.film_ior);
  else if (!config.has(kFilmIor))
    film.layers = {{1, OpticalIndex::constant(material.film_ior, config.number(kFilmExtinction, {}))}};
  else
    film.layers = {{1, read_optical_index(config, kFilmIor, kFilmExtinction)}};
}

void read_thickness(const ConfigTable& config, Material& material, const FilmDesign& film) {
  const bool is_list = config.has(kFilm);
  const double listed = film.thickness_nm(), allowed = range_of(kThickness).high;
  if (is_list && listed > allowed)
    config.fail(kFilm,
                fmt::format("found {:g} nm in all layers together; allowed: up to {:g}", listed, allowed));
  material.film_thickness_nm =
      config.number(kThickness, range_of(kThickness), is_list ? listed : material.film_thickness_nm);
  require_proportions(config, film, material.film_thickness_nm);
}

double extinction_of(const OpticalIndex& base) {
  if (const double k = base.at(kReferenceNm).imag(); k > 0) return k;
  double largest = 0;
  for (double nm = kShortestVisibleNm; nm <= kLongestVisibleNm; ++nm)
    largest = std::max(largest, base.at(nm).imag());
  return largest;
}

void require_clear(const ConfigTable& config, const OpticalIndex& base) {
  const Range allowed = range_of(kBaseIor);
  for (double nm = kShortestVisibleNm; nm <= kLongestVisibleNm; ++nm)
    if (const double n = base.at(nm).real(); !(n >= allowed.low && n <= allowed.high))
      config.fail(kBaseIor, fmt::format("found n = {:g} at {:g} nm; allowed of a base that does not absorb: "
                                        "{:g} to {:g}",
                                        n, nm, allowed.low, allowed.high));
}

void read_base(const ConfigTable& config, Material& material, FilmDesign& film) {
  if (is_number_or_absent(config, kBaseIor)) {
    material.base_extinction = config.number(kBaseExtinction, range_of(kBaseExtinction), 0);
    const Range allowed = material.is_opaque() ? Range{kLeastIor, kLargestIor} : range_of(kBaseIor);
    material.base_ior = config.number(kBaseIor, allowed, material.base_ior);
    return;
  }
  const OpticalIndex base = read_optical_index(config, kBaseIor, kBaseExtinction);
  material.base_ior = base.at(kReferenceNm).real();
  if (is_opaque(base))
    material.base_extinction = extinction_of(base);
  else
    require_clear(config, base);
  film.base = base;
}

}  // namespace

FilmDesign read_film_and_base(const ConfigTable& config, Material& material) {
  FilmDesign film;
  if (config.has(kFilm))
    read_layers(config, film);
  else
    read_one_layer(config, material, film);
  read_thickness(config, material, film);
  read_base(config, material, film);
  return film;
}

const char* thickness_key(const ConfigTable& config) {
  return config.has(kFilm) && !config.has(kThickness) ? kFilm : kThickness;
}

void require_proportions(const ConfigTable& config, const FilmDesign& film, double thickness_nm) {
  if (film.reaches(thickness_nm)) return;
  config.fail(kThickness,
              fmt::format("found {:g}, but all layers of the film are 0 nm thick; allowed: 0", thickness_nm));
}

}  // namespace sunbeam
