// X of a textured table with path "product" (sunbeam/textured_table.h): what is left of the rest over B B,
// one visit of the base aside, at the nodes of pairs.
#pragma once

#include "runtime/src/fit/textured_factor.h"

namespace sunbeam::inline v1 {

// What it is made of must outlive it.
class TexturedExchange {
 public:
  TexturedExchange(const Table& table, const TexturedRest& rest, const TexturedShares& shares,
                   const TexturedFactor& factor);

  void move_to(double base_ior);

  // At a node of the thickness, where the shares, the factor and L are now: (direction, direction).
  void find_pairs(int d, double absorption, Color4* pairs) const;

  // Before that.
  void take_visits();

 private:
  static constexpr int kCosines = TexturedGrid::kCosines;

  // A direction of a pair, as nodes of L.
  struct End {
    int c, p;
    std::size_t column() const { return static_cast<std::size_t>(p * kCosines + c); }
  };

  std::vector<float> visits(std::size_t k) const;
  void add_visits(int d, std::size_t k, const float* share, std::vector<Rgb>& sum) const;
  double most_leaving(const std::vector<float>& visits, const float* share, double gain) const;
  std::vector<Rgb> factors(int d, double absorption) const;
  Rgb one_visit(const End& a, const End& b) const;

  const Table& table_;
  const Wavelengths& waves_;
  const TexturedRest& rest_;
  const TexturedGrid& grid_;
  const TexturedShares& shares_;
  const TexturedFactor& factor_;
  std::vector<End> ends_;
  std::vector<OrderStencil> exchange_at_;  // (thickness, wavelength)

  NdArray exchange_;                        // at one base IOR
  std::array<double, kCosines> below_{};    // cosines below the film
  std::vector<std::vector<float>> visits_;  // of each wavelength: the bracket over (fringe_order, end, end)
  std::vector<std::size_t> visits_of_;      // whose of them a wavelength shares
};

}  // namespace sunbeam::inline v1
