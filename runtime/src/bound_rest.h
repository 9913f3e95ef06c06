// The rest of a factored table as a renderer meets it: rest = scale(wi) scale(wo) ratio(wi, wo).
//
// scale is what of a direction's light reaches the base, folded, on a fine grid; it holds the fringes and the
// pigment's decay. ratio is what is left, smooth, on a coarse one. Directions are (cosine, phi), phi folded
// into the first quadrant of an anisotropic film.
#pragma once

#include <vector>

#include "color4.h"
#include "factored_rest.h"

namespace sunbeam {

class BoundRest {
 public:
  BoundRest(const FactoredRest& rest, Symmetry symmetry);

  // 1/sr, for wo.z > 0 and wi.z > 0.
  Color4 operator()(const Vec3& wo, const Vec3& wi) const;

  // Of an isotropic table, all that matters.
  Color4 at_cosines(float cos_o, float cos_i) const;

 private:
  struct Place {
    EvenPosition cosine, phi;
  };
  struct Grid {
    int cosines, phis;
    bool by_root;  // nodes even in the root of the cosine
    int size() const { return cosines * phis; }
    Place place(float cosine, float phi) const {
      return {{by_root ? std::sqrt(cosine) : cosine, cosines}, {phi, phis}};
    }
  };
  static float quadrant(const Vec3& w);
  static std::vector<FactoredRest::End> ends(const FactoredRest& rest, const Grid& grid);
  Color4 scale_at(const Vec3& w, float phi) const;
  Color4 anisotropic(const Vec3& wo, const Vec3& wi) const;

  Grid fine_, coarse_;
  std::vector<Color4> scale_, ratio_;
};

}  // namespace sunbeam
