#include "runtime/src/lookup/textured_rest.h"

#include <optional>

#include "runtime/src/fit/textured_exchange.h"
#include "runtime/src/fit/textured_factor.h"
#include "runtime/src/fit/textured_shares.h"

namespace sunbeam::inline v1 {
namespace {

// The weighted mean of the pigment's spectrum in each channel, and over channels.
Color4 mean_absorption(const Wavelengths& w) {
  Rgb sum, total;
  for (std::size_t k = 0; k < w.size(); ++k) {
    sum += w.absorption[k] * w.weight[k];
    total += w.weight[k];
  }
  Rgb result;
  for (int c = 0; c < 3; ++c) result[c] = std::max(sum[c] / total[c], 0.0);
  Color4 lanes = to_color4(result);
  lanes[3] = static_cast<float>(mean(result));
  return lanes;
}

}  // namespace

TexturedRest::TexturedRest(const Table& table)
    : grid_(table),
      film_(table.factors.wavelengths, table.material.exterior_ior, table.material.film_ior),
      stride_(grid_.axes[1].size() * grid_.axes[2].size() * grid_.columns()),
      total_(FilmWavelengths(table.factors.wavelengths).total_weight),
      absorption_(mean_absorption(table.factors.wavelengths)) {
  for (int k = 0; k < 4; ++k) corner_[k] = static_cast<int>(row(k >> 1, k & 1));
  nodes_.resize(static_cast<std::size_t>(grid_.paths * stride_));
  const std::array<EvenAxis, 3>& axes = grid_.axes;
  if (table.material.absorption_path == AbsorptionPath::product)
    pairs_.resize(static_cast<std::size_t>(axes[0].size() * axes[1].size() * axes[2].size()) *
                  static_cast<std::size_t>(grid_.pair_ends() * grid_.pair_ends()));
  find_nodes(table);
}

// At each point of the parameters L, then X, which divides by it.
void TexturedRest::find_nodes(const Table& table) {
  TexturedShares shares(table, grid_, film_);
  TexturedFactor factor(table, *this, shares);
  std::optional<TexturedExchange> exchange;
  if (is_product()) exchange.emplace(table, *this, shares, factor);
  for (int n = 0; n < axis(1).size(); ++n) {
    const double base_ior = axis(1).node(n);
    if (exchange) exchange->move_to(base_ior);
    for (int s = 0; s < axis(2).size(); ++s) {
      const double absorption = axis(2).node(s);
      shares.move_to(base_ior, absorption);
      factor.move();
      for (int p = 0; p < grid_.paths; ++p) factor.fold(p, nodes_.data() + p * stride_ + row(n, s));
      if (!exchange) continue;
      exchange->take_visits();
      for (int d = 0; d < axis(0).size(); ++d)
        exchange->find_pairs(d, absorption, &pairs_[first_pair(d, n, s)]);
    }
  }
}

TexturedRest::PairTaps TexturedRest::taps(const PairEnd& end) const {
  const EvenPosition c(end.root, grid_.pair_cosines);
  PairTaps taps{{c.lower, c.lower + 1}, {1 - c.upper_weight, c.upper_weight}, 2};
  if (grid_.pair_phis == 1) return taps;
  const EvenPosition p(end.phi, grid_.pair_phis);
  for (int k = 0; k < 2; ++k) {
    taps.node[k] += p.lower * grid_.pair_cosines;
    taps.node[k + 2] = taps.node[k] + grid_.pair_cosines;
    taps.weight[k + 2] = taps.weight[k] * p.upper_weight;
    taps.weight[k] *= 1 - p.upper_weight;
  }
  taps.count = 4;
  return taps;
}

Color4 TexturedRest::exchange(const Parameters& at, const PairEnd& o, const PairEnd& i) const {
  const PairTaps of_o = taps(o), of_i = taps(i);
  const EvenPosition d = grid_.axes[0].locate(at.film_thickness_nm), n = grid_.axes[1].locate(at.base_ior),
                     s = grid_.axes[2].locate(at.absorption_per_nm);
  const auto weight = [](const EvenPosition& x, int upper) {
    return upper ? x.upper_weight : 1 - x.upper_weight;
  };
  Color4 sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const int u = corner >> 2, v = corner >> 1 & 1, w = corner & 1;
    const Color4* pairs = pairs_.data() + first_pair(d.lower + u, n.lower + v, s.lower + w);
    Color4 of_corner{};
    for (int a = 0; a < of_o.count; ++a) {
      const Color4* row = pairs + of_o.node[a] * grid_.pair_ends();
      Color4 of_row{};
      for (int b = 0; b < of_i.count; ++b) of_row += of_i.weight[b] * row[of_i.node[b]];
      of_corner += of_o.weight[a] * of_row;
    }
    sum += weight(d, u) * weight(n, v) * weight(s, w) * of_corner;
  }
  return sum;
}

TexturedPlace TexturedRest::place(const Parameters& at) const {
  const EvenPosition n = grid_.axes[1].locate(at.base_ior), s = grid_.axes[2].locate(at.absorption_per_nm);
  const auto nearest = [](const EvenPosition& x) { return x.lower + (x.upper_weight < 0.5f ? 0 : 1); };
  const float n_upper = n.upper_weight, s_upper = s.upper_weight;
  return {
      static_cast<float>(at.film_thickness_nm),
      row(n.lower, s.lower),
      row(nearest(n), nearest(s)),
      {(1 - n_upper) * (1 - s_upper), (1 - n_upper) * s_upper, n_upper * (1 - s_upper), n_upper * s_upper}};
}

}  // namespace sunbeam::inline v1
