// This is the contract that every BSDF of Sunbeam keeps, live or tabulated.
//
// Frame: local, z = shading normal. `wo` points towards the viewer, `wi` towards the light; both are unit
// vectors that point away from the surface. Only reflection exists: for wo.z <= 0 or wi.z <= 0 values and
// densities are 0 and sample() is empty.
#pragma once

#include <array>
#include <optional>

#include "sunbeam/core/export.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

// Holds the numbers in [0, 1) that one direction is drawn from. The first chooses the lobe, and all three
// move the direction, so that points spread evenly over the cube spread directions evenly.
using Random3 = std::array<double, 3>;

inline Random3 random3(Rng& rng) {
  const double first = rng.uniform(), second = rng.uniform();
  return {first, second, rng.uniform()};
}

// A direction that sample() has drawn, and what a path carries on along it.
struct BsdfSample {
  Vec3 wi;
  // f cos(theta_i) / pdf of the whole BSDF at wi, or an estimate with that mean. For a Dirac lobe it is the
  // lobe's weight over the probability of choosing it. The cosine is included, so a path multiplies by this
  // alone.
  Rgb throughput;
  bool is_dirac;   // true if wi comes from a Dirac lobe, which eval and pdf do not see
  double mis_pdf;  // equals Bsdf::mis_pdf(wo, wi); 0 for a Dirac lobe
};

// A value and the density that weights it, for light from a direction that is already known.
struct EvalPdf {
  Rgb f;       // 1/sr, without the cosine
  double pdf;  // 1/sr
};

// What a path needs at one vertex: the light that is sampled directly, and where to go on.
struct EvalAndSample {
  EvalPdf eval;
  std::optional<BsdfSample> sample;
};

class SUNBEAM_EXPORT Bsdf {
 public:
  virtual ~Bsdf() = default;

  // Returns f(wo, wi) in 1/sr, without the cosine and without Dirac lobes. A stochastic BSDF returns an
  // unbiased estimate that depends on `rng` alone; a deterministic one leaves `rng` untouched.
  virtual Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const = 0;

  // Draws one direction. The result is empty when the light is lost (absorbed, shadowed): the path then ends.
  virtual std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const = 0;

  // Does the same from the caller's numbers: a deterministic BSDF is a pure function of `wo` and `u` and
  // leaves `rng` untouched, a stochastic one draws from `rng` and leaves `u`.
  virtual std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u, Rng& rng) const {
    (void)u;
    return sample(wo, rng);
  }

  // Returns the density per solid angle (1/sr) of a non-Dirac outcome of sample(). It includes the chance of
  // choosing the lobe, so that its integral is 1 - P(Dirac) - P(empty). It is exact if the BSDF is
  // deterministic, else an unbiased estimate.
  virtual double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const = 0;

  // Returns the density (1/sr) to weight techniques with in multiple importance sampling. It is deterministic
  // and cheap. It equals pdf() where that is exact and approximates it elsewhere; any positive function keeps
  // MIS unbiased.
  virtual double mis_pdf(const Vec3& wo, const Vec3& wi) const = 0;

  // Returns eval() and mis_pdf() together; where they share work this costs no more than one of them.
  virtual EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    return {eval(wo, wi, rng), mis_pdf(wo, wi)};
  }

  // Returns eval_pdf(wo, wi) and then sample(wo); where they share work this costs less than both calls.
  virtual EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    const EvalPdf value = eval_pdf(wo, wi, rng);
    return {value, sample(wo, rng)};
  }

  // Does the same with sample(wo, u, rng).
  virtual EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u, Rng& rng) const {
    const EvalPdf value = eval_pdf(wo, wi, rng);
    return {value, sample(wo, u, rng)};
  }

  // Says whether turning wo and wi together about the normal changes nothing, so that any tangent serves.
  virtual bool is_isotropic() const { return false; }
};

}  // namespace v1
}  // namespace sunbeam
