// The plainest walk through film, scattering slab and Lambertian base: analog, one path, three wavelengths,
// no connections. What leaves is counted by its direction. A second code path for the tests; slow.
//
// Directions `w` point away from the surface; a ray's `travel` is where it goes. Weights transport power, so
// the mean power in a cell of outgoing directions, over its Int cos, is the mean of the BSDF.
#pragma once

#include <limits>
#include <optional>

#include "sunbeam/core/rng.h"
#include "sunbeam/detail/warp.h"
#include "tests/support/direction_cells.h"
#include "tests/support/plain_film.h"

namespace sunbeam::test {

// Exact draw from Henyey and Greenstein's phase function, density (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^1.5).
inline Vec3 scatter(const Vec3& travel, double g, Rng& rng) {
  const double u = rng.uniform();
  const double cosine =
      g == 0 ? 1 - 2 * u : (1 + g * g - square((1 - g * g) / (1 - g + 2 * g * u))) / (2 * g);
  const Vec3 local = direction_from_cosine(std::clamp(cosine, -1.0, 1.0), 2 * kPi * rng.uniform());
  const Vec3 other = std::abs(travel.z) < 0.7 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 x = normalize(cross(other, travel)), y = cross(travel, x);
  return normalize(local.x * x + local.y * y + local.z * travel);
}

// Where the film sends a ray.
struct FilmEvent {
  Vec3 travel;
  Rgb weight;
  bool is_outside;
};

// The single-scattering film. Light from outside always enters: the first surface is not part of the rest.
class PlainFilm {
 public:
  PlainFilm(const Material& material, const Rgb& wavelengths_nm) : film_(material, wavelengths_nm) {}

  std::optional<FilmEvent> enter(const Vec3& wi, Rng& rng) const {
    const auto crossing = film_.cross(wi, film_.meet_from_outside(wi, rng));
    if (!crossing) return {};
    return FilmEvent{-crossing->inside, crossing->weight, false};
  }

  std::optional<FilmEvent> meet_from_below(const Vec3& travel, Rng& rng) const {
    const Facet facet = film_.meet_from_below(travel, rng);
    if (rng.uniform() < facet.reflect_chance) {
      const auto down = film_.reflect_down(travel, facet);
      if (!down) return {};
      return FilmEvent{-down->direction, down->weight / facet.reflect_chance, false};
    }
    const auto out = film_.leave(travel, facet);
    if (!out) return {};
    return FilmEvent{out->direction, out->weight / (1 - facet.reflect_chance), true};
  }

  // One estimate of what the first surface reflects of light from wi.
  Rgb reflected(const Vec3& wi, Rng& rng) const {
    const auto up = film_.reflect_up(wi, film_.meet_from_outside(wi, rng));
    return up ? up->weight : Rgb();
  }

 private:
  FacetedFilm film_;
};

template <class Film>
class PlainLayers {
 public:
  PlainLayers(const Material& material, const Rgb& wavelengths_nm)
      : film_(material, wavelengths_nm),
        albedo_(material.albedo),
        scattering_(material.scattering_depth()),
        absorption_(material.optical_depth()),
        anisotropy_(material.anisotropy) {}

  const Film& film() const { return film_; }

  struct Outcome {
    Vec3 direction;
    Rgb power;
  };

  // Light of power 1 from wi; empty if it is lost in the facets or absorbed.
  std::optional<Outcome> walk(const Vec3& wi, Rng& rng) const {
    auto event = film_.enter(wi, rng);
    if (!event) return {};
    Rgb power = event->weight;
    while (!event->is_outside) {
      Vec3 travel = event->travel;
      double depth = 0;
      for (;;) {
        cross_slab(travel, depth, power, rng);
        if (is_black(power)) return {};
        if (travel.z > 0) break;
        power *= albedo_;
        travel = sample_cosine({rng.uniform(), rng.uniform()});
      }
      event = film_.meet_from_below(travel, rng);
      if (!event) return {};
      power *= event->weight;
    }
    return Outcome{event->travel, power};
  }

  PowerHistogram histogram(const Vec3& wi, const CellGrid& grid, int walks, Rng& rng) const {
    PowerHistogram result(grid);
    for (int i = 0; i < walks; ++i) {
      const auto outcome = walk(wi, rng);
      if (outcome)
        result.add_walk(outcome->direction, outcome->power);
      else
        result.add_walk();
    }
    return result;
  }

  // Of the rest.
  RgbMean albedo(const Vec3& wi, int walks, Rng& rng) const {
    RgbMean mean;
    for (int i = 0; i < walks; ++i) {
      const auto outcome = walk(wi, rng);
      mean.add(outcome ? outcome->power : Rgb());
    }
    return mean;
  }

 private:
  // From `depth` (0 at the film, 1 at the base) to the border that the ray comes to.
  void cross_slab(Vec3& travel, double& depth, Rgb& power, Rng& rng) const {
    for (;;) {
      const double border = travel.z < 0 ? (1 - depth) / -travel.z : depth / travel.z;
      const double free = scattering_ > 0 ? -std::log(1 - rng.uniform()) / scattering_
                                          : std::numeric_limits<double>::infinity();
      const double step = std::min(border, free);
      power *= std::exp(-absorption_ * step);
      if (free >= border) {
        depth = travel.z < 0 ? 1 : 0;
        return;
      }
      depth = std::clamp(depth - step * travel.z, 0.0, 1.0);
      travel = scatter(travel, anisotropy_, rng);
    }
  }

  Film film_;
  Rgb albedo_;
  double scattering_, absorption_, anisotropy_;
};

using PlainSlab = PlainLayers<PlainFilm>;

}  // namespace sunbeam::test
