#include "bake/live/exact/exact.h"

#include <algorithm>

#include "bake/live/exact/resolvent.h"

namespace sunbeam {

ExactTriple::ExactTriple(const Material& material, const Wavelengths& three,
                         const ExactResolution& resolution)
    : material_(material),
      base_albedo_(three.triple(three.albedo, 0)),
      absorption_(three.triple(three.absorption, 0)),
      film_(material, three, resolution) {
  const auto reflection = film_.reflection();
  const auto exit = film_.exit(reflection);
  if (material.absorption_path == AbsorptionPath::sum)
    solve_sum(reflection, exit);
  else
    solve_product(reflection, exit);
}

// exp of the material's own exponent, scaled to each wavelength. Often all absorb alike.
Rgb ExactTriple::attenuation(double exponent) const {
  if (absorption_.r == absorption_.g && absorption_.g == absorption_.b)
    return Rgb(std::exp(absorption_.r * exponent));
  return transform(absorption_, [&](double relative) { return std::exp(relative * exponent); });
}

// f1 / kd.
Rgb ExactTriple::attenuated(double cos_i, double cos_o) const {
  return kInvPi * attenuation(material_.absorption_exponent(cos_i, cos_o));
}

void ExactTriple::solve_sum(const Matrices& reflection, const Vectors& exit) {
  Vectors attenuation_at;
  for (const double mu : film_.basis().nodes()) {
    const Rgb value = attenuation(-material_.optical_depth() / mu);
    for (int c = 0; c < 3; ++c) attenuation_at[c].push_back(value[c]);
  }
  for (int c = 0; c < 3; ++c) {
    const double rho = kInvPi * dot(multiply(attenuation_at[c], reflection[c]), attenuation_at[c]);
    gain_[c] = base_albedo_[c] * kInvPi / (1 - base_albedo_[c] * rho);
    leaving_[c] = dot(exit[c], attenuation_at[c]);
  }
}

void ExactTriple::solve_product(const Matrices& reflection, const Vectors& exit) {
  const int n = film_.basis().size();
  Matrices f{Matrix(n), Matrix(n), Matrix(n)};
  for (int i = 0; i < n; ++i) {
    const Vectors v = towards_nodes(film_.basis().nodes()[i]);
    for (int c = 0; c < 3; ++c) add_scaled(base_albedo_[c], v[c].data(), n, f[c].row(i));
  }
  for (int c = 0; c < 3; ++c) {
    Matrix m = resolvent(multiply(reflection[c], f[c]), reflection[c]);
    symmetrise(m);
    exit_[c] = multiply(multiply(exit[c], f[c]), m);
    add_scaled(1, exit[c].data(), n, exit_[c].data());
    visits_[c] = std::move(m);
    if (film_.has_single_crossing()) continue;
    exit_[c] = multiply(exit_[c], f[c]);
    Matrix g = multiply(multiply(f[c], visits_[c]), f[c]);
    for (int i = 0; i < n; ++i) add_scaled(1, f[c].row(i), n, g.row(i));
    symmetrise(g);
    visits_[c] = std::move(g);
  }
}

// v / kd of light that arrives at `cosine`.
ExactTriple::Vectors ExactTriple::towards_nodes(double cosine) const {
  Vectors v;
  for (Vector& channel : v) channel.reserve(film_.basis().size());
  for (const double mu : film_.basis().nodes()) {
    const Rgb value = attenuated(cosine, mu);
    for (int c = 0; c < 3; ++c) v[c].push_back(value[c]);
  }
  return v;
}

// What the film lets through, all in all.
Rgb ExactTriple::passing(const std::vector<CrossingNode>& crossings) const {
  Rgb sum;
  for (const CrossingNode& crossing : crossings) sum += film_.transmittance(crossing) * crossing.share;
  return sum;
}

Rgb ExactTriple::arriving(const std::vector<CrossingNode>& crossings) const {
  const auto pigment = [&](double cosine) { return attenuation(-material_.optical_depth() / cosine); };
  if (crossings.empty()) return {};
  if (film_.has_single_crossing()) return passing(crossings) * pigment(crossings.front().cosine);
  Rgb sum;
  for (const CrossingNode& crossing : crossings)
    sum += film_.transmittance(crossing) * pigment(crossing.cosine) * crossing.share;
  return sum;
}

// p_t(w -> m) as weights of the nodes: interpolates what it will be multiplied with.
ExactTriple::Vectors ExactTriple::on_nodes(const std::vector<CrossingNode>& crossings) const {
  const CosineBasis& basis = film_.basis();
  Vectors sum;
  sum.fill(Vector(basis.size()));
  for (const CrossingNode& crossing : crossings) {
    const auto stencil = basis.at(crossing.cosine);
    const Rgb power = film_.transmittance(crossing) * crossing.share;
    for (int c = 0; c < 3; ++c)
      add_scaled(power[c], stencil.weight.data(), basis.per_panel(), sum[c].data() + stencil.first);
  }
  return sum;
}

ExactTriple::Side ExactTriple::side(const std::vector<CrossingNode>& crossings) const {
  if (material_.absorption_path == AbsorptionPath::sum) return {arriving(crossings), {}, 0};
  if (!film_.has_single_crossing()) return {{}, on_nodes(crossings), 0};
  const double cosine = crossings.empty() ? 1 : crossings.front().cosine;
  return {passing(crossings), towards_nodes(cosine), cosine};
}

Rgb ExactTriple::rest(const Side& wo, const Side& wi) const {
  if (material_.absorption_path == AbsorptionPath::sum) return gain() * (wo.power * wi.power);
  Rgb visits;
  for (int c = 0; c < 3; ++c) visits[c] = dot(multiply(wi.on_nodes[c], visits_[c]), wo.on_nodes[c]);
  if (!film_.has_single_crossing())
    return material_.radiance_scale() * transform(visits, [](double x) { return std::max(0.0, x); });
  const Rgb first = attenuated(wo.cosine, wi.cosine);
  return material_.radiance_scale() * base_albedo_ * (wo.power * wi.power) * (first + base_albedo_ * visits);
}

Rgb ExactTriple::rest_albedo(const std::vector<CrossingNode>& crossings) const {
  if (material_.absorption_path == AbsorptionPath::sum) return gain_ * arriving(crossings) * leaving_;
  const Side in = side(crossings);
  Rgb sum;
  for (int c = 0; c < 3; ++c) sum[c] = dot(in.on_nodes[c], exit_[c]);
  return film_.has_single_crossing() ? base_albedo_ * in.power * sum : sum;
}

ExactRest::ExactRest(const Material& material, const Wavelengths& wavelengths,
                     const ExactResolution& resolution)
    : wavelengths_(wavelengths), is_layered_(is_layered(material, wavelengths)) {
  for (std::size_t first = 0; first < wavelengths.size(); first += 3)
    triples_.emplace_back(material, three_wavelengths(wavelengths, first), resolution);
  const auto shortest = std::min_element(wavelengths.nm.begin(), wavelengths.nm.end());
  finest_ = static_cast<std::size_t>(shortest - wavelengths.nm.begin()) / 3;
}

template <class F>
std::vector<double> ExactRest::each(F of_triple) const {
  std::vector<double> values;
  for (const ExactTriple& triple : triples_) {
    const Rgb value = of_triple(triple);
    values.insert(values.end(), {value.r, value.g, value.b});
  }
  values.resize(wavelengths_.size());
  return values;
}

// Calls of_triple(triple, crossings) with the crossings of w.
template <class F>
std::vector<double> ExactRest::each_crossed(const Vec3& w, F of_triple) const {
  if (is_layered_)
    return each([&](const ExactTriple& triple) { return of_triple(triple, triple.crossings(w)); });
  const auto shared = triples_[finest_].crossings(w);
  return each([&](const ExactTriple& triple) { return of_triple(triple, shared); });
}

std::vector<Rgb> ExactRest::rest(std::span<const Vec3> wo, const Vec3& wi) const {
  std::vector<Rgb> values(wo.size());
  if (wi.z <= 0) return values;
  std::vector<ExactTriple::Side> sides;
  each_crossed(wi, [&](const ExactTriple& triple, const auto& in) {
    sides.push_back(triple.side(in));
    return Rgb();
  });
  for (std::size_t k = 0; k < wo.size(); ++k) {
    if (wo[k].z <= 0) continue;
    auto side = sides.begin();
    values[k] = wavelengths_.fold(each_crossed(wo[k], [&](const ExactTriple& triple, const auto& out) {
      return triple.rest(triple.side(out), *side++);
    }));
  }
  return values;
}

Rgb ExactRest::albedo(const Vec3& w) const {
  if (w.z <= 0) return {};
  return wavelengths_.fold(each_crossed(w, [&](const ExactTriple& triple, const auto& in) {
    return triple.first_albedo(w) + triple.rest_albedo(in);
  }));
}

Rgb ExactRest::rest_albedo(const Vec3& w) const {
  if (w.z <= 0) return {};
  return wavelengths_.fold(
      each_crossed(w, [](const ExactTriple& triple, const auto& in) { return triple.rest_albedo(in); }));
}

std::vector<double> ExactRest::facet_reflectance(double cosine) const {
  return each([&](const ExactTriple& triple) { return triple.facet_reflectance(cosine); });
}

std::vector<double> ExactRest::arriving(const Vec3& w) const {
  return each_crossed(w, [](const ExactTriple& triple, const auto& in) { return triple.arriving(in); });
}

std::vector<double> ExactRest::gain() const {
  return each([](const ExactTriple& triple) { return triple.gain(); });
}

}  // namespace sunbeam
