// This file finds the direction of increasing u on a mesh: the local x axis of BSDFs, which anisotropic ones
// depend on.
#pragma once

#include <vector>

#include "runtime/tracer/mesh.h"

namespace sunbeam {

// Returns one tangent for each triangle of a mesh with texture coordinates, else none. In world space it is
// unit, along dp/du, or zero if the coordinates of the triangle span no area.
std::vector<Vec3> triangle_tangents(const Mesh& mesh);

// Returns one tangent for each position of a mesh with normals and texture coordinates, else none. In world
// space it is the mean dp/du around the vertex, unit and perpendicular to its normal, or zero if there is no
// such direction. Interpolated over triangles they do not show facets. Vertices that share position and
// normal are seen as copies of one, as at a seam: each is the mean over those whose directions lie within 60
// degrees of its own. So u may start again at a seam without a trace, while mirrored and unrelated charts
// stay apart.
std::vector<Vec3> vertex_tangents(const Mesh& mesh);

// Holds dp/du and dp/dv, world length for a unit of u and of v. Both are zero where the coordinates span no
// area.
struct UvDerivatives {
  Vec3 du, dv;
};

// Returns one pair for each position of a mesh with texture coordinates, else none: the mean over the
// triangles around the vertex and, on a mesh with normals, over its copies at a seam, as with
// vertex_tangents().
std::vector<UvDerivatives> vertex_derivatives(const Mesh& mesh);

inline Vec3 unit_or_zero(const Vec3& v) {
  const double size = length(v);
  return size > 0 ? v / size : Vec3{};
}

}  // namespace sunbeam
