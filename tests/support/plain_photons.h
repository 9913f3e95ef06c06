// The plainest account of a layered film over a pigment: photons of one wavelength, one at a time, which are
// reflected, let through or absorbed by chance, and counted where they end. Nothing is weighted or connected.
// Facets are those of PlainHeightfield, single ones too. Slow.
#pragma once

#include <array>
#include <vector>

#include "tests/support/plain_microsurface.h"
#include "tests/support/plain_stack.h"

namespace sunbeam::test {

// Where a photon ends. `first`: mirrored by the first facet and gone; `rest`: gone another way; `facets`:
// lost between single facets; else absorbed.
enum class Fate { first, rest, facets, film, pigment, base };
inline constexpr std::size_t kFates = 6;

struct Photon {
  Vec3 travel;
  bool is_outside;
  int met = 0;  // facets

  double side() const { return is_outside ? 1 : -1; }
  // Where it comes from, in the frame of its side, where z > 0 leads away from the facets.
  Vec3 from() const { return -side() * travel; }
  void go(const Vec3& away) { travel = side() * away; }
};

// Meetings of a photon with the film. They return its fate if it ends there.
class PhotonFilm {
 public:
  PhotonFilm(const Material& material, const Wavelengths& wavelengths, std::size_t k)
      : stack_(material, wavelengths, k),
        surface_(material.roughness),
        inwards_(material.is_opaque() ? 1 : material.exterior_ior / material.base_ior),
        smooth_(material.is_smooth()),
        straight_(material.transmission == Transmission::straight),
        opaque_(material.is_opaque()),
        multiple_(material.has_multiple_facets()) {}

  std::optional<Fate> meet(Photon& photon, Rng& rng) const {
    return multiple_ ? wander(photon, rng) : meet_once(photon, rng);
  }

 private:
  enum class Turn { mirrored, passed, absorbed };

  // One facet, whose normal is on the photon's side.
  Turn take_turn(Photon& photon, const Vec3& normal, Rng& rng) const {
    const Vec3 w = photon.from();
    const double cosine = std::min(dot(w, normal), 1.0), chance = rng.uniform();
    const auto power = stack_.meet(photon.is_outside, cosine, rng);
    ++photon.met;
    if (chance >= power.reflectance + power.transmittance) return Turn::absorbed;
    const double ratio = photon.is_outside ? inwards_ : 1 / inwards_;
    const double far2 = 1 - (straight_ ? 1 : square(ratio)) * (1 - square(cosine));
    if (chance < power.reflectance || far2 <= 0) {
      photon.go(normalize(2 * cosine * normal - w));
      return Turn::mirrored;
    }
    if (!straight_) photon.go(normalize((ratio * cosine - std::sqrt(far2)) * normal - ratio * w));
    photon.is_outside = !photon.is_outside;
    return Turn::passed;
  }

  std::optional<Fate> meet_once(Photon& photon, Rng& rng) const {
    const Vec3 w = photon.from();
    const Turn turn = take_turn(photon, smooth_ ? Vec3{0, 0, 1} : surface_.visible_normal(w, rng), rng);
    if (turn == Turn::absorbed) return Fate::film;
    if (turn == Turn::passed && opaque_) return Fate::base;
    const Vec3 away = photon.side() * photon.travel;
    if (away.z <= 0) return Fate::facets;
    if (smooth_ || (turn == Turn::passed && straight_)) return {};
    const double seen = 1 + surface_.lambda(w);
    if (rng.uniform() >= seen / (seen + surface_.lambda(away))) return Fate::facets;
    return {};
  }

  // From facet to facet until none is in the way. Light that passes straight leaves them all behind.
  std::optional<Fate> wander(Photon& photon, Rng& rng) const {
    const Vec3 arrived = photon.travel;
    double height = photon.side();
    for (;;) {
      const double side = photon.side();  // the inside sees the surface upside down
      const auto next = surface_.next_height(side * photon.travel, side * height, rng);
      if (!next) return {};
      height = side * *next;
      const Turn turn = take_turn(photon, surface_.visible_normal(photon.from(), rng), rng);
      if (turn == Turn::absorbed) return Fate::film;
      if (turn == Turn::mirrored) continue;
      if (opaque_) return Fate::base;
      if (!straight_) continue;
      photon.travel = arrived;
      return {};
    }
  }

  PlainStack stack_;
  PlainHeightfield surface_;
  double inwards_;  // n0 / n2
  bool smooth_, straight_, opaque_, multiple_;
};

class PlainPhotons {
 public:
  PlainPhotons(const Material& material, const Wavelengths& wavelengths, std::size_t k)
      : film_(material, wavelengths, k),
        albedo_(wavelengths.albedo[k]),
        absorption_(material.optical_depth() * wavelengths.absorption[k]),
        scattering_(material.scattering_depth()),
        anisotropy_(material.anisotropy),
        product_(material.absorption_path == AbsorptionPath::product) {}

  struct Outcome {
    Fate fate;
    Vec3 direction;  // of light that is gone
  };

  Outcome walk(const Vec3& wi, Rng& rng) const {
    Photon photon{-wi, true};
    for (bool was_below = false;; was_below = true) {
      if (const auto fate = film_.meet(photon, rng)) return {*fate, {}};
      if (photon.is_outside) return {was_below || photon.met > 1 ? Fate::rest : Fate::first, photon.travel};
      if (const auto fate = return_to_film(photon.travel, rng)) return {*fate, {}};
    }
  }

 private:
  std::optional<Fate> return_to_film(Vec3& travel, Rng& rng) const {
    for (double depth = 0;;) {
      if (!cross_slab(travel, depth, rng)) return Fate::pigment;
      if (travel.z > 0) return {};
      if (rng.uniform() >= albedo_) return Fate::base;
      const double arrived = -travel.z;
      travel = sample_cosine({rng.uniform(), rng.uniform()});
      if (product_ && rng.uniform() >= std::exp(-absorption_ / (arrived * travel.z))) return Fate::pigment;
    }
  }

  // From `depth` (0 at the film, 1 at the base) to the border that the photon comes to; false if absorbed.
  bool cross_slab(Vec3& travel, double& depth, Rng& rng) const {
    for (;;) {
      const double border = travel.z < 0 ? (1 - depth) / -travel.z : depth / travel.z;
      const double free = scattering_ > 0 ? -std::log(1 - rng.uniform()) / scattering_
                                          : std::numeric_limits<double>::infinity();
      const double step = std::min(border, free);
      if (!product_ && rng.uniform() >= std::exp(-absorption_ * step)) return false;
      if (free >= border) {
        depth = travel.z < 0 ? 1 : 0;
        return true;
      }
      depth = std::clamp(depth - step * travel.z, 0.0, 1.0);
      travel = scatter(travel, anisotropy_, rng);
    }
  }

  PhotonFilm film_;
  double albedo_, absorption_, scattering_, anisotropy_;
  bool product_;
};

// The counts of photons at three wavelengths, taken as R, G and B: shares by fate, and where the rest goes.
class PhotonCount {
 public:
  PhotonCount(const Material& material, const Wavelengths& wavelengths, const Vec3& wi, const CellGrid& grid,
              int photons, Rng& rng)
      : photons_(photons), cells_(grid.size()) {
    for (int c = 0; c < 3; ++c) {
      const PlainPhotons walks(material, wavelengths, static_cast<std::size_t>(c));
      std::vector<double> counts(grid.size());
      for (int i = 0; i < photons; ++i) {
        const auto outcome = walks.walk(wi, rng);
        counts_[static_cast<std::size_t>(outcome.fate)][c] += 1;
        if (outcome.fate == Fate::rest) counts[grid.index(outcome.direction)] += 1;
      }
      for (std::size_t i = 0; i < counts.size(); ++i) {
        cells_[i].mean[c] = counts[i] / photons;
        cells_[i].variance[c] = square(error_of(counts[i] / photons));
      }
    }
  }

  // The rest by cell of the grid.
  const std::vector<CellPower>& cells() const { return cells_; }

  Rgb share(std::initializer_list<Fate> fates) const {
    Rgb sum;
    for (const Fate fate : fates) sum += counts_[static_cast<std::size_t>(fate)] / photons_;
    return sum;
  }
  // The standard error of a share.
  double error_of(double share) const { return std::sqrt(share * (1 - share) / photons_); }

 private:
  double photons_;
  std::array<Rgb, kFates> counts_{};
  std::vector<CellPower> cells_;
};

}  // namespace sunbeam::test
