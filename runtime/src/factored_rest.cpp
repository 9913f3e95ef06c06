#include "factored_rest.h"

namespace sunbeam {

FactoredRest::FactoredRest(const Table& table, const Material& material)
    : material_(material),
      wavelengths_(table.factors.wavelengths),
      film_(wavelengths_, material.exterior_ior, material.film_ior) {
  for (std::size_t k = 0; k < wavelengths_.size(); ++k) {
    depth_.push_back(material.optical_depth() * wavelengths_.absorption[k]);
    gain_.push_back(material.radiance_scale() * wavelengths_.albedo[k] * kInvPi);
  }
  if (!material.is_smooth()) take_arrival(table.factors);
  if (table.factors.exchange.empty())
    take_gain(table.factors);
  else
    take_exchange(table.factors);
}

// One slice for all wavelengths of the same optical depth.
void FactoredRest::take_arrival(const Factors& factors) {
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const bool is_new = k == 0 || (depth_[k] != depth_[0] && factors.arrival.axes()[1].size() > 1);
    arrival_.push_back(is_new ? factors.arrival.slice(std::array{material_.base_ior, depth_[k]})
                              : arrival_[0]);
  }
}

void FactoredRest::take_gain(const Factors& factors) {
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const double order = fringe_order(material_, 1) * material_.film_thickness_nm / wavelengths_.nm[k];
    const double returned = factors.returned.interpolate(std::array{material_.base_ior, depth_[k], order}).r;
    gain_[k] /= 1 - wavelengths_.albedo[k] * returned;
  }
}

void FactoredRest::take_exchange(const Factors& factors) {
  ends_ = {factors.exchange.axes()[4], factors.exchange.axes()[5]};
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    const double order = fringe_order(material_, 1) * material_.film_thickness_nm / wavelengths_.nm[k];
    const NdArray slice =
        factors.exchange.slice(std::array{material_.base_ior, depth_[k], wavelengths_.albedo[k], order});
    exchange_.emplace_back(slice.values().begin(), slice.values().end());
  }
}

FactoredRest::End FactoredRest::end(double cosine, double phi) const {
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

FactoredRest::Row FactoredRest::row(const End& i) const {
  Row row{i.below, i.share, {}};
  const std::size_t nodes = exchange_.empty() ? 0 : ends_[0].size() * ends_[1].size();
  row.exchange.resize(nodes * depth_.size());
  for (std::size_t k = 0; k < exchange_.size(); ++k)
    for (std::size_t a = 0; a < i.node.size(); ++a)
      for (std::size_t b = 0; b < nodes; ++b)
        row.exchange[k * nodes + b] += i.weight[a] * exchange_[k][i.node[a] * nodes + b];
  return row;
}

Rgb FactoredRest::rest(const Row& i, const End& o) const {
  Rgb sum;
  const std::size_t nodes = i.exchange.size() / depth_.size();
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    double value = gain_[k] * i.share[k] * o.share[k];
    if (nodes > 0) {
      double visits = one_visit_of_product(depth_[k], i.below, o.below);
      for (std::size_t b = 0; b < o.node.size(); ++b)
        visits += o.weight[b] * i.exchange[k * nodes + o.node[b]];
      value *= visits;
    }
    sum += value * wavelengths_.weight[k];
  }
  return sum;
}

}  // namespace sunbeam
