// The rest of a factored table of path "sum" over all its parameters: the array L of textured_table.h.
#pragma once

#include <array>
#include <vector>

#include "even_axis.h"
#include "exp4.h"
#include "sunbeam/film_spectrum.h"
#include "sunbeam/table.h"
#include "sunbeam/textured_point.h"

namespace sunbeam {

class TexturedRest {
 public:
  explicit TexturedRest(const Table& table);

  static constexpr int kCosines = 13;  // even roots

  TexturedPlace place(const Parameters& at) const;

  // L at the root of a cosine; the last lane is the chance of sampling the first surface, interpolated too.
  Color4 at(const TexturedPlace& place, float root) const {
    const EvenPosition c(root, kCosines);
    Color4 low{}, high{};
    for (std::size_t k = 0; k < 8; ++k) {
      const Color4* row = nodes_.data() + place.row + corner_[k] + c.lower;
      low += place.weight[k] * row[0];
      high += place.weight[k] * row[1];
    }
    return low + c.upper_weight * (high - low);
  }

  // The chance of sampling the first surface, from the nearest parameters: they are given, and so the choice
  // need not change smoothly with them.
  float first_chance(const TexturedPlace& place, float root) const {
    const EvenPosition c(root, kCosines);
    const Color4* row = nodes_.data() + place.nearest + c.lower;
    return row[0][3] + c.upper_weight * (row[1][3] - row[0][3]);
  }

  // Asks for what at() will read, to work meanwhile.
  void prefetch(const TexturedPlace& place, float root) const {
    const EvenPosition c(root, kCosines);
    for (const int corner : corner_) __builtin_prefetch(nodes_.data() + place.row + corner + c.lower);
  }

  // The film's transmittance folded, from its reflectance; kept above 0.
  Color4 passing(const FloatRgb& reflectance) const {
    const Color4 all{total_.r - reflectance.r, total_.g - reflectance.g, total_.b - reflectance.b, 0};
    return all > kLeastPassing ? all : Color4{} + kLeastPassing;
  }

  const FilmSpectrum& film() const { return film_; }
  const Color4& absorption() const { return absorption_; }
  const EvenAxis& axis(std::size_t k) const { return axes_[k]; }
  std::size_t bytes() const { return nodes_.size() * sizeof(Color4); }

 private:
  static constexpr float kLeastPassing = 1e-4f;

  class Builder;

  FilmSpectrum film_;
  std::array<EvenAxis, 3> axes_;  // in the order of kParameterNames
  std::array<int, 8> corner_;     // distance of a place's rows from the first, in nodes
  FloatRgb total_;                // the fold of 1
  Color4 absorption_;             // a of each channel, and their mean
  std::vector<Color4> nodes_;     // (film_thickness_nm, base_ior, absorption_per_nm, root of the cosine)
};

}  // namespace sunbeam
