// This file holds the wavelengths that a live model carries, film and base at each of them, and how they fold
// into linear RGB.
#pragma once

#include <algorithm>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Live models keep what they carry on the stack.
inline constexpr std::size_t kMostWavelengths = 64;

// The indices n + i k that media may have, and the most layers of a film, those of all periods counted.
inline constexpr double kLeastIor = 0.05, kLargestIor = 10, kMostExtinction = 100;
inline constexpr int kMostFilmLayers = 1000;

// One layer of a film at one wavelength.
struct FilmLayer {
  double thickness_nm;         // >= 0
  std::complex<double> index;  // n + i k, n > 0, k >= 0 absorbs

  bool operator==(const FilmLayer&) const = default;
};

struct Wavelengths {
  std::vector<double> nm;          // vacuum
  std::vector<double> albedo;      // of the base, 0 to 1
  std::vector<double> absorption;  // of the pigment, relative to Material::absorption_per_nm
  std::vector<Rgb> weight;         // rgb = sum_k weight_k value_k

  // What Material's numbers do not say of film and base: the layers of one period from top to bottom, whose
  // thicknesses stand for their shares in Material::film_thickness_nm; how often they are repeated; and the
  // index of the base. A list is empty where Material says it all.
  std::vector<std::vector<FilmLayer>> layers{};
  int film_periods = 1;
  std::vector<std::complex<double>> base_index{};

  std::size_t size() const { return nm.size(); }
  bool operator==(const Wavelengths&) const = default;

  Rgb fold(std::span<const double> values) const {
    Rgb sum;
    for (std::size_t k = 0; k < size(); ++k) sum += values[k] * weight[k];
    return sum;
  }

  // Returns three of `values` (one of the lists above) from `first` on, for what works on three at a time;
  // beyond the end the last is repeated.
  Rgb triple(const std::vector<double>& values, std::size_t first) const {
    const std::size_t last = size() - 1;
    return {values[first], values[std::min(first + 1, last)], values[std::min(first + 2, last)]};
  }

  // Returns the paper's three wavelengths, 650, 510 and 475 nm, taken as linear R, G, B; so is the albedo.
  static Wavelengths rgb3(const Material& material) {
    return {{650, 510, 475},
            {material.albedo.r, material.albedo.g, material.albedo.b},
            {1, 1, 1},
            {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  }

  // Returns one wavelength for every channel, with the albedo of the first.
  static Wavelengths monochromatic(const Material& material, double nm) {
    return {{nm}, {material.albedo.r}, {1}, {Rgb(1)}};
  }
};

}  // namespace v1
}  // namespace sunbeam
