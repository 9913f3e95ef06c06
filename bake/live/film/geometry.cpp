#include "bake/live/film/geometry.h"

#include "bake/live/film/microsurface.h"
#include "bake/optics/thin_film.h"

namespace sunbeam {

FilmGeometry::FilmGeometry(const Material& material)
    : index_ratio_(bending_index_ratio(material)),
      rough_(!material.is_smooth()),
      bends_(index_ratio_ != 1),
      straight_(material.transmission == Transmission::straight),
      ggx_(material.roughness) {}

std::optional<Onward> FilmGeometry::mirror(const Vec3& w, const Vec3& h) const {
  const Vec3 mirrored = reflect(w, h);
  if (mirrored.z <= 0) return {};
  return Onward{mirrored, shadowing(w, mirrored)};
}

// The paper's Tbar of "straight" has no shadowing; index-matched "refract", the limit of Walter's function,
// has.
std::optional<Onward> FilmGeometry::cross(const Vec3& from, const Vec3& h, double index_ratio) const {
  if (!bends_) return Onward{from, straight_ ? 1 : shadowing(from, from)};
  Vec3 beyond;
  if (!walk::refract(from, h, index_ratio, beyond) || beyond.z <= 0) return {};
  return Onward{beyond, shadowing(from, beyond)};
}

}  // namespace sunbeam
