#include "runtime/src/fit/wave_field.h"

namespace sunbeam::inline v1 {
namespace {

// Gauss-Legendre over cosines: 1e-4 of what passes a film of a dozen fringe orders.
constexpr int kPanels = 12;
constexpr std::array kNode = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
constexpr std::array kWeight = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
constexpr int kViewers = 8;

double cosine_at(std::size_t k) { return (static_cast<double>(k / 4) + kNode[k % 4]) / kPanels; }

}  // namespace

WaveField::WaveField(const Table& table, const Material& material, const FilmKernels& kernels)
    : material_(material),
      wavelengths_(table.factors.wavelengths),
      film_(wavelengths_, material.exterior_ior, material.film_ior, kernels) {
  for (std::size_t k = 0; k < wavelengths_.size(); ++k) {
    depth_.push_back(material.optical_depth() * wavelengths_.absorption[k]);
    gain_.push_back(material.radiance_scale() * wavelengths_.albedo[k] * kInvPi);
  }
  if (!material.is_smooth()) take_arrival(table.factors);
  if (table.factors.exchange.empty())
    take_gain(table.factors);
  else
    take_exchange(table.factors);
  limit_gain(table.factors.exchange.empty());
}

// Of each unit of power that arrives at the base, whatever its direction, no more than one leaves the film.
// Interpolation does not know that, and over a bright base errors of a per mille in what the film returns
// become a per cent. Path "sum" forgets the direction, so that one is enough.
void WaveField::limit_gain(bool is_sum) {
  std::vector<End> to;
  for (std::size_t k = 0; k < 4 * kPanels; ++k) to.push_back(end(cosine_at(k), 0));
  std::vector<double> most(depth_.size(), 1);
  for (int v = is_sum ? kViewers : 1; v <= kViewers; ++v) {
    const auto share = leaving(row(end(static_cast<double>(v) / kViewers, 0)), to);
    for (std::size_t k = 0; k < most.size(); ++k) most[k] = std::max(most[k], share[k]);
  }
  for (std::size_t k = 0; k < most.size(); ++k) gain_[k] /= most[k];
}

// Int rest cos / A(from) at each wavelength.
std::vector<double> WaveField::leaving(const Row& from, std::span<const End> to) const {
  std::vector<double> sum(depth_.size());
  for (std::size_t n = 0; n < to.size(); ++n)
    for (std::size_t k = 0; k < sum.size(); ++k)
      sum[k] += 2 * kPi * cosine_at(n) * kWeight[n % 4] / kPanels * gain_[k] * to[n].share[k] *
                visits(from, to[n], k);
  return sum;
}

// One slice for all wavelengths of the same optical depth.
void WaveField::take_arrival(const Factors& factors) {
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const bool is_new = k == 0 || (depth_[k] != depth_[0] && factors.arrival.axes()[1].size() > 1);
    arrival_.push_back(is_new ? factors.arrival.slice(std::array{material_.base_ior, depth_[k]})
                              : arrival_[0]);
  }
}

void WaveField::take_gain(const Factors& factors) {
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const double order = fringe_order(material_, 1) * material_.film_thickness_nm / wavelengths_.nm[k];
    const double returned = factors.returned.interpolate(std::array{material_.base_ior, depth_[k], order}).r;
    gain_[k] /= 1 - wavelengths_.albedo[k] * returned;
  }
}

void WaveField::take_exchange(const Factors& factors) {
  ends_ = {factors.exchange.axes()[4], factors.exchange.axes()[5]};
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const double order = fringe_order(material_, 1) * material_.film_thickness_nm / wavelengths_.nm[k];
    const NdArray slice =
        factors.exchange.slice(std::array{material_.base_ior, depth_[k], wavelengths_.albedo[k], order});
    exchange_.emplace_back(slice.values().begin(), slice.values().end());
  }
}

WaveField::End WaveField::end(double cosine, double phi) const {
  End end;
  end.below = material_.cosine_below(cosine);
  const double per_cosine = 1 / arrival_cosine(material_, cosine);
  std::array<float, kMostWavelengths> passing;
  if (material_.is_smooth())
    film_.powers(material_.film_thickness_nm, material_.base_ior, static_cast<float>(cosine), passing.data());
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const double pigment = -depth_[k] * per_cosine;
    if (material_.is_smooth()) {
      end.share[k] = double{passing[k]} * std::exp(pigment);
    } else {
      const double order = fringe_order(material_, cosine) * material_.film_thickness_nm / wavelengths_.nm[k];
      end.share[k] = std::exp(arrival_[k].interpolate(std::array{order, cosine, phi}).r + pigment);
    }
  }
  if (exchange_.empty()) return end;
  const Stencil c = ends_[0].stencil(cosine), p = ends_[1].stencil(phi);
  for (std::size_t a = 0; a < c.count; ++a)
    for (std::size_t b = 0; b < p.count; ++b) {
      end.node.push_back(c.node[a] * ends_[1].size() + p.node[b]);
      end.weight.push_back(c.weight[a] * p.weight[b]);
    }
  return end;
}

WaveField::Row WaveField::row(const End& i) const {
  Row row{i.below, i.share, {}};
  const std::size_t nodes = exchange_.empty() ? 0 : ends_[0].size() * ends_[1].size();
  row.exchange.resize(nodes * depth_.size());
  for (std::size_t k = 0; k < exchange_.size(); ++k)
    for (std::size_t a = 0; a < i.node.size(); ++a)
      for (std::size_t b = 0; b < nodes; ++b)
        row.exchange[k * nodes + b] += i.weight[a] * exchange_[k][i.node[a] * nodes + b];
  return row;
}

double WaveField::visits(const Row& i, const End& o, std::size_t k) const {
  if (i.exchange.empty()) return 1;
  const std::size_t nodes = i.exchange.size() / depth_.size();
  double sum = one_visit_of_product(depth_[k], i.below, o.below);
  for (std::size_t b = 0; b < o.node.size(); ++b) sum += o.weight[b] * i.exchange[k * nodes + o.node[b]];
  return sum;
}

Rgb WaveField::rest(const Row& i, const End& o) const {
  Rgb sum;
  for (std::size_t k = 0; k < depth_.size(); ++k)
    sum += gain_[k] * i.share[k] * o.share[k] * visits(i, o, k) * wavelengths_.weight[k];
  return sum;
}

}  // namespace sunbeam::inline v1
