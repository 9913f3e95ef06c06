// This file answers what the pictures of a report ask of a material, from a table or live. The answers are
// its parts, deterministic, in linear Rec.709; each is symmetric in its two directions.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bake/live/estimator.h"
#include "bake/live/exact/exact_bsdf.h"
#include "bake/optics/spectrum.h"
#include "sunbeam/core/color_space.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam {

class Appearance {
 public:
  virtual ~Appearance() = default;
  virtual const Material& material() const = 0;
  virtual Rgb first(const Vec3& a, const Vec3& b) const = 0;  // 1/sr
  virtual Rgb dirac(const Vec3& a) const = 0;                 // weight of a smooth film's mirror direction
  // Returns the rest for every b, 1/sr. Live walks from a serve them all.
  virtual std::vector<Rgb> rest(const Vec3& a, std::span<const Vec3> b) const = 0;
};

class TableAppearance final : public Appearance {
 public:
  TableAppearance(const Table& table, const Parameters& parameters, OutsideGrid outside)
      : bsdf_(table, parameters, {.outside = outside, .color_space = ColorSpace::rec709}) {}

  const Material& material() const override { return bsdf_.material(); }
  Rgb first(const Vec3& a, const Vec3& b) const override { return bsdf_.first(a, b); }
  Rgb dirac(const Vec3& a) const override { return bsdf_.dirac(a); }
  std::vector<Rgb> rest(const Vec3& a, std::span<const Vec3> b) const override;
  Rgb film_reflectance(double cosine) const { return bsdf_.film_reflectance(cosine); }

 private:
  TableBsdf bsdf_;
};

// These are the estimates of a live direction where there is no exact evaluator: a picture has thousands of
// directions, a curve has few.
inline constexpr int kPictureEstimates = 16, kCurveEstimates = 512;

// Evaluates the live model. It is exact where a renderer's exact evaluator is valid; else walks use the same
// random numbers at every direction `a`, so that what noise is left varies smoothly over a picture.
class LiveAppearance final : public Appearance {
 public:
  LiveAppearance(const Material& material, const Spectrum& spectrum, int estimates);

  const Material& material() const override { return material_; }
  Rgb first(const Vec3& a, const Vec3& b) const override { return to_rec709_ * pfmc_.first(a, b); }
  Rgb dirac(const Vec3& a) const override { return to_rec709_ * pfmc_.dirac(a); }
  std::vector<Rgb> rest(const Vec3& a, std::span<const Vec3> b) const override;

 private:
  std::vector<Rgb> walked_rest(const Vec3& a, std::span<const Vec3> b) const;

  Material material_;
  Estimator estimator_;
  int estimates_;
  Pfmc pfmc_;
  std::optional<ExactBsdf> exact_;
  ColorMatrix to_rec709_;
};

// Says how the rest of LiveAppearance is found, for a caption.
std::string live_method(const Material& material, int estimates);

}  // namespace sunbeam
