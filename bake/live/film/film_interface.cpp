#include "bake/live/film/film_interface.h"

#include "bake/live/film/microsurface.h"

namespace sunbeam {
namespace {

// The far-side counterpart of `w` if it leads away from the macro surface.
std::optional<Vec3> refract(const Vec3& w, const Vec3& h, double index_ratio) {
  Vec3 far_side;
  if (!walk::refract(w, h, index_ratio, far_side) || far_side.z <= 0) return {};
  return far_side;
}

}  // namespace

FilmInterface::FilmInterface(const Material& material, const Rgb& wavelengths_nm)
    : film_(ThinFilm::of(material)),
      film_below_(ThinFilm::below(material)),
      wavelengths_nm_(wavelengths_nm),
      index_ratio_(bending_index_ratio(material)),
      rough_(!material.is_smooth()),
      bends_(index_ratio_ != 1),
      straight_(material.transmission == Transmission::straight),
      ggx_(material.roughness) {}

Rgb FilmInterface::first_surface(const Vec3& wo, const Vec3& wi) const {
  if (!rough_ || wo.z <= 0 || wi.z <= 0) return {};
  const Vec3 h = normalize(wo + wi);
  return ggx_.reflection(wo, wi, h) * power(dot(wo, h)).reflectance;
}

double FilmInterface::first_surface_pdf(const Vec3& wo, const Vec3& wi) const {
  if (!rough_ || wo.z <= 0 || wi.z <= 0) return 0;
  const Vec3 h = normalize(wo + wi);
  return ggx_.reflection_pdf(wo, h) * mean(power(dot(wo, h)).reflectance);
}

Vec3 FilmInterface::sample_normal(const Vec3& w, Rng& rng) const {
  if (!rough_) return {0, 0, 1};
  return ggx_.sample_visible(w, {rng.uniform(), rng.uniform()});
}

Facet FilmInterface::meet_from_outside(const Vec3& w, Rng& rng) const {
  const Vec3 h = sample_normal(w, rng);
  const FilmPower power = airy(film_, std::clamp(dot(w, h), 0.0, 1.0), wavelengths_nm_);
  return {h, power, mean(power.reflectance)};
}

Facet FilmInterface::meet_from_below(const Vec3& m, Rng& rng) const {
  const Vec3 h = sample_normal(m, rng);
  const FilmPower power = airy(film_below_, std::clamp(dot(m, h), 0.0, 1.0), wavelengths_nm_);
  return {h, power, mean(power.reflectance)};
}

double FilmInterface::shadowing(const Vec3& from, const Vec3& to) const {
  return rough_ ? ggx_.g2_over_g1(from, to) : 1;
}

std::optional<Scatter> FilmInterface::mirror(const Vec3& w, const Facet& facet) const {
  const Vec3 mirrored = reflect(w, facet.normal);
  if (mirrored.z <= 0) return {};
  return Scatter{mirrored, facet.power.reflectance * shadowing(w, mirrored)};
}

std::optional<Scatter> FilmInterface::reflect_up(const Vec3& w, const Facet& facet) const {
  return mirror(w, facet);
}

// Travel along m, thrown down, arrives from m mirrored at the facet turned half round; the turn leaves an
// isotropic distribution of normals as it is.
std::optional<Scatter> FilmInterface::reflect_down(const Vec3& m, const Facet& facet) const {
  return mirror(m, facet);
}

std::optional<Crossing> FilmInterface::cross(const Vec3& w, const Facet& facet) const {
  // "straight": the paper's Tbar has no shadowing; index-matched "refract": the limit of Walter's function
  // has.
  if (!bends_) return Crossing{w, facet.power.transmittance * (straight_ ? 1 : shadowing(w, w)), 0, 1};
  const Vec3& h = facet.normal;
  const auto m = refract(w, h, index_ratio_);
  if (!m) return {};
  const double solid_angle_ratio = square(index_ratio_) * w.z / m->z;
  if (!rough_) return Crossing{*m, facet.power.transmittance, 0, solid_angle_ratio};
  const double jacobian = dot(*m, h) / square(index_ratio_ * dot(w, h) - dot(*m, h));
  return Crossing{*m, facet.power.transmittance * shadowing(w, *m), ggx_.visible_pdf(w, h) * jacobian,
                  solid_angle_ratio * ggx_.g1(*m) / ggx_.g1(w)};
}

std::optional<Scatter> FilmInterface::leave(const Vec3& m, const Facet& facet) const {
  if (!bends_) return Scatter{m, facet.power.transmittance * (straight_ ? 1 : shadowing(m, m))};
  const auto w = refract(m, facet.normal, 1 / index_ratio_);
  if (!w) return {};
  return Scatter{*w, facet.power.transmittance * shadowing(m, *w)};
}

Exit FilmInterface::exit(const Vec3& m, const Vec3& w) const {
  // Half vector of the passage, turned to the outside; both directions must see the facet from its sides.
  Vec3 h = index_ratio_ * w - m;
  if (h.z < 0) h = -h;
  h = normalize(h);
  const double wh = dot(w, h), mh = dot(m, h);
  if (wh <= 0 || mh <= 0 || h.z <= 0) return {};
  const double dh_dm = mh / square(index_ratio_ * wh - mh);  // n2^2 mh / (n0 wh - n2 mh)^2
  const double lobe = dh_dm * wh * square(index_ratio_) * ggx_.g2(w, m) * ggx_.d(h) / (w.z * m.z);
  return {power(std::min(wh, 1.0)).transmittance * lobe, ggx_.visible_pdf(w, h) * dh_dm};
}

}  // namespace sunbeam
