// This file holds what a recipe says of film and base beyond the numbers of Material: a film of several
// layers, and indices that depend on the wavelength.
#pragma once

#include <optional>
#include <vector>

#include "bake/optics/dispersion/optical_index.h"
#include "sunbeam/detail/wavelengths.h"
#include "sunbeam/material.h"

namespace sunbeam {

// A base whose extinction is nowhere in the visible above this lets light go on for millimetres: it is clear,
// and its extinction counts as 0.
inline constexpr double kClearExtinction = 1e-5;

// Says whether the index absorbs more than a clear base does at some visible wavelength.
bool is_opaque(const OpticalIndex& base);

struct DesignLayer {
  double thickness_nm;  // >= 0
  OpticalIndex index;

  bool operator==(const DesignLayer&) const = default;
};

struct FilmDesign {
  std::vector<DesignLayer> layers;   // of one period, from top to bottom; none: the film is Material's
  int periods = 1;                   // of the layers
  std::optional<OpticalIndex> base;  // none: the base is Material's

  bool operator==(const FilmDesign&) const = default;

  // Says whether film and base are more than one clear layer of constant index on a clear base.
  bool is_layered(const Material& material) const {
    return *this != FilmDesign() || material.is_opaque() || material.thickness_spread > 0;
  }

  // Returns the thickness of all layers in all periods.
  double thickness_nm() const;

  // Says whether its layers make a film of this thickness: those of no thickness at all make none > 0.
  bool reaches(double thickness_nm) const;

  // Returns the optical path 2 sum(n d) of a film of this thickness, at the visible wavelength at which it is
  // longest.
  double path_nm(const Material& material, double thickness_nm) const;

  // Returns the index of `base`, which there must be, at a wavelength: a real one if it is clear. Throws
  // Error naming the key if it is not known there, or if it is clear at visible wavelengths and absorbs
  // there.
  std::complex<double> base_at(double wavelength_nm) const;

  // Fills in layers, film_periods and base_index at the wavelengths. Throws Error if an index is not known
  // there.
  void fill(Wavelengths& wavelengths) const;
};

}  // namespace sunbeam
