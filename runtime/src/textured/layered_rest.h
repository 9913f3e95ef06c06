// This file looks up a textured table whose film is layered: the arrays R, P, L and X of
// sunbeam/textured_table.h, which layered_arrays.h makes.
#pragma once

#include <array>

#include "runtime/src/base/bound_axis.h"
#include "runtime/src/base/exp4.h"
#include "runtime/src/rest/pair_taps.h"
#include "runtime/src/textured/layered_arrays.h"

namespace sunbeam {
inline namespace v1 {

class LayeredRest {
 public:
  explicit LayeredRest(const Table& table);

  // Says where parameters lie among the nodes.
  template <int kMost>
  struct Neighbours {
    void add(int at, float by) {
      node[count] = at;
      weight[count++] = by;
    }
    int count = 0;
    std::array<int, kMost> node;
    std::array<float, kMost> weight;
  };
  struct Point {
    // Neighbours in thickness and base IOR, cubic in the thickness and linear in it.
    Neighbours<8> cubic;
    Neighbours<4> linear;
    int absorption;                   // the lower neighbour,
    float upper_absorption;           // and the weight of the upper one
    int nearest, nearest_absorption;  // neighbour
    float beyond;                     // the optical depth above the least of the grid
    KneeCosines knee;                 // says where the cosines of R and P lie
  };
  Point point(const Parameters& at) const;

  // Describes a direction; `phi` is the azimuth folded into a quadrant, over pi/2.
  struct End {
    float cosine, per_pigment_cosine, phi;
  };

  // Returns R of a cosine.
  Color4 reflectance(const Point& at, float cosine) const;
  // Holds P, and the exponent of B over it.
  struct Factor {
    Color4 share{}, log{};
  };
  Factor factor(const Point& at, const End& w) const;
  // Returns B B.
  Color4 product(const Factor& o, const Factor& i) const {
    return grid_.absorptions() == 1 ? o.share * i.share : o.share * i.share * exp4(o.log + i.log);
  }

  // Says where X of a pair lies. It is asked for at once, to work meanwhile.
  struct PairRows {
    int count = 0, taps = 0;
    std::array<const Color4*, 32> row;
    std::array<float, 32> weight;
    std::array<int, 4> node;  // in each row, and its weight
    std::array<float, 4> node_weight;
  };
  PairRows pair_rows(const Point& at, const End& o, const End& i) const;
  // Returns X.
  static Color4 exchange(const PairRows& rows);
  // Returns the chance of sampling the first surface, from the nearest parameters.
  float first_chance(const Point& at, const End& w) const;

  bool has_rest() const { return grid_.has_rest; }
  bool is_product() const { return grid_.is_product; }
  const Color4& absorption() const { return absorption_; }
  const EvenAxis& axis(std::size_t k) const { return grid_.even[k]; }
  std::size_t bytes() const { return arrays_.bytes(); }

 private:
  void take_absorption(double absorption_per_nm, Point& point) const;
  Color4 share(const Point& at, const End& w) const;
  Color4 log(const Point& at, const End& w) const;

  LayeredGrid grid_;
  Color4 absorption_;  // a of each channel, and their mean
  double pigment_thickness_nm_;
  BoundAxis base_ior_;
  Color4 least_;  // of R: folded colours may be negative
  LayeredArrays arrays_;
};

}  // namespace v1
}  // namespace sunbeam
