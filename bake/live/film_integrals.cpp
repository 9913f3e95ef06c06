#include "bake/live/film_integrals.h"

#include <span>

namespace sunbeam {
namespace {

// Nodes for a film power on a panel that its phase crosses by at most kPhaseStep radians: the third harmonic
// still has more than two nodes a period.
constexpr int kFineNodes = 20;
constexpr double kPhaseStep = 5;
// Share of the anisotropy that azimuths of the normal leave out.
constexpr double kTurnsError = 1e-8;
// Extra nodes a radian of phase for normals visible from one direction, and where they end (time, not error).
constexpr double kVisibleNodesPerRadian = 0.3;
constexpr int kMaxVisibleNodes = 400;

// A panel's variable t in [0, 1]: flat ends turn square-root singularities there into smooth functions.
double smooth_step(double t) { return t * t * (3 - 2 * t); }
double smooth_step_slope(double t) { return 6 * t * (1 - t); }

// Calls visit(x, dx) for the nodes of every panel between neighbouring edges.
template <class F>
void for_each_node(std::span<const double> edges, const GaussRule& rule, F visit) {
  for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
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

// A cone of normals k: where the symmetric bilinear form of k with itself vanishes.
struct Conic {
  Vec3 w;
  double cone, ratio;  // one of them is 0

  // w.k = cone |k|, or |(k.x, k.y) w.z - k.z (w.x, w.y)| = k.z / ratio.
  double operator()(const Vec3& a, const Vec3& b) const {
    if (cone > 0) return dot(a, b) - dot(w, a) * dot(w, b) / square(cone);
    const auto x = [&](const Vec3& k) { return k.x * w.z - k.z * w.x; };
    const auto y = [&](const Vec3& k) { return k.y * w.z - k.z * w.y; };
    return x(a) * x(b) + y(a) * y(b) - a.z * b.z / square(ratio);
  }
};

// The normals visible from w, by stretching the surface to roughness 1, where their density over half the
// angle between w and its mirror image is uniform (Heitz 2018): polar angle about the stretched w, azimuth
// from the horizon nearest to it. A normal is k / |k|, k = k0 + k1(azimuth) tan(polar), and conics cross the
// normals where what the light does changes abruptly:
//   cones      w.k = c |k|: total reflection at the base, and at the film where light tunnels beyond it;
//   rim        m.z = 0 for light refracted to k ~ ratio w - m, ratio = n0 / n2 > 1. In slopes k.x / k.z and
//              k.y / k.z a circle about w. Only its arc with m.k > 0 is real; the rest costs a few nodes and
//              no error.
// Along k each is a quadratic in tan(polar). If the film is isotropic, azimuths in [0, pi] stand for all.
class VisibleNormals {
 public:
  VisibleNormals(const Vec3& w, const Roughness& roughness, const ThinFilm& film, double ratio)
      : w_(w), roughness_(roughness), ratio_(ratio), axis_(normalize(stretched(w))) {
    const double sine = std::hypot(axis_.x, axis_.y);
    const double x = sine > 0 ? axis_.x / sine : 1, y = sine > 0 ? axis_.y / sine : 0;
    forward_ = {axis_.z * x, axis_.z * y, -sine};
    sideways_ = {-y, x, 0};
    const double base = critical_cosine(film.exterior_ior, film.base_ior);
    const double inside = critical_cosine(film.exterior_ior, film.film_ior);
    if (base > 0) conics_.push_back({w, base, 0});
    if (inside > base) conics_.push_back({w, inside, 0});  // else the base reflects all there
    if (ratio * sine_of_w() > 1) conics_.push_back({w, 0, ratio});
  }

  Vec3 normal(double polar, double azimuth) const {
    const Vec3 k = std::cos(polar) * k0() + std::sin(polar) * k1(azimuth);
    return normalize({k.x, k.y, std::max(0.0, k.z)});
  }

  // Over polar angle and azimuth, between the first and the last of azimuth_edges().
  double density(double polar) const {
    return (is_halved() ? 2 : 1) * std::sin(2 * polar) / (kPi * (1 + axis_.z));
  }

  // Azimuths between which the bounds of polar_edges() are smooth: the horizon is met between -pi / 2 and
  // pi / 2; a conic is touched by two, and two go through where it leaves the horizon or its arc ends.
  std::vector<double> azimuth_edges() const {
    std::vector<double> edges{0, kPi / 2, kPi};
    const auto add = [&](double azimuth) {
      if (!is_halved() || (azimuth > 0 && azimuth < kPi)) edges.push_back(azimuth);
    };
    add(-kPi / 2);
    add(-kPi);
    for (const Conic& conic : conics_) {
      for (const double azimuth : tangents(conic)) add(azimuth);
      for (const double azimuth : ends(conic)) add(azimuth);
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  // 0, where the conics begin and end, the horizon; ascending.
  std::array<double, 8> polar_edges(double azimuth) const {
    const double end = std::atan2(axis_.z, std::max(0.0, -forward_.z * std::cos(azimuth)));
    std::array<double, 8> edges{0, end};
    const Vec3 a = k0(), b = k1(azimuth);
    int count = 2;
    for (const Conic& conic : conics_) {
      cut({conic(a, a), conic(a, b), conic(b, b)}, end, &edges[count]);
      count += 2;
    }
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

  bool is_halved() const { return roughness_.is_isotropic(); }
  double sine_of_w() const { return std::hypot(w_.x, w_.y); }
  Vec3 stretched(const Vec3& a) const { return {roughness_.u * a.x, roughness_.v * a.y, a.z}; }
  Vec3 k0() const { return stretched(axis_); }
  Vec3 k1(double azimuth) const {
    return stretched(std::cos(azimuth) * forward_ + std::sin(azimuth) * sideways_);
  }
  double azimuth_of(const Vec3& k) const {
    const Vec3 a{k.x / roughness_.u, k.y / roughness_.v, k.z};
    return std::atan2(dot(a, sideways_), dot(a, forward_));
  }

  // The two roots as polar angles inside [0, end]; twice the nearest to one if there is none.
  static void cut(const Quadratic& q, double end, double* edges) {
    const auto polar = [&](double tangent) { return tangent > 0 ? std::min(std::atan(tangent), end) : 0; };
    const double root = std::sqrt(std::max(0.0, square(q.b) - q.a * q.c));
    const double larger = -(q.b + std::copysign(root, q.b));
    edges[0] = polar(larger / q.a);
    edges[1] = root > 0 ? polar(q.c / larger) : edges[0];
  }

  // Where the discriminant of the quadratic, itself a quadratic form of (cos, sin) of the azimuth, vanishes
  // and the double root is ahead.
  std::vector<double> tangents(const Conic& conic) const {
    const Vec3 a = k0(), p = stretched(forward_), q = stretched(sideways_);
    const double aa = conic(a, a), ap = conic(a, p), aq = conic(a, q);
    const double pp = ap * ap - aa * conic(p, p), pq = ap * aq - aa * conic(p, q),
                 qq = aq * aq - aa * conic(q, q);
    const double middle = (pp + qq) / 2, swing = std::hypot((pp - qq) / 2, pq);
    if (swing <= std::abs(middle)) return {};
    const double centre = std::atan2(pq, (pp - qq) / 2), spread = std::acos(-middle / swing);
    std::vector<double> azimuths;
    for (const double twice : {centre - spread, centre + spread})
      for (const double turn : {0.0, kPi}) {
        const double azimuth = std::remainder(twice / 2 + turn, 2 * kPi);
        const Vec3 b = k1(azimuth);
        if (conic(a, b) * conic(b, b) < 0) azimuths.push_back(azimuth);
      }
    return azimuths;
  }

  // A cone leaves the horizon at two azimuths; the arc of the rim ends on the cone of total reflection,
  // ratio w.m = 1.
  std::vector<double> ends(const Conic& conic) const {
    const double cosine = conic.cone > 0 ? conic.cone / sine_of_w() : 1 / (ratio_ * sine_of_w());
    if (cosine >= 1) return {};
    std::vector<double> azimuths;
    for (const double sign : {-1.0, 1.0}) {
      const double turn = std::atan2(w_.y, w_.x) + sign * std::acos(cosine);
      const Vec3 flat{std::cos(turn), std::sin(turn), 0};
      azimuths.push_back(azimuth_of(conic.cone > 0 ? flat : ratio_ * w_ - flat));
    }
    return azimuths;
  }

  Vec3 w_;
  Roughness roughness_;
  double ratio_;
  Vec3 axis_, forward_, sideways_;  // of the stretched space: w, towards the horizon, along the horizon
  std::vector<Conic> conics_;
};

// How many even azimuths average functions of GGX's slopes, whose Fourier modes shrink by (v - u) / (v + u).
int turns_of(const Roughness& roughness) {
  const double shrink = std::abs(roughness.u - roughness.v) / (roughness.u + roughness.v);
  return shrink == 0 ? 1 : 2 + static_cast<int>(std::log(kTurnsError) / std::log(shrink));
}

double min_component(const Rgb& a) { return std::min({a.r, a.g, a.b}); }

}  // namespace

FilmIntegrals::FilmIntegrals(const Material& material, const Rgb& wavelengths_nm,
                             const ExactResolution& resolution)
    : material_(material),
      resolution_(resolution),
      interface_(material, wavelengths_nm),
      film_(ThinFilm::of(material)),
      film_below_(ThinFilm::below(material)),
      wavelengths_nm_(wavelengths_nm),
      index_ratio_(interface_.has_glossy_crossing() ? material.exterior_ior / material.base_ior : 1),
      ggx_(material.roughness),
      basis_(resolution.per_panel),
      cosine_panel_(resolution.cosines),
      fine_(gauss_legendre(kFineNodes)),
      normals_(gauss_legendre(resolution.normals)),
      azimuths_(gauss_legendre(resolution.azimuths)),
      visible_(gauss_legendre(visible_nodes())),
      visible_azimuths_(gauss_legendre(visible_nodes() * 3 / 4)) {
  const int count = turns_of(material.roughness);
  for (int k = 0; k < count; ++k) turns_.push_back(kPi * k / count);
}

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
  const double waves = (phase(film_, 1) - phase(film_, 0)) * std::min(1.0, 4 * wider());
  const int wanted = resolution_.visible + static_cast<int>(kVisibleNodesPerRadian * waves);
  return std::min(wanted, std::max(kMaxVisibleNodes, resolution_.visible));
}

// Calls visit(w, normal, weight) for normals visible from w, turned to azimuth 0 if the film is isotropic;
// the weights of all normals sum to 1. What mirrors w under the horizon is left out if only_mirrored, without
// a kink for the quadrature.
template <class F>
void FilmIntegrals::visit_visible(const Vec3& w, bool only_mirrored, F visit) const {
  const Vec3 from = material_.roughness.is_isotropic() ? direction_from_cosine(w.z, 0) : w;
  const VisibleNormals visible(from, material_.roughness, film_, index_ratio_);
  for_each_node(visible.azimuth_edges(), visible_azimuths_, [&](double azimuth, double dazimuth) {
    auto edges = visible.polar_edges(azimuth);
    const double end = only_mirrored ? visible.mirrored_end(azimuth, edges.back()) : edges.back();
    for (double& edge : edges) edge = std::min(edge, end);
    for_each_node(edges, visible_, [&](double polar, double dpolar) {
      visit(from, visible.normal(polar, azimuth), visible.density(polar) * dpolar * dazimuth);
    });
  });
}

std::vector<Passage> FilmIntegrals::passages(const Vec3& w) const {
  const FilmPower all{Rgb(0), Rgb(1)};
  std::vector<Passage> result;
  const auto add = [&](const Vec3& from, const Vec3& normal, double weight) {
    const double cosine = std::clamp(dot(from, normal), 0.0, 1.0);
    if (const auto crossing = interface_.cross(from, {normal, all, 0}))
      result.push_back({cosine, crossing->inside.z, weight * crossing->weight.r});
  };
  if (w.z <= 0) return result;
  if (interface_.is_smooth())
    add(w, {0, 0, 1}, 1);
  else
    visit_visible(w, false, add);
  return result;
}

Rgb FilmIntegrals::first_albedo(const Vec3& w) const {
  if (w.z <= 0) return {};
  if (interface_.is_smooth()) return interface_.power(w.z).reflectance;
  Rgb sum;
  visit_visible(w, true, [&](const Vec3& from, const Vec3& normal, double weight) {
    const FilmPower power = interface_.power(std::clamp(dot(from, normal), 0.0, 1.0));
    if (const auto up = interface_.reflect_up(from, {normal, power, 0})) sum += up->weight * weight;
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

// Lambda of a direction turned to azimuths about the macro normal along with the facet it meets:
//   2 tan^2 (u^2 cos^2 + v^2 sin^2) = tan^2 (u^2 + v^2) + (u^2 - v^2) (tan^2 cos(2 phi)).
struct TurnedLambda {
  double even, cosine, sine;

  TurnedLambda(const Roughness& r, const Vec3& w) {
    const double per = 0.5 / square(w.z), difference = (square(r.u) - square(r.v)) * per;
    even = 1 + (square(r.u) + square(r.v)) * per * (square(w.x) + square(w.y));
    cosine = difference * (square(w.x) - square(w.y));
    sine = -2 * difference * w.x * w.y;
  }
  double at(double cos_twice, double sin_twice) const {
    return (std::sqrt(even + cosine * cos_twice + sine * sin_twice) - 1) / 2;
  }
};

// Over all turns of the facet, D(h) and masking of a direction and its partner. By the definition of the
// model: shadowing none for "straight", Walter's for light that bends, its limit between.
double FilmIntegrals::shadowed(Event event, const std::vector<Turn>& turns, const Vec3& w,
                               const Vec3& partner) const {
  const bool alone = event == Event::passage && material_.transmission == Transmission::straight;
  const TurnedLambda here(material_.roughness, w), there(material_.roughness, partner);
  double sum = 0;
  for (const Turn& turn : turns) {
    const double other = alone ? 0 : there.at(turn.cos_twice, turn.sin_twice);
    sum += turn.density / (1 + here.at(turn.cos_twice, turn.sin_twice) + other);
  }
  return sum;
}

// Facets tilted by `theta`, at all azimuths: D(h) of each.
std::vector<FilmIntegrals::Turn> FilmIntegrals::turns_at(double theta) const {
  std::vector<Turn> turns;
  for (const double azimuth : turns_)
    turns.push_back({std::cos(2 * azimuth), std::sin(2 * azimuth),
                     ggx_.d(spherical_direction(theta, azimuth)) / static_cast<double>(turns_.size())});
  return turns;
}

// Int over the azimuth about a facet tilted by `theta` of a direction at `cosine` with its normal, inside the
// azimuths where the direction and its partner are above the horizon.
template <class F>
void FilmIntegrals::visit_azimuths(Event event, double theta, const std::vector<Turn>& turns, double cosine,
                                   const Rgb& weight, F visit) const {
  const bool mirrored = event == Event::reflection_below;
  const double sin_h = std::sin(theta), cos_h = std::cos(theta), sine = std::sqrt(1 - square(cosine));
  const double partner_sine = mirrored ? -sine : index_ratio_ * sine;
  const double partner_cosine = mirrored ? cosine : std::sqrt(std::max(0.0, 1 - square(partner_sine)));
  const auto direction = [&](double along, double across, double phi) {
    const double forward = across * std::cos(phi);
    return Vec3{along * sin_h - forward * cos_h, across * std::sin(phi), along * cos_h + forward * sin_h};
  };
  // Both z > 0.
  const double height = cosine * cos_h, swing = sine * sin_h;
  const double lowest =
      mirrored ? height / swing : std::min(height / swing, partner_cosine * cos_h / (partner_sine * sin_h));
  const double start = mirrored ? std::acos(std::min(1.0, lowest)) : 0;
  const double end = std::acos(-std::min(1.0, lowest));
  for (int k = 0; k < azimuths_.size(); ++k) {
    const double phi = lerp(azimuths_.node[k], start, end);
    const Vec3 w = direction(cosine, sine, phi), partner = direction(partner_cosine, partner_sine, phi);
    if (w.z <= 0 || partner.z <= 0) continue;
    const double both_sides = 2 * (end - start) * azimuths_.weight[k];
    visit(Meeting{std::min(w.z, 1.0), std::min(partner.z, 1.0),
                  weight * (both_sides * shadowed(event, turns, w, partner))});
  }
}

// Int dh D(h) Int dw (w.h) power(w.h) G(w, partner) visit(w.z, partner.z) over normals h and directions w:
// the substitution of (normal, direction) for the two directions puts the film's power, with its oscillations
// and its kink at total reflection, on one axis. tan(theta_h) = alpha x / (1 - x), alpha between the two.
template <class F>
void FilmIntegrals::visit_facets(Event event, F visit) const {
  const double critical = critical_cosine(film_of(event));
  const double alpha = std::sqrt(material_.roughness.u * material_.roughness.v);
  for (int i = 0; i < normals_.size(); ++i) {
    const double x = normals_.node[i];
    const double theta = std::atan2(alpha * x, 1 - x);
    const double dtheta = alpha / (square(1 - x) + square(alpha * x)) * normals_.weight[i];
    const double normal_weight = 2 * kPi * std::sin(theta) * dtheta;
    const std::vector<Turn> turns = turns_at(theta);
    // Below sin(theta_h) part of the azimuths is under the horizon.
    std::array<double, 7> edges{0, 0.25, 0.5, 0.75, 1, std::sin(theta), critical};
    std::sort(edges.begin(), edges.end());
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
      if (edges[p + 1] - edges[p] < 1e-12) continue;
      if (event == Event::passage && edges[p + 1] <= critical) continue;
      const auto weights = moments(event, edges[p], edges[p + 1]);
      for (int j = 0; j < cosine_panel_.size(); ++j)
        visit_azimuths(event, theta, turns,
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
