#include "runtime/src/fit/textured_shares.h"

#include "runtime/src/base/exp4.h"
#include "sunbeam/detail/textured_point.h"

namespace sunbeam::inline v1 {
namespace {

void exponentiate(std::vector<float>& values) {
  for (std::size_t k = 0; k < values.size(); k += 4) {
    Color4 four{};
    const std::size_t count = std::min<std::size_t>(4, values.size() - k);
    std::copy_n(values.data() + k, count, reinterpret_cast<float*>(&four));
    four = exp4(four);
    std::copy_n(reinterpret_cast<const float*>(&four), count, values.data() + k);
  }
}

}  // namespace

std::vector<ColumnTap> column_taps(const TexturedGrid& grid, const Axis& cosines, const Axis& phis, int c,
                                   int p) {
  const Stencil at = cosines.stencil(TexturedGrid::cosine(c)), by = phis.stencil(grid.phi(p));
  std::vector<ColumnTap> taps;
  for (std::size_t j = 0; j < at.count; ++j)
    for (std::size_t l = 0; l < by.count; ++l)
      taps.push_back({at.node[j] * phis.size() + by.node[l], at.weight[j] * by.weight[l]});
  return taps;
}

TexturedShares::TexturedShares(const Table& table, const TexturedGrid& grid, const FilmSpectrum& film)
    : table_(table),
      waves_(table.factors.wavelengths),
      grid_(grid),
      film_(film),
      columns_(static_cast<std::size_t>(grid.columns())),
      least_(*std::min_element(waves_.absorption.begin(), waves_.absorption.end())),
      material_(table.material) {
  if (!table.factors.arrival.empty()) find_stencils();
}

void TexturedShares::find_stencils() {
  const Axis& orders = table_.factors.arrival.axes()[2];
  for (int d = 0; d < grid_.axes[0].size(); ++d)
    for (const double nm : waves_.nm) {
      const double per = grid_.axes[0].node(d) / nm;
      for (int c = 0; c < kCosines; ++c)
        arrival_at_.push_back(order_stencil(orders, fringe_order(material_, grid_.cosine(c)) * per));
    }
  const double straight_down = fringe_order(material_, 1);
  for (int p = 0; p < grid_.paths; ++p)
    for (const double nm : waves_.nm)
      path_at_.push_back(order_stencil(orders, straight_down * grid_.path_nm(p) / nm));
}

void TexturedShares::move_to(double base_ior, double absorption) {
  material_.base_ior = base_ior;
  depth_ = absorption * material_.pigment_thickness_nm;
  find_pigment();
  if (table_.factors.arrival.empty()) return;
  arrival_.clear();
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    const bool is_known = k > 0 && waves_.absorption[k] == waves_.absorption[k - 1];
    const std::array at{base_ior, depth_ * waves_.absorption[k]};
    arrival_.push_back(is_known ? arrival_.back() : at_columns(table_.factors.arrival.slice(at)));
  }
}

// What the pigment leaves of each wavelength, relative to the one that it absorbs least.
void TexturedShares::find_pigment() {
  pigment_.resize(waves_.size() * columns_);
  for (int c = 0; c < kCosines; ++c) {
    const double per_cosine = 1 / arrival_cosine(material_, grid_.cosine(c));
    least_decay_[c] = depth_ * least_ * per_cosine;
    for (std::size_t k = 0; k < waves_.size(); ++k)
      for (std::size_t column = c; column < columns_; column += kCosines)
        pigment_[k * columns_ + column] =
            static_cast<float>(-depth_ * (waves_.absorption[k] - least_) * per_cosine);
  }
}

// From (fringe_order, cos_theta, phi).
std::vector<float> TexturedShares::at_columns(const NdArray& slice) const {
  const std::size_t orders = slice.axes()[0].size(), stride = slice.stride(0);
  std::vector<float> result((orders + kMoreOrders) * columns_);
  for (std::size_t column = 0; column < columns_; ++column) {
    const auto from = column_taps(grid_, slice.axes()[1], slice.axes()[2],
                                  static_cast<int>(column % kCosines), static_cast<int>(column / kCosines));
    for (std::size_t o = 0; o < orders; ++o) {
      double sum = 0;
      for (const ColumnTap& tap : from) sum += tap.weight * double{slice.values()[o * stride + tap.node]};
      result[o * columns_ + column] = static_cast<float>(sum);
    }
  }
  return result;
}

double TexturedShares::thickness_nm(int p, int c) const {
  return grid_.path_nm(p) / textured_path(material_, grid_.cosine(c));
}

std::vector<float> TexturedShares::at_thickness(int d) const {
  return shares(
      [&](std::size_t k, std::size_t c) -> const OrderStencil& {
        return arrival_at_[(d * waves_.size() + k) * kCosines + c];
      },
      [&](int) { return grid_.axes[0].node(d); });
}

std::vector<float> TexturedShares::at_path(int p) const {
  return shares(
      [&](std::size_t k, std::size_t) -> const OrderStencil& { return path_at_[p * waves_.size() + k]; },
      [&](int c) { return thickness_nm(p, c); });
}

// `arrival_at` of a wavelength and cosine, `thickness_at` of a cosine.
template <class ArrivalAt, class ThicknessAt>
std::vector<float> TexturedShares::shares(ArrivalAt arrival_at, ThicknessAt thickness_at) const {
  std::vector<float> result = pigment_;
  if (!arrival_.empty())
    for (std::size_t k = 0; k < waves_.size(); ++k)
      for (std::size_t c = 0; c < columns_; ++c)
        result[k * columns_ + c] += blend(arrival_[k], arrival_at(k, c % kCosines), columns_, c);
  exponentiate(result);
  if (arrival_.empty()) let_pass(thickness_at, result);
  return result;
}

// A smooth film's transmittance; it has no arrival and no azimuths.
template <class ThicknessAt>
void TexturedShares::let_pass(ThicknessAt thickness_at, std::vector<float>& shares) const {
  std::array<float, kMostWavelengths> passing;
  for (int c = 0; c < kCosines; ++c) {
    film_.powers(thickness_at(c), material_.base_ior, static_cast<float>(grid_.cosine(c)), passing.data());
    for (std::size_t k = 0; k < waves_.size(); ++k) shares[k * kCosines + c] *= passing[k];
  }
}

}  // namespace sunbeam::inline v1
