// This is a WaveField at one thickness: it gives A, gain and rest of any direction, a wavelength at a time,
// in doubles.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "runtime/src/base/bound_axis.h"
#include "runtime/src/film/film_spectrum.h"
#include "runtime/src/fit/wave_field.h"
#include "runtime/src/layers/layered_waves.h"

namespace sunbeam {
inline namespace v1 {

class BoundWaves {
 public:
  // `material` is that of the table with the parameters of the point, which lie in the grid. The table must
  // outlive this. Folded colours go through `to`.
  BoundWaves(const Table& table, const Material& material, const FilmKernels& kernels, const ColorMatrix& to);

  // Holds what the rest needs to know of one direction.
  struct Direction {
    double below = 0;                            // cosine of one visit
    std::array<double, kMostWavelengths> share;  // A
    std::vector<DirectionTap> taps;              // in exchange
  };
  // Prepares a direction; phi lies in [0, pi/2] and is of no matter for an isotropic film.
  Direction direction(double cosine, double phi) const;

  // Holds the same with exchange contracted, for many others.
  struct Row {
    double below;
    std::array<double, kMostWavelengths> share;
    std::vector<double> exchange;  // (wavelength, node)
  };
  Row row(const Direction& i) const;

  // Returns the rest, folded, 1/sr.
  Rgb rest(const Row& i, const Direction& o) const;

  // Writes the rest at each wavelength, 1/sr.
  void rest(const Row& i, const Direction& o, std::span<double> values) const;
  // Writes what the film reflects at a cosine outside, at each wavelength.
  void reflectance(double cosine, std::span<double> values) const;

  // Returns what the film reflects at cosines outside, folded.
  std::vector<FloatRgb> reflectance(std::span<const float> cosines) const;

  // Returns A folded: what of a direction's light reaches the base.
  Rgb arriving(const Direction& w) const {
    return to_ * field_.wavelengths().fold(std::span(w.share).first(field_.size()));
  }

  const Material& material() const { return field_.material(); }
  bool has_layers() const { return layered_.has_value(); }

 private:
  double fringe_order_of(std::size_t k, double cosine) const;
  double returned(const Factors& factors, std::size_t k) const;
  void take_smooth_shares(double cosine, Direction& w) const;
  void take_rough_shares(double cosine, double phi, double coordinate, Direction& w) const;
  std::vector<double> exchange_point(std::size_t k) const;
  void take_exchange(const Factors& factors);
  void cut_gains(bool is_sum);
  double visits(const Row& i, const Direction& o, std::size_t k) const;
  std::vector<double> leaving(const Row& from, std::span<const Direction> to) const;

  // The axes of the arrivals, each of which is over (fringe_order, cos_theta, phi).
  struct ArrivalAxes {
    BoundAxis order, cosine, phi;
  };

  FilmSpectrum film_;
  WaveField field_;
  ColorMatrix to_;
  std::optional<ArrivalAxes> arrival_axes_;  // of a rough film of one layer
  std::optional<LayeredWaves> layered_;      // of a layered film, else film_ serves
  std::vector<double> gain_;
  std::vector<Axis> axes_;                    // (cos_theta, phi) of exchange
  std::vector<std::vector<float>> exchange_;  // of each wavelength, (direction, direction)
};

}  // namespace v1
}  // namespace sunbeam
