#include "runtime/src/textured/layered_factor.h"

#include <algorithm>
#include <cmath>

#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLeastScale = 1e-150;  // of B, which is divided by twice
constexpr double kLeastNorm = 1e-200;
constexpr double kMostLog = 20, kLeastLog = -80;  // of L
constexpr double kLeastChance = 0.02;             // of either technique: their estimates may be far off
constexpr double kLeastValue = 1e-18;

// Of a node in the mean over its range, by trapezoids.
double node_share(int node, int nodes) {
  if (nodes == 1) return 1;
  return (node == 0 || node == nodes - 1 ? 0.5 : 1.0) / (nodes - 1);
}

}  // namespace

LayeredDirections::LayeredDirections(const LayeredWaves& waves, const LayeredGrid& grid, Material material,
                                     double base_ior) {
  constexpr double kLeastBelow = 0.05;
  material.base_ior = base_ior;
  constexpr int kCosines = LayeredGrid::kLogCosines;
  for (int column = 0; column < grid.columns(); ++column) {
    const double node = std::max(grid.cosine_of_column(column), kLeastTexturedCosine);
    cosines.push_back(entering_cosine(material, node, kLeastBelow));
    const double share = node_share(column / kCosines, grid.phis) * node_share(column % kCosines, kCosines);
    measure.push_back(cosines.back() > node ? 0 : 2 * kPi * node * share);
    passages.push_back(waves.passage(cosines.back(), grid.phi_of_column(column)));
  }
}

LayeredFactor::LayeredFactor(const Table& table, const LayeredGrid& grid, const LayeredWaves& waves,
                             const LayeredDirections& directions, const Parameters& at,
                             const Color4& absorption)
    : table_(table),
      grid_(grid),
      waves_(waves),
      directions_(directions),
      absorption_(absorption),
      field_(table, at.applied_to(table.material)) {
  const double depth = field_.material().optical_depth();
  for (std::size_t k = 0; k < field_.size(); ++k)
    gains_.push_back(field_.gain(k, grid.is_product ? 0 : waves.returned(k, depth)));
  weigh();
  for (int column = 0; column < grid.columns(); ++column) values_.push_back(folded(shares(column)));
}

// A of each column, A*, and the weights of wavelengths in B. A weight may be negative, but B stays above 0:
// it takes the positive part, and X what is left.
void LayeredFactor::weigh() {
  const std::size_t count = field_.size();
  const double depth = field_.material().optical_depth();
  shares_.resize(directions_.passages.size() * count);
  arriving_.resize(count);
  for (std::size_t column = 0; column < directions_.passages.size(); ++column) {
    double* share = &shares_[column * count];
    waves_.arriving(directions_.passages[column], depth, {share, count});
    for (std::size_t k = 0; k < count; ++k) arriving_[k] += directions_.measure[column] * share[k];
  }
  Rgb norm;
  for (std::size_t k = 0; k < count; ++k) {
    const Rgb positive =
        transform(field_.wavelengths().weight[k], [](double weight) { return std::max(weight, 0.0); });
    weights_.push_back(gains_[k] * arriving_[k] * positive);
    norm += arriving_[k] * weights_.back();
  }
  const Rgb root = transform(norm, [](double n) { return std::sqrt(std::max(n, kLeastNorm)); });
  for (Rgb& weight : weights_) weight = weight / root;
}

Rgb LayeredFactor::folded(const double* shares) const {
  Rgb sum;
  for (std::size_t k = 0; k < field_.size(); ++k) sum += shares[k] * weights_[k];
  return transform(sum, [](double b) { return std::max(b, kLeastScale); });
}

Rgb LayeredFactor::fold(const LayeredWaves::Passage& w) const {
  std::array<double, kMostWavelengths> share;
  waves_.arriving(w, field_.material().optical_depth(), std::span(share).first(field_.size()));
  return folded(share.data());
}

void LayeredFactor::take_logs(const std::vector<Rgb>& least, Color4* logs) const {
  const double depth = field_.material().optical_depth(),
               beyond = depth - table_.factors.grid[2].low() * field_.material().pigment_thickness_nm;
  const PigmentCosines pigment(FilmCosines(field_.material(), false), field_.material().base_ior, depth);
  for (int column = 0; column < grid_.columns(); ++column) {
    const auto cosine = static_cast<float>(cosine_of(column));
    const double per_cosine = 1 / std::sqrt(double{pigment.pigment_cosine_squared(cosine)});
    for (int channel = 0; channel < 3; ++channel) {
      const auto k = static_cast<std::size_t>(column);
      const double log = std::log(values_[k][channel] / least[k][channel]) +
                         beyond * double{absorption_[channel]} * per_cosine;
      logs[column][channel] = static_cast<float>(std::clamp(log, kLeastLog, kMostLog));
    }
    logs[column][3] = static_cast<float>(first_chance(column));
  }
}

double LayeredFactor::first_chance(int column) const {
  const Material& material = field_.material();
  const double cosine = cosine_of(column);
  const FilmCosines film(material, false);
  const double blurred =
      std::min(1.0, std::sqrt(double{film.film_cosine_squared(static_cast<float>(cosine))}));
  const double of_first = std::max(0.0, mean(waves_.reflectance(blurred)));
  Rgb sum;
  for (std::size_t k = 0; k < field_.size(); ++k)
    sum += gains_[k] * arriving_[k] * shares(column)[k] * field_.wavelengths().weight[k];
  double of_rest = std::max(0.0, mean(sum));
  if (grid_.is_product)  // the bracket, without X, at a mean cosine of the light
    of_rest *= one_visit_of_product(material.optical_depth() * double{absorption_[3]},
                                    material.cosine_below(cosine), material.cosine_below(2.0 / 3));
  return std::clamp(of_first / (of_first + of_rest + kLeastValue), kLeastChance, 1 - kLeastChance);
}

}  // namespace v1
}  // namespace sunbeam
