#include "runtime/src/fit/textured_exchange.h"

#include <cmath>

namespace sunbeam::inline v1 {

TexturedExchange::TexturedExchange(const Table& table, const TexturedRest& rest, const TexturedShares& shares,
                                   const TexturedFactor& factor)
    : table_(table),
      waves_(table.factors.wavelengths),
      rest_(rest),
      grid_(rest.grid()),
      shares_(shares),
      factor_(factor) {
  for (int p = 0; p < grid_.phis; p += grid_.phi_step)
    for (int c = 0; c < kCosines; c += grid_.cosine_step) ends_.push_back({c, p});
  const double straight_down = fringe_order(table.material, 1);
  for (int d = 0; d < grid_.axes[0].size(); ++d)
    for (const double nm : waves_.nm) {
      const double per = grid_.axes[0].node(d) / nm;
      exchange_at_.push_back(order_stencil(table.factors.exchange.axes()[3], straight_down * per));
    }
}

void TexturedExchange::move_to(double base_ior) {
  exchange_ = table_.factors.exchange.slice(std::array{base_ior});
}

void TexturedExchange::take_visits() {
  for (int c = 0; c < kCosines; ++c) below_[c] = shares_.material().cosine_below(grid_.cosine(c));
  visits_.resize(waves_.size());
  visits_of_.clear();
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    const bool is_known =
        k > 0 && waves_.absorption[k] == waves_.absorption[k - 1] && waves_.albedo[k] == waves_.albedo[k - 1];
    visits_of_.push_back(is_known ? visits_of_.back() : k);
    if (!is_known) visits_[k] = visits(k);
  }
}

// The bracket of "product" (factors.h).
std::vector<float> TexturedExchange::visits(std::size_t k) const {
  const double depth = shares_.depth() * waves_.absorption[k];
  const NdArray slice = exchange_.slice(std::array{depth, waves_.albedo[k]});
  const std::size_t orders = slice.axes()[0].size(), nodes = slice.stride(2), ends = ends_.size();
  std::vector<std::vector<ColumnTap>> from;
  for (const End& end : ends_)
    from.push_back(column_taps(grid_, slice.axes()[1], slice.axes()[2], end.c, end.p));
  std::vector<float> result((orders + kMoreOrders) * ends * ends);
  std::vector<double> row(nodes);
  float* to = result.data();
  for (std::size_t o = 0; o < orders; ++o)
    for (std::size_t a = 0; a < ends; ++a) {
      std::fill(row.begin(), row.end(), 0);
      for (const ColumnTap& tap : from[a])
        for (std::size_t b = 0; b < nodes; ++b)
          row[b] += tap.weight * double{slice.values()[o * slice.stride(0) + tap.node * nodes + b]};
      for (std::size_t b = 0; b < ends; ++b) {
        double sum = one_visit_of_product(depth, below_[ends_[a].c], below_[ends_[b].c]);
        for (const ColumnTap& tap : from[b]) sum += tap.weight * row[tap.node];
        *to++ = static_cast<float>(sum);
      }
    }
  return result;
}

void TexturedExchange::find_pairs(int d, double absorption, Color4* pairs) const {
  const std::size_t ends = ends_.size();
  const std::vector<float> shares = shares_.at_thickness(d);
  std::vector<Rgb> sum(ends * ends);
  for (std::size_t k = 0; k < waves_.size(); ++k)
    add_visits(d, k, shares.data() + k * static_cast<std::size_t>(grid_.columns()), sum);
  const auto scales = factors(d, absorption);
  for (std::size_t a = 0; a < ends; ++a)
    for (std::size_t b = 0; b < ends; ++b)
      pairs[a * ends + b] =
          to_color4(sum[a * ends + b] / (scales[a] * scales[b]) - one_visit(ends_[a], ends_[b]));
}

// What of a pair X leaves to its closed form.
Rgb TexturedExchange::one_visit(const End& a, const End& b) const {
  Rgb result;
  for (int channel = 0; channel < 3; ++channel)
    result[channel] =
        one_visit_of_product(shares_.depth() * double{rest_.absorption()[channel]}, below_[a.c], below_[b.c]);
  return result;
}

// B of each end at a thickness as a look-up finds it, without the least decay.
std::vector<Rgb> TexturedExchange::factors(int d, double absorption) const {
  const double thickness = grid_.axes[0].node(d);
  const TexturedPlace place = rest_.place({thickness, shares_.material().base_ior, absorption});
  std::vector<Rgb> result;
  for (const End& end : ends_) {
    const auto path = static_cast<float>(textured_path(table_.material, grid_.cosine(end.c)));
    const auto w = rest_.direction(place, path, static_cast<float>(end.c) / (kCosines - 1));
    const float phi = grid_.phis == 1 ? 0 : static_cast<float>(end.p) / static_cast<float>(grid_.phis - 1);
    result.push_back(factor_.value(rest_.at(place, w, phi), end.c, thickness));
  }
  return result;
}

// Adds one wavelength's part of the rest, both without the least decay.
void TexturedExchange::add_visits(int d, std::size_t k, const float* share, std::vector<Rgb>& sum) const {
  const std::vector<float>& visits = visits_[visits_of_[k]];
  const OrderStencil& order = exchange_at_[d * waves_.size() + k];
  std::vector<float> here(sum.size());
  for (std::size_t j = 0; j < here.size(); ++j) here[j] = blend(visits, order, here.size(), j);
  const double gain = factor_.gain(d, k);
  const Rgb scale = gain / most_leaving(here, share, gain) * waves_.weight[k];
  const std::size_t ends = ends_.size();
  for (std::size_t a = 0; a < ends; ++a)
    for (std::size_t b = 0; b < ends; ++b)
      sum[a * ends + b] +=
          double{share[ends_[a].column()] * share[ends_[b].column()] * here[a * ends + b]} * scale;
}

// No more than one leaves the film of each unit of power that arrives at the base; else by how much more,
// as WaveField limits it. Simpson's rule over the root: cos dw = 4 pi u^3 du.
double TexturedExchange::most_leaving(const std::vector<float>& visits, const float* share,
                                      double gain) const {
  constexpr double kLeastViewer = 0.125;
  const int count = grid_.pair_cosines;  // ends of azimuth 0
  double most = 1;
  for (int a = 0; a < count; ++a) {
    if (grid_.cosine(ends_[a].c) < kLeastViewer) continue;
    double sum = 0;
    for (int b = 0; b < count; ++b) {
      const double root = static_cast<double>(b) / (count - 1);
      const double simpson = (b == 0 || b == count - 1 ? 1.0 : b % 2 == 1 ? 4.0 : 2.0) / (3.0 * (count - 1));
      sum += simpson * root * root * root * double{share[ends_[b].c]} *
             std::exp(-shares_.least_decay(ends_[b].c)) *
             double{visits[static_cast<std::size_t>(a) * ends_.size() + static_cast<std::size_t>(b)]};
    }
    most = std::max(most, 4 * kPi * gain * sum);
  }
  return most;
}

}  // namespace sunbeam::inline v1
