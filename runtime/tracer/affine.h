// This file holds affine maps of points.
#pragma once

#include <array>

#include "sunbeam/core/vec.h"

namespace sunbeam {

// Maps a point p to linear(p) + offset.
struct Affine {
  std::array<Vec3, 3> columns = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 offset = {};

  Vec3 linear(const Vec3& v) const { return v.x * columns[0] + v.y * columns[1] + v.z * columns[2]; }
  Vec3 point(const Vec3& p) const { return linear(p) + offset; }
  double determinant() const { return dot(columns[0], cross(columns[1], columns[2])); }
  // Maps a normal by the cofactors, which are the inverse transpose up to a factor; it is turned back where
  // the map mirrors. It is 0 where the map is flat along it.
  Vec3 normal(const Vec3& n) const {
    const Vec3 turned = n.x * cross(columns[1], columns[2]) + n.y * cross(columns[2], columns[0]) +
                        n.z * cross(columns[0], columns[1]);
    return determinant() < 0 ? -turned : turned;
  }
  Affine operator*(const Affine& inner) const {
    return {{linear(inner.columns[0]), linear(inner.columns[1]), linear(inner.columns[2])},
            point(inner.offset)};
  }
  void add(double weight, const Affine& other) {
    for (std::size_t i = 0; i < 3; ++i) columns[i] = columns[i] + weight * other.columns[i];
    offset = offset + weight * other.offset;
  }
};

}  // namespace sunbeam
