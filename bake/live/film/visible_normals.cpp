#include "bake/live/film/visible_normals.h"

namespace sunbeam {

VisibleNormals::VisibleNormals(const Vec3& w, const Roughness& roughness, const ThinFilm& film, double ratio)
    : w_(w), roughness_(roughness), ratio_(ratio), axis_(normalize(stretched(w))) {
  const double sine = std::hypot(axis_.x, axis_.y);
  const double x = sine > 0 ? axis_.x / sine : 1, y = sine > 0 ? axis_.y / sine : 0;
  forward_ = {axis_.z * x, axis_.z * y, -sine};
  sideways_ = {-y, x, 0};
  const double base = critical_cosine(film);
  const double inside = critical_cosine(film.exterior_ior, film.film_ior);
  if (base > 0) conics_.push_back({w, base, 0});
  if (inside > base) conics_.push_back({w, inside, 0});  // else the base reflects all there
  if (ratio * sine_of_w() > 1) conics_.push_back({w, 0, ratio});
}

std::vector<double> VisibleNormals::azimuth_edges() const {
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

std::array<double, 8> VisibleNormals::polar_edges(double azimuth) const {
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

double VisibleNormals::mirrored_end(double azimuth, double end) const {
  double low = 0, high = end;
  for (int step = 0; step < 40; ++step) {
    const double middle = (low + high) / 2;
    (reflect(w_, normal(middle, azimuth)).z > 0 ? low : high) = middle;
  }
  return low;
}

double VisibleNormals::azimuth_of(const Vec3& k) const {
  const Vec3 a{k.x / roughness_.u, k.y / roughness_.v, k.z};
  return std::atan2(dot(a, sideways_), dot(a, forward_));
}

// The two roots as polar angles inside [0, end]; twice the nearest to one if there is none.
void VisibleNormals::cut(const Quadratic& q, double end, double* edges) {
  const auto polar = [&](double tangent) { return tangent > 0 ? std::min(std::atan(tangent), end) : 0; };
  const double root = std::sqrt(std::max(0.0, square(q.b) - q.a * q.c));
  const double larger = -(q.b + std::copysign(root, q.b));
  edges[0] = polar(larger / q.a);
  edges[1] = root > 0 ? polar(q.c / larger) : edges[0];
}

// Where the discriminant of the quadratic, itself a quadratic form of (cos, sin) of the azimuth, vanishes
// and the double root is ahead.
std::vector<double> VisibleNormals::tangents(const Conic& conic) const {
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
std::vector<double> VisibleNormals::ends(const Conic& conic) const {
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

}  // namespace sunbeam
