// This file chooses which of the sources of light a sample is spent on. The chances depend on the receiver,
// so that neither a bright light far away nor a dim one near by is drawn more often than it matters.
//
// At x a source has the weight
//   L A / (d^2 + A / pi)   seen at distance d: the irradiance by a disc of its area A and radiance L (a
//                          sphere: pi r^2), face to face with the receiver; a point (A = 0): I / d^2
//   0                      a quad seen from behind
//   E                      a directional light: its irradiance at normal incidence
//   pi L                   an environment map of mean radiance L: the irradiance by an even one
// with channels averaged, and nothing occluded. Nine tenths of the samples follow the weights, as in the
// light sampling of Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 12.6, but without
// a tree: every choice looks at all sources, which suits some dozens. The other tenth is shared evenly, so a
// source that shines where all the heavier ones are hidden is found, too. Neither the cosine at a quad nor
// that at the receiver is in the weights: neither gained in variance times time beyond its noise.
#pragma once

#include <vector>

#include "runtime/tracer/environment.h"
#include "runtime/tracer/scene.h"

namespace sunbeam {

class LightChoice {
 public:
  // Sources count on through the scene's quad, sphere, point and directional lights, then the environment if
  // it can be sampled.
  LightChoice(const Scene& scene, const Environment& environment);

  std::size_t size() const { return size_; }

  struct Choice {
    std::size_t source;
    double chance;  // > 0
  };
  // Chooses a source for `u` uniform in [0, 1); size() >= 1. A single source costs nothing.
  Choice choose(const Vec3& from, double u) const {
    return size_ == 1 ? Choice{0, 1} : choose_among_several(from, u);
  }

  // Returns the chance with which choose() returns `source`.
  double chance(std::size_t source, const Vec3& from) const {
    return size_ == 1 ? 1 : chance_among_several(source, from);
  }

 private:
  struct Near {
    Vec3 position, normal;  // of any length; 0 if it shines to all sides
    double power;           // L A or I
    double softening;       // A / pi
  };
  // Turns weights into chances, at one receiver.
  struct Shares {
    double even, of_weight;
    double of(double weight) const { return even + of_weight * weight; }
  };

  static double near_weight(const Near& source, const Vec3& from);
  double weight(std::size_t source, const Vec3& from) const;
  Shares shares(const Vec3& from) const;
  Choice choose_among_several(const Vec3& from, double u) const;
  double chance_among_several(std::size_t source, const Vec3& from) const;

  std::vector<Near> near_;
  std::vector<double> far_off_;  // weights
  double far_off_weight_;        // of all of them
  std::size_t size_;
};

}  // namespace sunbeam
