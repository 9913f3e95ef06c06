// The rest of a factored table (factors.h) at one parameter point, a wavelength at a time.
#pragma once

#include <span>
#include <vector>

#include "runtime/src/film/film_spectrum.h"
#include "sunbeam/table.h"

namespace sunbeam::inline v1 {

class WaveField {
 public:
  // `material` is that of the table with the parameters of the point, which lie in the grid.
  WaveField(const Table& table, const Material& material, const FilmKernels& kernels = best_film_kernels());

  // What the rest needs to know of one direction.
  struct End {
    double below = 0;                            // cosine below the film
    std::array<double, kMostWavelengths> share;  // A
    std::vector<std::size_t> node;               // of `exchange`, and their weights
    std::vector<double> weight;
  };
  // phi in [0, pi/2]; of no matter for an isotropic film.
  End end(double cosine, double phi) const;

  // The same with `exchange` contracted, for many others.
  struct Row {
    double below;
    std::array<double, kMostWavelengths> share;
    std::vector<double> exchange;  // (wavelength, node)
  };
  Row row(const End& i) const;

  // Folded, 1/sr.
  Rgb rest(const Row& i, const End& o) const;

  // A folded: what of a direction's light reaches the base.
  Rgb arriving(const End& end) const {
    return wavelengths_.fold(std::span(end.share).first(wavelengths_.size()));
  }

  const FilmSpectrum& film() const { return film_; }

 private:
  void take_arrival(const Factors& factors);
  void take_gain(const Factors& factors);
  void take_exchange(const Factors& factors);
  void limit_gain(bool is_sum);
  // Factor of A A of wavelength k that path "product" adds: all visits of the base, times gain.
  double visits(const Row& i, const End& o, std::size_t k) const;
  std::vector<double> leaving(const Row& from, std::span<const End> to) const;

  Material material_;
  Wavelengths wavelengths_;
  FilmSpectrum film_;
  std::vector<double> depth_;     // tau_k
  std::vector<double> gain_;      // s kd_k / pi, with "sum" also / (1 - kd_k returned_k)
  std::vector<NdArray> arrival_;  // (fringe_order, cos_theta, phi) of each wavelength, or one for all
  std::vector<Axis> ends_;        // (cos_theta, phi) of `exchange`
  std::vector<std::vector<double>> exchange_;  // of each wavelength, end by end
};

}  // namespace sunbeam::inline v1
