// ExactRest at every wavelength, one after the other, folded. Stands in for an ExactRest(material,
// wavelengths).
#pragma once

#include <vector>

#include "bake/live/exact.h"
#include "bake/live/wavelengths.h"

namespace sunbeam {

class ExactFold {
 public:
  ExactFold(const Material& material, const Wavelengths& wavelengths) : weight_(wavelengths.weight) {
    for (std::size_t k = 0; k < wavelengths.size(); ++k) {
      Material single = material;
      single.albedo = Rgb(wavelengths.albedo[k]);
      single.absorption_per_nm *= wavelengths.absorption[k];
      exact_.emplace_back(single, Rgb(wavelengths.nm[k]));
    }
  }

  Rgb rest(const Vec3& wo, const Vec3& wi) const {
    return fold([&](const ExactRest& exact) { return exact.rest(wo, wi).r; });
  }
  Rgb albedo(const Vec3& w) const {
    return fold([&](const ExactRest& exact) { return exact.albedo(w).r; });
  }

 private:
  template <class F>
  Rgb fold(F value) const {
    Rgb sum;
    for (std::size_t k = 0; k < exact_.size(); ++k) sum += value(exact_[k]) * weight_[k];
    return sum;
  }

  std::vector<Rgb> weight_;
  std::vector<ExactRest> exact_;
};

}  // namespace sunbeam
