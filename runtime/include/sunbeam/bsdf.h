// The contract of every BSDF in Sunbeam, live or tabulated.
//
// Frame: local, z = shading normal. `wo` points towards the viewer, `wi` towards the light; both are unit
// vectors that point away from the surface. Only reflection exists: for wo.z <= 0 or wi.z <= 0 values and
// densities are 0 and sample() is empty.
#pragma once

#include <optional>

#include "sunbeam/core/rng.h"
#include "sunbeam/core/vec.h"

namespace sunbeam::inline v1 {

struct BsdfSample {
  Vec3 wi;
  Rgb throughput;  // f * cos(theta_i) / pdf of the whole BSDF at wi, or an estimate with that mean;
                   // for a Dirac lobe its weight / its probability
  bool is_dirac;   // the direction comes from a Dirac lobe, which eval and pdf do not see
  double mis_pdf;  // Bsdf::mis_pdf(wo, wi), known on the way; 0 for a Dirac lobe
};

struct EvalPdf {
  Rgb f;       // 1/sr
  double pdf;  // 1/sr
};

struct EvalAndSample {
  EvalPdf eval;
  std::optional<BsdfSample> sample;
};

class Bsdf {
 public:
  virtual ~Bsdf() = default;

  // f(wo, wi) in 1/sr, without the cosine and without Dirac lobes. A stochastic BSDF returns an unbiased
  // estimate that depends on `rng` alone; a deterministic one leaves `rng` untouched.
  virtual Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const = 0;

  // One direction. Empty when the walk is lost (absorbed, shadowed): it then contributes nothing.
  virtual std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const = 0;

  // Density per solid angle (1/sr) of a non-Dirac outcome of sample(), the chance of choosing it included:
  // its integral is 1 - P(Dirac) - P(empty). Exact if the BSDF is deterministic, else an unbiased estimate.
  virtual double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const = 0;

  // The density to weight techniques with (MIS): deterministic and cheap. Equal to pdf() where that is exact,
  // else an approximation; any positive function keeps MIS unbiased.
  virtual double mis_pdf(const Vec3& wo, const Vec3& wi) const = 0;

  // eval() and mis_pdf() together, where they share work at the price of one.
  virtual EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    return {eval(wo, wi, rng), mis_pdf(wo, wi)};
  }

  // eval_pdf(wo, wi) and then sample(wo), where they share work at less than the price of both.
  virtual EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    const EvalPdf value = eval_pdf(wo, wi, rng);
    return {value, sample(wo, rng)};
  }

  // Whether turning wo and wi together about the normal changes nothing: any tangent serves.
  virtual bool is_isotropic() const { return false; }
};

}  // namespace sunbeam::inline v1
