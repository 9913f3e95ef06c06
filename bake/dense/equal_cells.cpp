#include "bake/dense/equal_cells.h"

#include <limits>
#include <map>

namespace sunbeam {

EqualCells::EqualCells(bool is_isotropic, std::size_t cosines, std::size_t azimuths)
    : is_isotropic_(is_isotropic), cosines_(cosines), azimuths_(azimuths) {
  const std::size_t azimuths_i = is_isotropic ? 1 : azimuths_ / 4 + 1;
  std::map<std::size_t, Cells> by_key;
  for (std::size_t i = 0; i < cosines_ * azimuths_i; ++i)
    for (std::size_t o = 0; o < cosines_ * azimuths_; ++o)
      by_key[key({i / azimuths_i, i % azimuths_i}, {o / azimuths_, o % azimuths_})].emplace_back(i, o);
  for (auto& [key, cells] : by_key) classes_.push_back(std::move(cells));
}

void EqualCells::average(Rows& values) const {
  for (const Cells& cells : classes_) {
    Rgb sum;
    for (const auto& [row, place] : cells) sum += values[row][place];
    spread(sum / static_cast<double>(cells.size()), cells, values);
  }
}

void EqualCells::average_errors(Rows& errors) const {
  for (const Cells& cells : classes_) {
    Rgb variance, row_error;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto [row, place] = cells[k];
      row_error += errors[row][place];
      if (k + 1 < cells.size() && cells[k + 1].first == row) continue;
      variance += row_error * row_error;
      row_error = {};
    }
    const Rgb error = transform(variance, [](double x) { return std::sqrt(x); });
    spread(error / static_cast<double>(cells.size()), cells, errors);
  }
}

std::size_t EqualCells::number(const End& i, const End& o) const {
  return ((i.cosine * azimuths_ + i.azimuth) * cosines_ + o.cosine) * azimuths_ + o.azimuth;
}

// The least number of all cells in its class.
std::size_t EqualCells::key(End i, End o) const {
  const std::size_t pole = cosines_ - 1;
  if (is_isotropic_) {
    if (i.cosine == pole || o.cosine == pole) o.azimuth = 0;
    return std::min(number(i, o), number({o.cosine, 0}, {i.cosine, o.azimuth}));
  }
  const auto mirrored = [&](const End& end, bool x, bool y) {
    if (end.cosine == pole) return End{pole, 0};
    std::size_t azimuth = end.azimuth;
    if (x) azimuth = azimuths_ + azimuths_ / 2 - azimuth;
    if (y) azimuth = 2 * azimuths_ - azimuth;
    return End{end.cosine, azimuth % azimuths_};
  };
  auto least = std::numeric_limits<std::size_t>::max();
  for (const bool x : {false, true})
    for (const bool y : {false, true}) {
      const End a = mirrored(i, x, y), b = mirrored(o, x, y);
      least = std::min({least, number(a, b), number(b, a)});
    }
  return least;
}

void EqualCells::spread(const Rgb& mean, const Cells& cells, Rows& rows) {
  for (const auto& [row, place] : cells) rows[row][place] = mean;
}

}  // namespace sunbeam
