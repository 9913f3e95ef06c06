#include "runtime/src/lookup/textured_rest.h"

#include "runtime/src/fit/textured_fit.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// A small file can say that its films are a tenth of a millimetre thick, which takes nodes by the million.
void require_reasonable_size(const TexturedGrid& grid, bool has_pairs) {
  const std::uint64_t cells = grid.cells() + (has_pairs ? grid.pair_cells() : 0);
  const std::uint64_t bytes = cells * sizeof(Color4), most = 4 * read_limit(0);
  if (bytes > most)
    throw Error("textured look-ups of films up to " + to_text(grid.axes[0].high()) + " nm take " +
                to_text(std::ceil(static_cast<double>(bytes) / 1e6)) + " MB of memory; allowed: up to " +
                to_text(static_cast<double>(most) / 1e6) + " MB");
}

}  // namespace

TexturedRest::TexturedRest(const Table& table, Arithmetic arithmetic)
    : grid_(table), media_(table, arithmetic), stride_(static_cast<int>(grid_.path_stride())) {
  for (int k = 0; k < 4; ++k) corner_[k] = static_cast<int>(grid_.row(k >> 1, k & 1));
  require_reasonable_size(grid_, !table.factors.exchange.empty());
  TexturedFit fit = fit_textured(table, grid_, media_);
  nodes_ = std::move(fit.nodes);
  pairs_ = std::move(fit.pairs);
}

Color4 TexturedRest::exchange(const Parameters& at, const PairEnd& o, const PairEnd& i) const {
  const PairTaps of_o(o.coordinate, o.phi, grid_.pair_cosines, grid_.pair_phis),
      of_i(i.coordinate, i.phi, grid_.pair_cosines, grid_.pair_phis);
  const EvenPosition d = grid_.axes[0].locate(at.film_thickness_nm), n = grid_.axes[1].locate(at.base_ior),
                     s = grid_.axes[2].locate(at.absorption_per_nm);
  const auto weight = [](const EvenPosition& x, int upper) {
    return upper ? x.upper_weight : 1 - x.upper_weight;
  };
  Color4 sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const int u = corner >> 2, v = corner >> 1 & 1, w = corner & 1;
    const Color4* pairs = pairs_.data() + grid_.first_pair(d.lower + u, n.lower + v, s.lower + w);
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

ParameterTaps TexturedRest::parameter_taps(const Parameters& at) const {
  const EvenPosition n = grid_.axes[1].locate(at.base_ior), s = grid_.axes[2].locate(at.absorption_per_nm);
  const auto nearest = [](const EvenPosition& x) { return x.lower + (x.upper_weight < 0.5f ? 0 : 1); };
  const float n_upper = n.upper_weight, s_upper = s.upper_weight;
  return {
      static_cast<float>(at.film_thickness_nm),
      grid_.row(n.lower, s.lower),
      grid_.row(nearest(n), nearest(s)),
      {(1 - n_upper) * (1 - s_upper), (1 - n_upper) * s_upper, n_upper * (1 - s_upper), n_upper * s_upper}};
}

}  // namespace v1
}  // namespace sunbeam
