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

// Cosine of total reflection; 0 if there is none.
double critical_cosine(double ior_from, double ior_to) {
  return std::sqrt(std::max(0.0, 1 - square(ior_to / ior_from)));
}

// As seen from the film's exterior.
double critical_cosine(const ThinFilm& film) { return critical_cosine(film.exterior_ior, film.base_ior); }

// The normals visible from w (azimuth 0), by stretching the surface to roughness 1, where their density over
// half the angle between w and its mirror image is uniform (Heitz 2018): polar angle about the stretched w,
// azimuth towards the horizon nearest to it. A normal is k / |k|, k = k0 + k1(azimuth) tan(polar), and curves
// cross the normals where what the light does changes abruptly:
//   cones      w.k = c |k|: total reflection at the base, and at the film where light tunnels beyond it;
//   rim        m.z = 0 for light refracted to k ~ ratio w - m, ratio = n0 / n2 > 1. In slopes k.x / k.z and
//              k.y / k.z a circle about w, so a quadratic in tan(polar). Only its arc with m.k > 0 is real;
//              the rest costs a few nodes and no error.
class VisibleNormals {
 public:
  VisibleNormals(const Vec3& w, double alpha, const ThinFilm& film, double ratio)
      : w_(w),
        alpha_(alpha),
        cones_{critical_cosine(film.exterior_ior, film.base_ior),
               critical_cosine(film.exterior_ior, film.film_ior)},
        ratio_(ratio),
        stretched_length_(std::hypot(alpha * w.x, w.z)),
        axis_{alpha * w.x / stretched_length_, 0, w.z / stretched_length_} {
    if (cones_[1] <= cones_[0]) cones_[1] = 0;  // the base reflects all there
  }

  Vec3 normal(double polar, double azimuth) const {
    const Vec3 k = std::cos(polar) * k0() + std::sin(polar) * k1(azimuth);
    return normalize({k.x, k.y, std::max(0.0, k.z)});
  }

  // Over polar angle and azimuth in [0, pi].
  double density(double polar) const { return 2 * std::sin(2 * polar) / (kPi * (1 + axis_.z)); }

  // Azimuths between which the bounds of polar_edges() are smooth: the horizon is met up to pi / 2, a cone is
  // touched by, and leaves the horizon at, one azimuth each, the rim is touched and ends at one each.
  std::array<double, 9> azimuth_edges() const {
    std::array<double, 9> edges{0, kPi / 2, kPi};
    for (std::size_t k = 0; k < cones_.size(); ++k) {
      edges[3 + 2 * k] = cone_tangent(cones_[k]);
      edges[4 + 2 * k] = cone_end(cones_[k]);
    }
    if (meets_rim()) {
      edges[7] = rim_tangent();
      edges[8] = rim_end();
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  // 0, where the cones and the rim begin and end, the horizon; ascending.
  std::array<double, 8> polar_edges(double azimuth) const {
    const double end = std::atan2(axis_.z, std::max(0.0, axis_.x * std::cos(azimuth)));
    std::array<double, 8> edges{0, end};
    const Vec3 a = k0(), b = k1(azimuth);
    int count = 2;
    for (const double cone : cones_)
      if (cone > 0)
        cut({dot(a, a) - square(stretched_length_ / cone), dot(a, b), dot(b, b)}, end, &edges[count]),
            count += 2;
    if (meets_rim()) cut(rim(a, b), end, &edges[count]);
    std::sort(edges.begin(), edges.end());
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
  // c + 2 b t + a t^2, t = tan(polar).
  struct Quadratic {
    double c, b, a;
  };

  Vec3 k0() const { return {alpha_ * axis_.x, 0, axis_.z}; }
  Vec3 k1(double azimuth) const {
    const double c = std::cos(azimuth);
    return {alpha_ * c * axis_.z, alpha_ * std::sin(azimuth), -c * axis_.x};
  }

  // The two roots as polar angles inside [0, end]; twice the nearest to one if there is none.
  static void cut(const Quadratic& q, double end, double* edges) {
    const auto polar = [&](double tangent) { return tangent > 0 ? std::min(std::atan(tangent), end) : 0; };
    const double root = std::sqrt(std::max(0.0, square(q.b) - q.a * q.c));
    const double larger = -(q.b + std::copysign(root, q.b));
    edges[0] = polar(larger / q.a);
    edges[1] = root > 0 ? polar(q.c / larger) : edges[0];
  }

  double cone_tangent(double cone) const {
    const double outside = dot(k0(), k0()) - square(stretched_length_ / cone);
    if (cone == 0 || outside <= 0) return 0;
    const double slope = square(axis_.x) * (1 - square(alpha_));
    const double cos2 =
        outside * square(alpha_) / (square(axis_.z) * slope * (1 - square(alpha_)) - outside * slope);
    return cos2 > 0 && cos2 < 1 ? std::acos(std::sqrt(cos2)) : 0;
  }
  double cone_end(double cone) const {
    if (cone == 0 || w_.x <= cone) return 0;
    const double cosine = cone / w_.x;
    return std::atan2(std::sqrt(1 - square(cosine)), cosine * axis_.z);
  }

  bool meets_rim() const { return ratio_ * w_.x > 1; }
  // (k.x w.z - k.z w.x)^2 + (k.y w.z)^2 - (k.z / ratio)^2 along k = a + b t; a.y = 0.
  Quadratic rim(const Vec3& a, const Vec3& b) const {
    const auto tilt = [&](const Vec3& k) { return k.x * w_.z - k.z * w_.x; };
    const double za = a.z / ratio_, zb = b.z / ratio_;
    return {square(tilt(a)) - square(za), tilt(a) * tilt(b) - za * zb,
            square(tilt(b)) + square(b.y * w_.z) - square(zb)};
  }
  // Where the discriminant of rim() vanishes: b^2 = a c at azimuth 0 grows like cos^2 on the left, and the
  // right gains (alpha w.z)^2 sin^2.
  double rim_tangent() const {
    const Quadratic q = rim(k0(), k1(0));
    if (q.c <= 0) return 0;
    const double azimuth =
        std::atan(std::sqrt(std::max(0.0, square(q.b) - q.a * q.c) / q.c) / (alpha_ * w_.z));
    return q.b < 0 ? azimuth : kPi - azimuth;
  }
  // Where the real arc ends on the cone of total reflection: ratio w.m = 1.
  double rim_end() const {
    const double cosine = 1 / (ratio_ * w_.x);
    const Vec3 stretched{(ratio_ * w_.x - cosine) / alpha_, std::sqrt(1 - square(cosine)) / alpha_,
                         ratio_ * w_.z};
    return std::atan2(stretched.y, axis_.z * stretched.x - axis_.x * stretched.z);
  }

  Vec3 w_;
  double alpha_;
  std::array<double, 2> cones_;
  double ratio_, stretched_length_;
  Vec3 axis_;
};

double min_component(const Rgb& a) { return std::min({a.r, a.g, a.b}); }

}  // namespace

FilmIntegrals::FilmIntegrals(const Material& material, const Rgb& wavelengths_nm,
                             const ExactResolution& resolution)
    : material_(material),
      resolution_(resolution),
      interface_(material, wavelengths_nm),
      film_(ThinFilm::of(material)),
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
  const double waves = (phase(film_, 1) - phase(film_, 0)) * std::min(1.0, 4 * material_.roughness.u);
  const int wanted = resolution_.visible + static_cast<int>(kVisibleNodesPerRadian * waves);
  return std::min(wanted, std::max(kMaxVisibleNodes, resolution_.visible));
}

// Calls visit(w, facet, weight) for normals visible from w, turned to azimuth 0; the weights of all normals
// sum to 1. What mirrors w under the horizon is left out if only_mirrored, without a kink for the quadrature.
template <class F>
void FilmIntegrals::visit_visible(const Vec3& w, bool only_mirrored, F visit) const {
  const Vec3 from = direction_from_cosine(w.z, 0);
  const VisibleNormals visible(from, material_.roughness.u, film_, index_ratio_);
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
    const double theta = std::atan2(material_.roughness.u * x, 1 - x);
    const double dtheta =
        material_.roughness.u / (square(1 - x) + square(material_.roughness.u * x)) * normals_.weight[i];
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
