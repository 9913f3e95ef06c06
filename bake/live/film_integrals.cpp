#include "bake/live/film_integrals.h"

namespace sunbeam {
namespace {

// Nodes for a film power on a panel that its phase crosses by at most kPhaseStep radians: the third harmonic
// still has more than two nodes a period.
constexpr int kFineNodes = 20;
constexpr double kPhaseStep = 5;
// Extra nodes a radian of phase for normals visible from one direction, and where they end (time, not error).
constexpr double kVisibleNodesPerRadian = 0.3;
constexpr int kMaxVisibleNodes = 400;

// A panel's variable t in [0, 1]: flat ends turn square-root singularities there into smooth functions.
double smooth_step(double t) { return t * t * (3 - 2 * t); }
double smooth_step_slope(double t) { return 6 * t * (1 - t); }

// Calls visit(x, dx) for the nodes of every panel between neighbouring edges.
template <std::size_t kCount, class F>
void for_each_node(const std::array<double, kCount>& edges, const GaussRule& rule, F visit) {
  for (std::size_t p = 0; p + 1 < kCount; ++p) {
    const double width = edges[p + 1] - edges[p];
    if (width < 1e-12) continue;
    for (int i = 0; i < rule.size(); ++i)
      visit(edges[p] + width * smooth_step(rule.node[i]),
            width * smooth_step_slope(rule.node[i]) * rule.weight[i]);
  }
}

// Cosine of total reflection as seen from the film's exterior; 0 if there is none.
double critical_cosine(const ThinFilm& film) {
  return std::sqrt(std::max(0.0, 1 - square(film.base_ior / film.exterior_ior)));
}

// The normals visible from w (azimuth 0), by stretching the surface to roughness 1, where their density over
// half the angle between w and its mirror image is uniform (Heitz 2018): polar angle about the stretched w,
// azimuth towards the horizon nearest to it. A normal's cosine with w is |stretched w| cos(polar) / |k|, with
// k = k0 cos(polar) + k1(azimuth) sin(polar) the normal before normalisation.
class VisibleNormals {
 public:
  VisibleNormals(const Vec3& w, double alpha, double critical)
      : w_(w),
        alpha_(alpha),
        critical_(critical),
        stretched_length_(std::hypot(alpha * w.x, w.z)),
        axis_{alpha * w.x / stretched_length_, 0, w.z / stretched_length_} {}

  Vec3 normal(double polar, double azimuth) const {
    const Vec3 k = std::cos(polar) * k0() + std::sin(polar) * k1(azimuth);
    return normalize({k.x, k.y, std::max(0.0, k.z)});
  }

  // Over polar angle and azimuth in [0, pi].
  double density(double polar) const { return 2 * std::sin(2 * polar) / (kPi * (1 + axis_.z)); }

  // Azimuths between which the bounds of polar_edges() are smooth: the horizon is met up to pi / 2, the cone
  // of total reflection is touched by, and leaves the horizon at, one azimuth each.
  std::array<double, 5> azimuth_edges() const {
    std::array<double, 5> edges{0, kPi / 2, kPi, 0, 0};
    const double outside = dot(k0(), k0()) - square(stretched_length_ / critical_);
    if (critical_ > 0 && outside > 0) {
      const double slope = square(axis_.x) * (1 - square(alpha_));
      const double cos2 =
          outside * square(alpha_) / (square(axis_.z) * slope * (1 - square(alpha_)) - outside * slope);
      if (cos2 > 0 && cos2 < 1) edges[3] = std::acos(std::sqrt(cos2));
    }
    if (critical_ > 0 && w_.x > critical_) {
      const double cosine = critical_ / w_.x;
      edges[4] = std::atan2(std::sqrt(1 - square(cosine)), cosine * axis_.z);
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  // 0, where total reflection ends and begins again, the horizon; ascending.
  std::array<double, 4> polar_edges(double azimuth) const {
    const double end = std::atan2(axis_.z, std::max(0.0, axis_.x * std::cos(azimuth)));
    std::array<double, 4> edges{0, 0, end, end};
    if (critical_ == 0) return edges;
    const double a = dot(k1(azimuth), k1(azimuth)), b = dot(k0(), k1(azimuth));
    const double discriminant = b * b - a * (dot(k0(), k0()) - square(stretched_length_ / critical_));
    const double root = std::sqrt(std::max(0.0, discriminant));
    edges[1] = std::clamp(std::atan((-b - root) / a), 0.0, end);
    edges[2] = std::clamp(std::atan((-b + root) / a), 0.0, end);
    return edges;
  }

  // Up to where w is mirrored above the horizon: a convex set of normals, which holds the axis and no rim.
  double mirrored_end(double azimuth, double end) const {
    double low = 0, high = end;
    for (int step = 0; step < 40; ++step) {
      const double middle = (low + high) / 2;
      (reflect(w_, normal(middle, azimuth)).z > 0 ? low : high) = middle;
    }
    return low;
  }

 private:
  Vec3 k0() const { return {alpha_ * axis_.x, 0, axis_.z}; }
  Vec3 k1(double azimuth) const {
    const double c = std::cos(azimuth);
    return {alpha_ * c * axis_.z, alpha_ * std::sin(azimuth), -c * axis_.x};
  }

  Vec3 w_;
  double alpha_, critical_, stretched_length_;
  Vec3 axis_;
};

double min_component(const Rgb& a) { return std::min({a.r, a.g, a.b}); }

}  // namespace

FilmIntegrals::FilmIntegrals(const Material& material, const Rgb& wavelengths_nm,
                             const ExactResolution& resolution)
    : material_(material),
      resolution_(resolution),
      interface_(material, wavelengths_nm),
      film_{material.exterior_ior, material.film_ior, material.base_ior, material.film_thickness_nm},
      film_below_(material.transmission == Transmission::straight ? film_ : film_.reversed()),
      wavelengths_nm_(wavelengths_nm),
      index_ratio_(interface_.has_glossy_crossing() ? material.exterior_ior / material.base_ior : 1),
      ggx_(material.roughness),
      basis_(resolution.per_panel),
      cosine_panel_(resolution.cosines),
      fine_(gauss_legendre(kFineNodes)),
      normals_(gauss_legendre(resolution.normals)),
      azimuths_(gauss_legendre(resolution.azimuths)),
      visible_(gauss_legendre(visible_nodes())),
      visible_azimuths_(gauss_legendre(visible_nodes() * 3 / 4)) {}

// Phase difference of neighbouring reflections, radians, at the shortest wavelength.
double FilmIntegrals::phase(const ThinFilm& film, double cosine) const {
  const double cos1_squared = refracted_cosine_squared(film.exterior_ior, film.film_ior, cosine);
  return 4 * kPi * film.film_ior * film.thickness_nm / min_component(wavelengths_nm_) *
         std::sqrt(std::max(0.0, cos1_squared));
}

int FilmIntegrals::oscillation_panels(const ThinFilm& film, double low, double high) const {
  return 1 + static_cast<int>((phase(film, high) - phase(film, low)) / kPhaseStep);
}

// More where a wide lobe sees a thick film oscillate.
int FilmIntegrals::visible_nodes() const {
  const double waves = (phase(film_, 1) - phase(film_, 0)) * std::min(1.0, 4 * ggx_.alpha());
  const int wanted = resolution_.visible + static_cast<int>(kVisibleNodesPerRadian * waves);
  return std::min(wanted, std::max(kMaxVisibleNodes, resolution_.visible));
}

// Calls visit(w, facet, weight) for normals visible from w, turned to azimuth 0; the weights of all normals
// sum to 1. What mirrors w under the horizon is left out if only_mirrored, without a kink for the quadrature.
template <class F>
void FilmIntegrals::visit_visible(const Vec3& w, bool only_mirrored, F visit) const {
  const Vec3 from = direction_from_cosine(w.z, 0);
  const VisibleNormals visible(from, ggx_.alpha(), critical_cosine(film_));
  for_each_node(visible.azimuth_edges(), visible_azimuths_, [&](double azimuth, double dazimuth) {
    auto edges = visible.polar_edges(azimuth);
    const double end = only_mirrored ? visible.mirrored_end(azimuth, edges.back()) : edges.back();
    for (double& edge : edges) edge = std::min(edge, end);
    for_each_node(edges, visible_, [&](double polar, double dpolar) {
      const Vec3 h = visible.normal(polar, azimuth);
      const FilmPower power = interface_.power(std::clamp(dot(from, h), 0.0, 1.0));
      visit(from, Facet{h, power, mean(power.reflectance)}, visible.density(polar) * dpolar * dazimuth);
    });
  });
}

std::vector<PassagePoint> FilmIntegrals::passages(const Vec3& w) const {
  std::vector<PassagePoint> points;
  if (w.z <= 0) return points;
  if (interface_.is_smooth()) {
    const FilmPower power = interface_.power(w.z);
    const auto passage = interface_.cross(w, {{0, 0, 1}, power, mean(power.reflectance)});
    if (passage) points.push_back({passage->inside.z, passage->weight});
    return points;
  }
  if (has_single_crossing()) points.push_back({w.z, Rgb()});
  visit_visible(w, false, [&](const Vec3& from, const Facet& facet, double weight) {
    const auto passage = interface_.cross(from, facet);
    if (!passage) return;
    if (has_single_crossing())
      points.front().power += passage->weight * weight;
    else
      points.push_back({passage->inside.z, passage->weight * weight});
  });
  return points;
}

Rgb FilmIntegrals::first_albedo(const Vec3& w) const {
  if (w.z <= 0) return {};
  if (interface_.is_smooth()) return interface_.power(w.z).reflectance;
  Rgb sum;
  visit_visible(w, true, [&](const Vec3& from, const Facet& facet, double weight) {
    if (const auto up = interface_.reflect_up(from, facet)) sum += up->weight * weight;
  });
  return sum;
}

// Weights W_j = Int_low^high power(c) c L_j(c) dc of a panel's nodes c_j = low + (high - low)
// smooth_step(t_j): the film's oscillations are integrated here, and what multiplies them only has to be
// smooth.
std::vector<Rgb> FilmIntegrals::moments(Event event, double low, double high) const {
  const ThinFilm& film = film_of(event);
  std::vector<Rgb> result(cosine_panel_.size());
  const int parts = oscillation_panels(film, low, high);
  for (int part = 0; part < parts; ++part)
    for (int i = 0; i < fine_.size(); ++i) {
      const double t = (part + fine_.node[i]) / parts;
      const double cosine = lerp(smooth_step(t), low, high);
      const FilmPower power = airy(film, cosine, wavelengths_nm_);
      const Rgb value = (event == Event::passage ? power.transmittance : power.reflectance) *
                        (cosine * (high - low) * smooth_step_slope(t) * fine_.weight[i] / parts);
      const auto weights = cosine_panel_.at(t);
      for (int j = 0; j < cosine_panel_.size(); ++j) result[j] += value * weights[j];
    }
  return result;
}

// By the definition of the model: none for "straight", Walter's for light that bends, its limit between.
double FilmIntegrals::shadowing(Event event, double cosine, double partner) const {
  const Vec3 a = direction_from_cosine(cosine, 0);
  if (event == Event::passage && material_.transmission == Transmission::straight) return ggx_.g1(a);
  return ggx_.g2(a, direction_from_cosine(partner, 0));
}

// Int over the azimuth about a facet tilted by acos(cos_h) of a direction at `cosine` with its normal, inside
// the azimuths where the direction and its partner are above the horizon.
template <class F>
void FilmIntegrals::visit_azimuths(Event event, double cos_h, double cosine, const Rgb& weight,
                                   F visit) const {
  const bool mirrored = event == Event::reflection_below;
  const double sin_h = std::sqrt(1 - square(cos_h)), sine = std::sqrt(1 - square(cosine));
  const double partner_sine = mirrored ? -sine : index_ratio_ * sine;
  const double partner_cosine = mirrored ? cosine : std::sqrt(std::max(0.0, 1 - square(partner_sine)));
  const double height = cosine * cos_h, swing = sine * sin_h;
  const double partner_height = partner_cosine * cos_h, partner_swing = partner_sine * sin_h;
  // height + swing cos(phi) > 0, the same for the partner.
  const double lowest = mirrored ? height / swing : std::min(height / swing, partner_height / partner_swing);
  const double start = mirrored ? std::acos(std::min(1.0, lowest)) : 0;
  const double end = std::acos(-std::min(1.0, lowest));
  for (int k = 0; k < azimuths_.size(); ++k) {
    const double cos_phi = std::cos(lerp(azimuths_.node[k], start, end));
    const double a = height + swing * cos_phi, b = partner_height + partner_swing * cos_phi;
    if (a <= 0 || b <= 0) continue;
    const double both_sides = 2 * (end - start) * azimuths_.weight[k];
    visit(Meeting{std::min(a, 1.0), std::min(b, 1.0), weight * (both_sides * shadowing(event, a, b))});
  }
}

// Int dh D(h) Int dw (w.h) power(w.h) G(w, partner) visit(w.z, partner.z) over normals h and directions w:
// the substitution of (normal, direction) for the two directions puts the film's power, with its oscillations
// and its kink at total reflection, on one axis. tan(theta_h) = alpha x / (1 - x).
template <class F>
void FilmIntegrals::visit_facets(Event event, F visit) const {
  const double critical = critical_cosine(film_of(event));
  for (int i = 0; i < normals_.size(); ++i) {
    const double x = normals_.node[i];
    const double theta = std::atan2(ggx_.alpha() * x, 1 - x);
    const double dtheta = ggx_.alpha() / (square(1 - x) + square(ggx_.alpha() * x)) * normals_.weight[i];
    const double normal_weight =
        2 * kPi * std::sin(theta) * dtheta * ggx_.d({std::sin(theta), 0, std::cos(theta)});
    // Below sin(theta_h) part of the azimuths is under the horizon.
    std::array<double, 7> edges{0, 0.25, 0.5, 0.75, 1, std::sin(theta), critical};
    std::sort(edges.begin(), edges.end());
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
      if (edges[p + 1] - edges[p] < 1e-12) continue;
      if (event == Event::passage && edges[p + 1] <= critical) continue;
      const auto weights = moments(event, edges[p], edges[p + 1]);
      for (int j = 0; j < cosine_panel_.size(); ++j)
        visit_azimuths(event, std::cos(theta),
                       lerp(smooth_step(cosine_panel_.rule().node[j]), edges[p], edges[p + 1]),
                       weights[j] * normal_weight, visit);
    }
  }
}

// One interval inside a panel of the basis: Int L_k L_l R(mu) 2 pi mu dmu.
void FilmIntegrals::add_smooth_reflection(double low, double high, std::array<Matrix, 3>& sum) const {
  const int parts = oscillation_panels(film_below_, low, high), count = basis_.per_panel();
  for (int part = 0; part < parts; ++part)
    for (int i = 0; i < fine_.size(); ++i) {
      const double t = (part + fine_.node[i]) / parts;
      const double mu = lerp(smooth_step(t), low, high);
      const double dmu = (high - low) * smooth_step_slope(t) * fine_.weight[i] / parts;
      const Rgb weight = airy(film_below_, mu, wavelengths_nm_).reflectance * (2 * kPi * mu * dmu);
      const auto s = basis_.at(mu);
      for (int channel = 0; channel < 3; ++channel)
        for (int k = 0; k < count; ++k)
          add_scaled(weight[channel] * s.weight[k], s.weight.data(), count,
                     sum[channel].row(s.first + k) + s.first);
    }
}

std::array<Matrix, 3> FilmIntegrals::reflection() const {
  std::array<Matrix, 3> sum{Matrix(basis_.size()), Matrix(basis_.size()), Matrix(basis_.size())};
  if (interface_.is_smooth()) {
    const double critical = critical_cosine(film_below_);
    for (int p = 0; p < CosineBasis::kPanels; ++p) {
      const double low = CosineBasis::kEdges[p], high = CosineBasis::kEdges[p + 1];
      const double split = std::clamp(critical, low, high);
      if (split > low) add_smooth_reflection(low, split, sum);
      if (split < high) add_smooth_reflection(split, high, sum);
    }
  } else {
    visit_facets(Event::reflection_below, [&](const Meeting& m) {
      const auto up = basis_.at(m.cosine), down = basis_.at(m.partner);
      for (int channel = 0; channel < 3; ++channel)
        for (int k = 0; k < basis_.per_panel(); ++k)
          add_scaled(m.weight[channel] * up.weight[k], down.weight.data(), basis_.per_panel(),
                     sum[channel].row(up.first + k) + down.first);
    });
  }
  for (auto& matrix : sum) symmetrise(matrix);  // to the last bit, so that reciprocity is exact
  return sum;
}

std::array<Vector, 3> FilmIntegrals::exit(const std::array<Matrix, 3>& reflection) const {
  std::array<Vector, 3> sum;
  if (interface_.is_smooth()) {  // what is not reflected leaves
    for (int channel = 0; channel < 3; ++channel) {
      sum[channel] = multiply(Vector(basis_.size(), -1.0), reflection[channel]);
      add_scaled(1, basis_.cosine_weights().data(), basis_.size(), sum[channel].data());
    }
    return sum;
  }
  sum.fill(Vector(basis_.size()));
  visit_facets(Event::passage, [&](const Meeting& m) {
    const auto inside = basis_.at(m.partner);
    for (int channel = 0; channel < 3; ++channel)
      add_scaled(m.weight[channel] * material_.radiance_scale(), inside.weight.data(), basis_.per_panel(),
                 sum[channel].data() + inside.first);
  });
  return sum;
}

}  // namespace sunbeam
