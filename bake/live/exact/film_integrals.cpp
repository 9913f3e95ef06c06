#include "bake/live/exact/film_integrals.h"

#include <span>

#include "bake/live/exact/smooth_step.h"
#include "bake/live/film/visible_normals.h"

namespace sunbeam {
namespace {

// Nodes for a film power on a panel that its phase crosses by at most kPhaseStep radians: the third harmonic
// still has more than two nodes a period.
constexpr int kFineNodes = 20;
constexpr double kPhaseStep = 5;
// The same between two edges of a layered film.
constexpr int kFilmPanelNodes = 16;
// Extra nodes a radian of phase for normals visible from one direction, and where they end (time, not error).
constexpr double kVisibleNodesPerRadian = 0.3;
constexpr int kMaxVisibleNodes = 400;

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

double min_component(const Rgb& a) { return std::min({a.r, a.g, a.b}); }

}  // namespace

FilmIntegrals::FilmIntegrals(const Material& material, const Wavelengths& three,
                             const ExactResolution& resolution)
    : material_(material),
      resolution_(resolution),
      geometry_(material),
      film_(material, three),
      index_ratio_(geometry_.has_glossy_crossing() ? material.exterior_ior / material.base_ior : 1),
      basis_(resolution.per_panel),
      cosine_panel_(resolution.cosines),
      fine_(gauss_legendre(kFineNodes)),
      film_panel_(gauss_legendre(kFilmPanelNodes)),
      normals_(gauss_legendre(resolution.normals)),
      azimuths_(gauss_legendre(resolution.azimuths)),
      visible_(gauss_legendre(visible_nodes())),
      visible_azimuths_(gauss_legendre(visible_.size() * 3 / 4)),
      rings_(resolution.visible),
      turns_(material.roughness) {}

// Phase difference of neighbouring reflections, radians, at the shortest wavelength.
double FilmIntegrals::phase(sunbeam::Side side, double cosine) const {
  const ThinFilm& film = film_.outline_from(side);
  const double cos1_squared = refracted_cosine_squared(film.exterior_ior, film.film_ior, cosine);
  return 4 * kPi * film.film_ior * film.thickness_nm / min_component(film_.wavelengths_nm()) *
         std::sqrt(std::max(0.0, cos1_squared));
}

int FilmIntegrals::oscillation_panels(sunbeam::Side side, double low, double high) const {
  return 1 + static_cast<int>((phase(side, high) - phase(side, low)) / kPhaseStep);
}

// Calls visit(t, weight, parts) for nodes t, of weight / parts, of low + (high - low) smooth_step(t) that
// resolve the film's powers.
template <class F>
void FilmIntegrals::visit_oscillations(sunbeam::Side side, double low, double high, F visit) const {
  if (!film_.is_layered()) {
    const int parts = oscillation_panels(side, low, high);
    for (int part = 0; part < parts; ++part)
      for (int i = 0; i < fine_.size(); ++i) visit((part + fine_.node[i]) / parts, fine_.weight[i], parts);
    return;
  }
  double from = 0;
  for (const double edge : film_.edges(side)) {
    if (edge <= low) continue;
    const double to = edge < high ? inverse_smooth_step((edge - low) / (high - low)) : 1;
    for (int i = 0; i < film_panel_.size(); ++i)
      visit(lerp(film_panel_.node[i], from, to), film_panel_.weight[i] * (to - from), 1);
    if (edge >= high) return;
    from = to;
  }
}

// More where a wide lobe sees a thick film oscillate.
int FilmIntegrals::visible_nodes() const {
  if (film_.is_layered()) return resolution_.visible;
  const sunbeam::Side outside = sunbeam::Side::outside;
  const double waves = (phase(outside, 1) - phase(outside, 0)) * std::min(1.0, 4 * wider());
  const int wanted = resolution_.visible + static_cast<int>(kVisibleNodesPerRadian * waves);
  return std::min(wanted, std::max(kMaxVisibleNodes, resolution_.visible));
}

Vec3 FilmIntegrals::turned(const Vec3& w) const {
  return material_.roughness.is_isotropic() ? direction_from_cosine(w.z, 0) : w;
}

// Calls visit(w, normal, weight) for normals visible from w, turned to azimuth 0 if the film is isotropic;
// the weights of all normals sum to 1. What mirrors w under the horizon is left out if only_mirrored, without
// a kink for the quadrature.
template <class F>
void FilmIntegrals::visit_visible(const Vec3& w, bool only_mirrored, F visit) const {
  const Vec3 from = turned(w);
  const VisibleNormals visible(from, material_.roughness, film_.outline_from(sunbeam::Side::outside),
                               index_ratio_);
  for_each_node(visible.azimuth_edges(), visible_azimuths_, [&](double azimuth, double dazimuth) {
    auto edges = visible.polar_edges(azimuth);
    const double end = only_mirrored ? visible.mirrored_end(azimuth, edges.back()) : edges.back();
    for (double& edge : edges) edge = std::min(edge, end);
    for_each_node(edges, visible_, [&](double polar, double dpolar) {
      visit(from, visible.normal(polar, azimuth), visible.density(polar) * dpolar * dazimuth);
    });
  });
}

// Those of a layered film, for light along w; w is at azimuth 0 if the film is isotropic.
FacetRings FilmIntegrals::rings(const Vec3& w) const {
  const sunbeam::Side outside = sunbeam::Side::outside;
  const double critical = critical_cosine(film_.outline_from(outside));
  return {w, {material_.roughness, index_ratio_, critical}, film_.edges(outside), rings_};
}

std::vector<CrossingNode> FilmIntegrals::crossings(const Vec3& w) const {
  std::vector<CrossingNode> result;
  const auto add = [&](const Vec3& from, const Vec3& normal, double weight, const Rgb& passing = {}) {
    const double cosine = std::clamp(dot(from, normal), 0.0, 1.0);
    if (const auto inside = geometry_.cross(from, normal))
      result.push_back({cosine, inside->direction.z, weight * inside->share, passing});
  };
  if (w.z <= 0 || material_.is_opaque()) return result;
  const auto transmittance = [&](double cosine) { return power(cosine).transmittance; };
  if (geometry_.is_smooth()) {
    add(w, {0, 0, 1}, 1, film_.is_layered() ? transmittance(w.z) : Rgb());
  } else if (film_.is_layered()) {
    const Vec3 from = turned(w);
    for (const FacetRings::Node& node : rings(from).crossing(transmittance))
      add(from, node.normal, node.weight, node.power);
  } else {
    visit_visible(w, false, add);
  }
  return result;
}

Rgb FilmIntegrals::first_albedo(const Vec3& w) const {
  if (w.z <= 0) return {};
  const auto reflectance = [&](double cosine) { return power(cosine).reflectance; };
  if (geometry_.is_smooth()) return reflectance(w.z);
  Rgb sum;
  const auto add = [&](const Vec3& from, const Vec3& normal, double weight, const Rgb& mirrored) {
    if (const auto up = geometry_.mirror(from, normal)) sum += mirrored * up->share * weight;
  };
  if (film_.is_layered()) {
    const Vec3 from = turned(w);
    for (const FacetRings::Node& node : rings(from).mirroring(reflectance))
      add(from, node.normal, node.weight, node.power);
    return sum;
  }
  visit_visible(w, true, [&](const Vec3& from, const Vec3& normal, double weight) {
    add(from, normal, weight, reflectance(std::clamp(dot(from, normal), 0.0, 1.0)));
  });
  return sum;
}

// Weights W_j = Int_low^high power(c) c L_j(c) dc of a panel's nodes c_j = low + (high - low)
// smooth_step(t_j): the film's oscillations are integrated here, and what multiplies them only has to be
// smooth.
std::vector<Rgb> FilmIntegrals::moments(Event event, double low, double high) const {
  std::vector<Rgb> result(cosine_panel_.size());
  visit_oscillations(side_of(event), low, high, [&](double t, double weight, int parts) {
    const double cosine = lerp(smooth_step(t), low, high);
    const FilmPower power = film_.at(side_of(event), cosine);
    const Rgb value = (event == Event::crossing ? power.transmittance : power.reflectance) *
                      (cosine * (high - low) * smooth_step_slope(t) * weight / parts);
    const auto weights = cosine_panel_.at(t);
    for (int j = 0; j < cosine_panel_.size(); ++j) result[j] += value * weights[j];
  });
  return result;
}

// By the definition of the model: shadowing none for "straight", Walter's for light that bends, its limit
// between.
double FilmIntegrals::shadowed(Event event, const std::vector<FacetTurns::Turn>& turns, const Vec3& w,
                               const Vec3& partner) const {
  const bool alone = event == Event::crossing && material_.transmission == Transmission::straight;
  return turns_.masked(turns, w, alone ? nullptr : &partner);
}

// Int over the azimuth about a facet tilted by `theta` of a direction at `cosine` with its normal, inside the
// azimuths where the direction and its partner are above the horizon.
template <class F>
void FilmIntegrals::visit_azimuths(Event event, double theta, const std::vector<FacetTurns::Turn>& turns,
                                   double cosine, const Rgb& weight, F visit) const {
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
  const double critical = critical_cosine(film_.outline_from(side_of(event)));
  const double alpha = std::sqrt(material_.roughness.u * material_.roughness.v);
  for (int i = 0; i < normals_.size(); ++i) {
    const double x = normals_.node[i];
    const double theta = std::atan2(alpha * x, 1 - x);
    const double dtheta = alpha / (square(1 - x) + square(alpha * x)) * normals_.weight[i];
    const double normal_weight = 2 * kPi * std::sin(theta) * dtheta;
    const auto turns = turns_.at(theta);
    // Below sin(theta_h) part of the azimuths is under the horizon.
    std::array<double, 7> edges{0, 0.25, 0.5, 0.75, 1, std::sin(theta), critical};
    std::sort(edges.begin(), edges.end());
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
      if (edges[p + 1] - edges[p] < 1e-12) continue;
      if (event == Event::crossing && edges[p + 1] <= critical) continue;
      const auto weights = moments(event, edges[p], edges[p + 1]);
      for (int j = 0; j < cosine_panel_.size(); ++j)
        visit_azimuths(event, theta, turns,
                       lerp(smooth_step(cosine_panel_.rule().node[j]), edges[p], edges[p + 1]),
                       weights[j] * normal_weight, visit);
    }
  }
}

// Int ... 2 pi mu dmu over the cosines below a smooth film: calls visit(mu, powers, 2 pi mu dmu).
template <class F>
void FilmIntegrals::visit_smooth_film(F visit) const {
  const sunbeam::Side inside = sunbeam::Side::inside;
  const double critical = critical_cosine(film_.outline_from(inside));
  const auto visit_between = [&](double low, double high) {
    if (high <= low) return;
    visit_oscillations(inside, low, high, [&](double t, double weight, int parts) {
      const double mu = lerp(smooth_step(t), low, high);
      const double dmu = (high - low) * smooth_step_slope(t) * weight / parts;
      visit(mu, film_.at(inside, mu), 2 * kPi * mu * dmu);
    });
  };
  for (int p = 0; p < CosineBasis::kPanels; ++p) {
    const double low = CosineBasis::kEdges[p], high = CosineBasis::kEdges[p + 1];
    const double split = std::clamp(critical, low, high);
    visit_between(low, split);
    visit_between(split, high);
  }
}

std::array<Matrix, 3> FilmIntegrals::reflection() const {
  std::array<Matrix, 3> sum{Matrix(basis_.size()), Matrix(basis_.size()), Matrix(basis_.size())};
  if (material_.is_opaque()) return sum;
  if (geometry_.is_smooth()) {
    const int count = basis_.per_panel();
    visit_smooth_film([&](double mu, const FilmPower& power, double share) {
      const Rgb weight = power.reflectance * share;
      const auto s = basis_.at(mu);
      for (int channel = 0; channel < 3; ++channel)
        for (int k = 0; k < count; ++k)
          add_scaled(weight[channel] * s.weight[k], s.weight.data(), count,
                     sum[channel].row(s.first + k) + s.first);
    });
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
  if (geometry_.is_smooth() && !film_.is_layered()) {  // what is not reflected leaves
    for (int channel = 0; channel < 3; ++channel) {
      sum[channel] = multiply(Vector(basis_.size(), -1.0), reflection[channel]);
      add_scaled(1, basis_.cosine_weights().data(), basis_.size(), sum[channel].data());
    }
    return sum;
  }
  sum.fill(Vector(basis_.size()));
  if (material_.is_opaque()) return sum;
  if (geometry_.is_smooth()) {
    visit_smooth_film([&](double mu, const FilmPower& power, double share) {
      const auto s = basis_.at(mu);
      for (int channel = 0; channel < 3; ++channel)
        add_scaled(power.transmittance[channel] * share, s.weight.data(), basis_.per_panel(),
                   sum[channel].data() + s.first);
    });
    return sum;
  }
  visit_facets(Event::crossing, [&](const Meeting& m) {
    const auto inside = basis_.at(m.partner);
    for (int channel = 0; channel < 3; ++channel)
      add_scaled(m.weight[channel] * material_.radiance_scale(), inside.weight.data(), basis_.per_panel(),
                 sum[channel].data() + inside.first);
  });
  return sum;
}

}  // namespace sunbeam
