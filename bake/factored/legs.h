// This file walks the legs between a film and its base: from outside through the film to the base, or from
// the base to the film and back.
//
// A leg chooses its direction by facets alone, which know neither thickness nor wavelength, pigment nor
// albedo. So the same legs serve every fringe order, optical depth and albedo, and what the film lets through
// or reflects at all orders is weighted in afterwards (FringePowers). Legs are stratified in the square of
// visible normals.
#pragma once

#include <optional>

#include "bake/factored/orders/stack_powers.h"
#include "bake/live/film/geometry.h"
#include "bake/optics/fringes.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/axis.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {

// Says where light is and how much of it there is, film and pigment aside.
struct Leg {
  double facet_cosine;  // with the film's facet, on the side it is met from
  double from, to;      // cosines: base side; `from` only of a return
  double weight;
};

// Draws the legs of a film. `material` must outlive it.
class FilmLegs {
 public:
  explicit FilmLegs(const Material& material) : material_(material), film_(material) {}

  // Visits legs from outside along w to the base: strata^2 of them, or one if the film is smooth. Their
  // weights add up to the share of w that facets let by.
  template <class Visit>
  void visit_arrivals(const Vec3& w, std::size_t strata, Rng rng, Visit visit) const {
    if (material_.is_smooth()) strata = 1;
    const double share = 1 / static_cast<double>(strata * strata);
    for (std::size_t k = 0; k < strata * strata; ++k) {
      const Vec3 h = film_.visible_normal(w, stratum(k, strata, rng));
      const auto inside = film_.cross(w, h);
      if (inside) visit(Leg{std::min(dot(w, h), 1.0), 0, inside->direction.z, share * inside->share});
    }
  }

  // Visits legs from the base, along its cosine law, to the film and back. There are `up` strata over the
  // base's cosine^2, and a quarter of that number over facets each way.
  template <class Visit>
  void visit_returns(std::size_t up, Rng rng, Visit visit) const {
    constexpr std::size_t kFacetsOfUp = 4;
    const std::size_t strata = material_.is_smooth() ? 1 : up / kFacetsOfUp;
    const double share = 1 / static_cast<double>(up * strata * strata);
    for (std::size_t i = 0; i < up; ++i)
      for (std::size_t k = 0; k < strata * strata; ++k) {
        const double cosine =
            std::sqrt((static_cast<double>(i) + 1 - rng.uniform()) / static_cast<double>(up));
        const Vec3 m = direction_from_cosine(cosine, 2 * kPi * rng.uniform());
        const Vec3 h = film_.visible_normal(m, stratum(k, strata, rng));
        const auto down = film_.mirror(m, h);
        if (down) visit(Leg{std::min(dot(m, h), 1.0), m.z, down->direction.z, share * down->share});
      }
  }

 private:
  static Point2 stratum(std::size_t k, std::size_t strata, Rng& rng) {
    const auto n = static_cast<double>(strata);
    const double u = rng.uniform(), v = rng.uniform();
    return {(static_cast<double>(k % strata) + u) / n, (static_cast<double>(k / strata) + v) / n};
  }

  const Material& material_;
  FilmGeometry film_;
};

// Computes the powers of one film at all nodes of a fringe axis, for one facet cosine after the other.
class FringePowers {
 public:
  // `order` is the fringe order of a film of one wavelength's thickness.
  FringePowers(const ThinFilm& film, const Axis& orders, double order)
      : reflectance(orders.size()),
        transmittance(orders.size()),
        film_(film),
        first_(orders.low() / order),
        step_(orders.size() > 1 ? (orders.nodes[1] - orders.nodes[0]) / order : 0) {}
  FringePowers(StackPowers stack, const Axis& orders)
      : reflectance(orders.size()), transmittance(orders.size()), stack_(std::move(stack)) {}

  void at(double cosine) {
    if (stack_)
      stack_->at(cosine, reflectance, transmittance);
    else
      film_fringes(film_, cosine, first_, step_, reflectance, transmittance);
  }

  std::vector<double> reflectance, transmittance;

 private:
  std::optional<StackPowers> stack_;  // of a layered film
  ThinFilm film_{};
  double first_ = 0, step_ = 0;
};

// The film that legs meet: one clear layer, or a layered film at one wavelength.
struct LegFilm {
  Material material;
  std::optional<Wavelengths> layered{};

  FringePowers powers(Side side, const Axis& orders) const {
    if (layered) return {StackPowers(material, *layered, side, orders.nodes), orders};
    const ThinFilm film = side == Side::outside ? ThinFilm::of(material) : ThinFilm::below(material);
    return {film, orders, fringe_order(material, 1)};
  }
};

}  // namespace sunbeam
