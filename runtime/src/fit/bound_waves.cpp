#include "runtime/src/fit/bound_waves.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// Gauss-Legendre over cosines: 1e-4 of what passes a film of a dozen fringe orders.
constexpr int kPanels = 12;
constexpr std::array kNode = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
constexpr std::array kWeight = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
constexpr int kViewers = 8;

double cosine_at(std::size_t k) { return (static_cast<double>(k / 4) + kNode[k % 4]) / kPanels; }

}  // namespace

BoundWaves::BoundWaves(const Table& table, const Material& material, const FilmKernels& kernels,
                       const ColorMatrix& to)
    : film_(table.factors.wavelengths, material.exterior_ior, material.film_ior, kernels),
      field_(table, material),
      to_(to) {
  if (is_layered(material, table.factors.wavelengths)) layered_.emplace(table, material);
  if (!field_.arrivals().empty()) {
    const NdArray& arrival = field_.arrivals()[0];
    const auto axis = [&](std::size_t k) { return BoundAxis(arrival.axes()[k], arrival.stride(k)); };
    arrival_axes_ = {axis(0), axis(1), axis(2)};
  }
  const bool is_sum = table.factors.exchange.empty();
  for (std::size_t k = 0; k < field_.size(); ++k)
    gain_.push_back(field_.gain(k, is_sum ? returned(table.factors, k) : 0));
  if (!is_sum) take_exchange(table.factors);
  cut_gains(is_sum);
}

double BoundWaves::fringe_order_of(std::size_t k, double cosine) const {
  return fringe_order(field_.material(), cosine) * field_.material().film_thickness_nm /
         field_.wavelengths().nm[k];
}

double BoundWaves::returned(const Factors& factors, std::size_t k) const {
  if (layered_) return layered_->returned(k, field_.material().optical_depth());
  return factors.returned
      .interpolate(std::array{field_.material().base_ior, field_.depth(k), fringe_order_of(k, 1)})
      .r;
}

// The coordinates of `exchange` that come before those of directions.
std::vector<double> BoundWaves::exchange_point(std::size_t k) const {
  const Material& material = field_.material();
  const Wavelengths& wavelengths = field_.wavelengths();
  if (!layered_) return {material.base_ior, field_.depth(k), wavelengths.albedo[k], fringe_order_of(k, 1)};
  const double path = path_per_thickness(material, wavelengths, k) * material.film_thickness_nm;
  return {material.base_ior, field_.depth(k), wavelengths.albedo[k], wavelengths.nm[k],
          path / wavelengths.nm[k]};
}

void BoundWaves::take_exchange(const Factors& factors) {
  for (std::size_t k = 0; k < field_.size(); ++k) {
    const std::vector<double> point = exchange_point(k);
    const NdArray slice = factors.exchange.slice(point);
    axes_ = {factors.exchange.axes()[point.size()], factors.exchange.axes()[point.size() + 1]};
    exchange_.emplace_back(slice.values().begin(), slice.values().end());
  }
}

// Of each unit of power that arrives at the base, whatever its direction, no more than one leaves the film.
// Interpolation does not know that, and over a bright base errors of a per mille in what the film returns
// become a per cent. Path "sum" forgets the direction of arrival, so that one viewer is enough.
void BoundWaves::cut_gains(bool is_sum) {
  std::vector<Direction> to;
  for (std::size_t k = 0; k < 4 * kPanels; ++k) to.push_back(direction(cosine_at(k), 0));
  std::vector<double> most(gain_.size());
  for (int v = is_sum ? kViewers : 1; v <= kViewers; ++v) {
    const auto share = leaving(row(direction(static_cast<double>(v) / kViewers, 0)), to);
    for (std::size_t k = 0; k < most.size(); ++k) most[k] = std::max(most[k], share[k]);
  }
  for (std::size_t k = 0; k < most.size(); ++k) gain_[k] /= std::max(most[k], 1.0);
}

// Int rest cos / A(from) at each wavelength.
std::vector<double> BoundWaves::leaving(const Row& from, std::span<const Direction> to) const {
  std::vector<double> sum(gain_.size());
  for (std::size_t n = 0; n < to.size(); ++n)
    for (std::size_t k = 0; k < sum.size(); ++k)
      sum[k] += 2 * kPi * cosine_at(n) * kWeight[n % 4] / kPanels * gain_[k] * to[n].share[k] *
                visits(from, to[n], k);
  return sum;
}

BoundWaves::Direction BoundWaves::direction(double cosine, double phi) const {
  const Material& material = field_.material();
  const FactorFrame& frame = field_.frame();
  Direction w;
  w.below = frame.one_visit_cosine(cosine);
  const double coordinate = frame.coordinate(cosine);
  if (layered_)
    layered_->arriving(layered_->passage(cosine, phi), material.optical_depth(), w.share);
  else if (material.is_smooth())
    take_smooth_shares(cosine, w);
  else
    take_rough_shares(cosine, phi, coordinate, w);
  if (!exchange_.empty()) w.taps = direction_taps(axes_[0], axes_[1], coordinate, phi);
  return w;
}

void BoundWaves::take_smooth_shares(double cosine, Direction& w) const {
  const Material& material = field_.material();
  const double per_cosine = 1 / field_.frame().pigment_cosine(cosine);
  std::array<float, kMostWavelengths> passing;
  film_.powers(material.film_thickness_nm, material.base_ior, static_cast<float>(cosine), passing.data());
  for (std::size_t k = 0; k < field_.size(); ++k)
    w.share[k] = double{passing[k]} * std::exp(-field_.depth(k) * per_cosine);
}

void BoundWaves::take_rough_shares(double cosine, double phi, double coordinate, Direction& w) const {
  const Material& material = field_.material();
  const FactorFrame& frame = field_.frame();
  const double per_cosine = 1 / frame.pigment_cosine(cosine);
  const double path = fringe_order(material, cosine) * material.film_thickness_nm;
  const BoundAxis::Taps c = arrival_axes_->cosine.at(coordinate), p = arrival_axes_->phi.at(phi);
  for (std::size_t k = 0; k < field_.size(); ++k) {
    const BoundAxis::Taps order = arrival_axes_->order.at(path / field_.wavelengths().nm[k]);
    const float* values = field_.arrivals()[field_.slice(k)].values().data();
    double arrival = 0;
    for (int a = 0; a < order.count; ++a) {
      const float* of_order = values + order.offset[a];
      float sum = 0;
      for (int b = 0; b < c.count; ++b)
        for (int d = 0; d < p.count; ++d)
          sum += c.weight[b] * p.weight[d] * of_order[c.offset[b] + p.offset[d]];
      arrival += double{order.weight[a] * sum};
    }
    w.share[k] = frame.share(arrival, field_.depth(k) * per_cosine);
  }
}

std::vector<FloatRgb> BoundWaves::reflectance(std::span<const float> cosines) const {
  std::vector<FloatRgb> folded(cosines.size());
  if (!layered_) film_.fold(material().film_thickness_nm, material().base_ior, cosines, folded.data());
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    const FloatRgb& f = folded[i];
    const Rgb rgb = to_ * (layered_ ? layered_->reflectance(double{cosines[i]}) : Rgb(f.r, f.g, f.b));
    folded[i] = {static_cast<float>(rgb.r), static_cast<float>(rgb.g), static_cast<float>(rgb.b)};
  }
  return folded;
}

BoundWaves::Row BoundWaves::row(const Direction& i) const {
  Row row{i.below, i.share, {}};
  if (exchange_.empty()) return row;
  const std::size_t nodes = axes_[0].size() * axes_[1].size();
  row.exchange.resize(nodes * field_.size());
  for (std::size_t k = 0; k < exchange_.size(); ++k)
    contract(exchange_[k], i.taps, std::span(row.exchange).subspan(k * nodes, nodes));
  return row;
}

// What path "product" multiplies A A g of wavelength k by.
double BoundWaves::visits(const Row& i, const Direction& o, std::size_t k) const {
  if (i.exchange.empty()) return 1;
  const std::size_t nodes = i.exchange.size() / field_.size();
  return bracket(field_.depth(k), i.below, o.below, std::span(i.exchange).subspan(k * nodes, nodes), o.taps);
}

void BoundWaves::rest(const Row& i, const Direction& o, std::span<double> values) const {
  for (std::size_t k = 0; k < field_.size(); ++k)
    values[k] = gain_[k] * i.share[k] * o.share[k] * visits(i, o, k);
}

void BoundWaves::reflectance(double cosine, std::span<double> values) const {
  if (layered_) return layered_->reflectance(cosine, values);
  std::array<float, kMostWavelengths> passing;
  film_.powers(material().film_thickness_nm, material().base_ior, static_cast<float>(cosine), passing.data());
  for (std::size_t k = 0; k < field_.size(); ++k) values[k] = 1 - double{passing[k]};
}

Rgb BoundWaves::rest(const Row& i, const Direction& o) const {
  Rgb sum;
  for (std::size_t k = 0; k < field_.size(); ++k)
    sum += gain_[k] * i.share[k] * o.share[k] * visits(i, o, k) * field_.wavelengths().weight[k];
  return to_ * sum;
}

}  // namespace v1
}  // namespace sunbeam
