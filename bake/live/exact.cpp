#include "bake/live/exact.h"

namespace sunbeam {

ExactRest::ExactRest(const Material& material, const Rgb& wavelengths_nm, const ExactResolution& resolution)
    : material_(material), film_(material, wavelengths_nm, resolution) {
  const auto reflection = film_.reflection();
  const auto exit = film_.exit(reflection);
  if (material.absorption_path == AbsorptionPath::sum)
    solve_sum(reflection, exit);
  else
    solve_product(reflection, exit);
}

// f1 / kd.
double ExactRest::attenuated(double cos_i, double cos_o) const {
  return kInvPi * std::exp(material_.absorption_exponent(cos_i, cos_o));
}

void ExactRest::solve_sum(const std::array<Matrix, 3>& reflection, const std::array<Vector, 3>& exit) {
  Vector attenuation;
  for (const double mu : film_.basis().nodes())
    attenuation.push_back(std::exp(-material_.optical_depth() / mu));
  for (int c = 0; c < 3; ++c) {
    const double rho = kInvPi * dot(multiply(attenuation, reflection[c]), attenuation);
    gain_[c] = material_.albedo[c] * kInvPi / (1 - material_.albedo[c] * rho);
    leaving_[c] = dot(exit[c], attenuation);
  }
}

void ExactRest::solve_product(const std::array<Matrix, 3>& reflection, const std::array<Vector, 3>& exit) {
  const int n = film_.basis().size();
  for (int c = 0; c < 3; ++c) {
    Matrix f(n);
    for (int i = 0; i < n; ++i)
      add_scaled(material_.albedo[c], towards_nodes(film_.basis().nodes()[i]).data(), n, f.row(i));
    Matrix system = multiply(reflection[c], f);  // 1 - B F
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) system.row(i)[k] = (i == k ? 1 : 0) - system.row(i)[k];
    Matrix m = solve(std::move(system), reflection[c]);
    symmetrise(m);
    albedo_[c] = multiply(multiply(exit[c], f), m);
    add_scaled(1, exit[c].data(), n, albedo_[c].data());
    visits_[c] = std::move(m);
    if (film_.has_single_crossing()) continue;
    albedo_[c] = multiply(albedo_[c], f);
    Matrix g = multiply(multiply(f, visits_[c]), f);
    for (int i = 0; i < n; ++i) add_scaled(1, f.row(i), n, g.row(i));
    symmetrise(g);
    visits_[c] = std::move(g);
  }
}

// v / kd of light that arrives at `cosine`.
Vector ExactRest::towards_nodes(double cosine) const {
  Vector v;
  v.reserve(film_.basis().size());
  for (const double mu : film_.basis().nodes()) v.push_back(attenuated(cosine, mu));
  return v;
}

// A(w).
Rgb ExactRest::arriving(const Vec3& w) const {
  Rgb sum;
  for (const auto& point : film_.passages(w))
    sum += point.power * std::exp(-material_.optical_depth() / point.cosine);
  return sum;
}

// p_t(w -> m) as weights of the nodes: interpolates what it will be multiplied with.
std::array<Vector, 3> ExactRest::on_nodes(const Vec3& w) const {
  const CosineBasis& basis = film_.basis();
  std::array<Vector, 3> sum;
  sum.fill(Vector(basis.size()));
  for (const auto& point : film_.passages(w)) {
    const auto stencil = basis.at(point.cosine);
    for (int c = 0; c < 3; ++c)
      add_scaled(point.power[c], stencil.weight.data(), basis.per_panel(), sum[c].data() + stencil.first);
  }
  return sum;
}

Rgb ExactRest::rest_of_sum(const Vec3& wo, const Vec3& wi) const {
  return gain_ * arriving(wo) * arriving(wi);
}

Rgb ExactRest::rest_of_product(const Vec3& wo, const Vec3& wi) const {
  const auto out = film_.passages(wo), in = film_.passages(wi);
  if (out.empty() || in.empty()) return {};
  const Vector v_out = towards_nodes(out[0].cosine), v_in = towards_nodes(in[0].cosine);
  const double first_visit = attenuated(out[0].cosine, in[0].cosine);
  Rgb visits;
  for (int c = 0; c < 3; ++c)
    visits[c] = first_visit + material_.albedo[c] * dot(multiply(v_in, visits_[c]), v_out);
  return material_.albedo * (out[0].power * in[0].power) * visits;
}

Rgb ExactRest::rest_through_facets(const Vec3& wo, const Vec3& wi) const {
  const auto out = on_nodes(wo), in = on_nodes(wi);
  Rgb sum;
  for (int c = 0; c < 3; ++c) sum[c] = std::max(0.0, dot(multiply(in[c], visits_[c]), out[c]));
  return sum;
}

Rgb ExactRest::rest(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const Rgb unscaled = material_.absorption_path == AbsorptionPath::sum ? rest_of_sum(wo, wi)
                       : film_.has_single_crossing()                    ? rest_of_product(wo, wi)
                                                                        : rest_through_facets(wo, wi);
  return unscaled * material_.radiance_scale();
}

Rgb ExactRest::rest_albedo(const Vec3& w) const {
  if (material_.absorption_path == AbsorptionPath::sum) return gain_ * arriving(w) * leaving_;
  Rgb sum;
  if (film_.has_single_crossing()) {
    for (const auto& point : film_.passages(w)) {
      const Vector v = towards_nodes(point.cosine);
      for (int c = 0; c < 3; ++c) sum[c] = material_.albedo[c] * point.power[c] * dot(v, albedo_[c]);
    }
    return sum;
  }
  const auto in = on_nodes(w);
  for (int c = 0; c < 3; ++c) sum[c] = dot(in[c], albedo_[c]);
  return sum;
}

Rgb ExactRest::albedo(const Vec3& w) const {
  if (w.z <= 0) return {};
  return film_.first_albedo(w) + rest_albedo(w);
}

}  // namespace sunbeam
