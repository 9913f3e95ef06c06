#include "bake/optics/dispersion/film_design.h"

#include <algorithm>

#include "bake/optics/dispersion/visible.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

// Returns the index at a wavelength; an Error of it names what it is the index of.
std::complex<double> index_at(const OpticalIndex& index, double nm, const std::string& where) {
  try {
    return index.at(nm);
  } catch (const Error& error) {
    throw Error(where + ": " + error.what());
  }
}

}  // namespace

bool is_opaque(const OpticalIndex& base) {
  for (double nm = kShortestVisibleNm; nm <= kLongestVisibleNm; ++nm)
    if (base.at(nm).imag() > kClearExtinction) return true;
  return false;
}

double FilmDesign::thickness_nm() const {
  double sum = 0;
  for (const DesignLayer& layer : layers) sum += layer.thickness_nm;
  return sum * periods;
}

bool FilmDesign::reaches(double thickness) const {
  return thickness == 0 || layers.empty() || thickness_nm() > 0;
}

double FilmDesign::path_nm(const Material& material, double thickness) const {
  if (layers.empty()) return 2 * material.film_ior * thickness;
  const double listed = thickness_nm();
  if (listed == 0) return 0;
  double longest = 0;
  for (double nm = kShortestVisibleNm; nm <= kLongestVisibleNm; ++nm) {
    double path = 0;
    for (const DesignLayer& layer : layers) path += 2 * layer.index.at(nm).real() * layer.thickness_nm;
    longest = std::max(longest, path);
  }
  return longest * periods * (thickness / listed);
}

std::complex<double> FilmDesign::base_at(double nm) const {
  const std::string where = "key 'base_ior'";
  const std::complex<double> index = index_at(*base, nm, where);
  if (index.imag() == 0 || is_opaque(*base)) return index;
  if (index.imag() > kClearExtinction)
    throw Error(where + ": found k = " + to_text(index.imag()) + " at " + to_text(nm) +
                " nm, but the base is clear at visible wavelengths; allowed: wavelengths at which it is "
                "clear");
  return index.real();
}

void FilmDesign::fill(Wavelengths& wavelengths) const {
  if (!layers.empty()) wavelengths.film_periods = periods;
  for (const double nm : wavelengths.nm) {
    if (base) wavelengths.base_index.push_back(base_at(nm));
    if (layers.empty()) continue;
    std::vector<FilmLayer>& at_nm = wavelengths.layers.emplace_back();
    for (const DesignLayer& layer : layers) {
      const std::string where = "layer " + std::to_string(at_nm.size() + 1) + " of the film";
      at_nm.push_back({layer.thickness_nm, index_at(layer.index, nm, where)});
    }
  }
}

}  // namespace sunbeam
