// The rest of a factored table as a renderer meets it: rest = scale(wi) scale(wo) ratio(wi, wo).
//
// scale is what of a direction's light reaches the base, folded, on a fine grid; it holds the fringes and the
// pigment's decay. ratio is what is left, smooth, on a coarse one. Directions are (cosine, phi), phi folded
// into the first quadrant of an anisotropic film.
#pragma once

#include <span>
#include <vector>

#include "runtime/src/base/color4.h"
#include "runtime/src/fit/wave_field.h"

namespace sunbeam::inline v1 {

class BoundRest {
 public:
  static constexpr int kScaleCosines = 513, kRatioCosines = 65;  // of an isotropic table

  BoundRest(const WaveField& rest, Symmetry symmetry);

  // A direction's cosine and its root, > 0.
  struct Cosine {
    explicit Cosine(float c) : Cosine(c, std::sqrt(c)) {}
    Cosine(float c, float root_of_c) : cosine(c), root(root_of_c) {}
    float cosine, root;
  };

  bool is_isotropic() const { return fine_.phis == 1; }

  // Of an isotropic table: scales at even cosines and one node more, and the ratio at nodes even in the
  // roots.
  std::span<const Color4> scales() const { return scale_; }
  const Color4& ratio(int o, int i) const {
    return ratio_[static_cast<std::size_t>(o * coarse_.cosines + i)];
  }

  // 1/sr, for wo.z > 0 and wi.z > 0, whose cosines o and i are.
  Color4 operator()(const Vec3& wo, const Vec3& wi, const Cosine& o, const Cosine& i) const {
    return is_isotropic() ? isotropic(o, i) : anisotropic(wo, wi, o, i);
  }
  Color4 operator()(const Vec3& wo, const Vec3& wi) const {
    return (*this)(wo, wi, Cosine(static_cast<float>(wo.z)), Cosine(static_cast<float>(wi.z)));
  }

 private:
  struct Place {
    EvenPosition cosine, phi;
  };
  struct Grid {
    int cosines, phis;
    bool by_root;  // nodes even in the root of the cosine
    int size() const { return cosines * phis; }
    Place place(const Cosine& at, float phi) const {
      return {{by_root ? at.root : at.cosine, cosines}, {phi, phis}};
    }
  };
  static float quadrant(const Vec3& w);
  static std::vector<WaveField::End> ends(const WaveField& rest, const Grid& grid);
  Color4 isotropic(const Cosine& o, const Cosine& i) const {
    const Color4 scale = sunbeam::lerp(scale_.data(), EvenPosition(o.cosine, fine_.cosines)) *
                         sunbeam::lerp(scale_.data(), EvenPosition(i.cosine, fine_.cosines));
    const EvenPosition at_o(o.root, coarse_.cosines), at_i(i.root, coarse_.cosines);
    const Color4* row = ratio_.data() + at_o.lower * coarse_.cosines;
    const Color4 low = sunbeam::lerp(row, at_i), high = sunbeam::lerp(row + coarse_.cosines, at_i);
    return scale * (low + at_o.upper_weight * (high - low));
  }
  SUNBEAM_NOINLINE Color4 anisotropic(const Vec3& wo, const Vec3& wi, const Cosine& o, const Cosine& i) const;
  Color4 scale_at(const Cosine& at, float phi) const;

  Grid fine_, coarse_;
  std::vector<Color4> scale_, ratio_;
};

}  // namespace sunbeam::inline v1
