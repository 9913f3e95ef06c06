#include "runtime/src/lookup/bound_rest.h"

namespace sunbeam::inline v1 {
namespace {

constexpr float kLeastCosine = 1e-4f;
constexpr double kLeastShare = 0.3;    // of the channels' mean: a folded colour may pass through 0
constexpr double kLeastScale = 1e-18;  // and a pigment let nothing through; its square is a float yet

Rgb scale_of(const WaveField& rest, const WaveField::End& end) {
  const Rgb arriving = rest.arriving(end);
  const double least = std::max(kLeastShare * mean(arriving), kLeastScale);
  return transform(arriving, [least](double a) { return std::max(a, least); });
}

}  // namespace

BoundRest::BoundRest(const WaveField& rest, Symmetry symmetry) {
  const bool isotropic = symmetry == Symmetry::isotropic;
  fine_ = isotropic ? Grid{kScaleCosines, 1, false} : Grid{129, 17, false};
  coarse_ = isotropic ? Grid{kRatioCosines, 1, true} : Grid{25, 7, true};
  for (const auto& end : ends(rest, fine_)) scale_.push_back(to_color4(scale_of(rest, end)));
  scale_.push_back(Color4{});

  const auto nodes = ends(rest, coarse_);
  std::vector<Rgb> scales;
  for (const auto& end : nodes) scales.push_back(scale_of(rest, end));
  ratio_.resize(nodes.size() * nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto row = rest.row(nodes[i]);
    for (std::size_t o = 0; o <= i; ++o) {
      const Rgb ratio = rest.rest(row, nodes[o]) / (scales[i] * scales[o]);
      ratio_[i * nodes.size() + o] = ratio_[o * nodes.size() + i] = to_color4(ratio);
    }
  }
}

std::vector<WaveField::End> BoundRest::ends(const WaveField& rest, const Grid& grid) {
  std::vector<WaveField::End> result;
  for (int c = 0; c < grid.cosines; ++c)
    for (int p = 0; p < grid.phis; ++p) {
      const double x = static_cast<double>(c) / (grid.cosines - 1);
      const double cosine = std::max<double>(grid.by_root ? x * x : x, kLeastCosine);
      result.push_back(rest.end(cosine, grid.phis == 1 ? 0 : kPi / 2 * p / (grid.phis - 1)));
    }
  return result;
}

// The azimuth folded into [0, pi/2], over pi/2.
float BoundRest::quadrant(const Vec3& w) {
  return static_cast<float>(std::atan2(std::abs(w.y), std::abs(w.x)) * (2 / kPi));
}

Color4 BoundRest::scale_at(const Cosine& cosine, float phi) const {
  const Place at = fine_.place(cosine, phi);
  const Color4* row = scale_.data() + at.cosine.lower * fine_.phis;
  const Color4 low = sunbeam::lerp(row, at.phi), high = sunbeam::lerp(row + fine_.phis, at.phi);
  return low + at.cosine.upper_weight * (high - low);
}

Color4 BoundRest::anisotropic(const Vec3& wo, const Vec3& wi, const Cosine& cos_o,
                              const Cosine& cos_i) const {
  const float phi_o = quadrant(wo), phi_i = quadrant(wi);
  const Place o = coarse_.place(cos_o, phi_o), i = coarse_.place(cos_i, phi_i);
  Color4 ratio{};
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      const int node = (o.cosine.lower + a) * coarse_.phis + o.phi.lower + b;
      const float weight = (a ? o.cosine.upper_weight : 1 - o.cosine.upper_weight) *
                           (b ? o.phi.upper_weight : 1 - o.phi.upper_weight);
      const Color4* row = ratio_.data() + node * coarse_.size() + i.cosine.lower * coarse_.phis;
      const Color4 low = sunbeam::lerp(row, i.phi), high = sunbeam::lerp(row + coarse_.phis, i.phi);
      ratio += weight * (low + i.cosine.upper_weight * (high - low));
    }
  return scale_at(cos_o, phi_o) * scale_at(cos_i, phi_i) * ratio;
}

}  // namespace sunbeam::inline v1
