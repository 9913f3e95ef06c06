// Wavefront OBJ files: positions, texture coordinates, normals and faces of all groups as one mesh; materials
// are ignored.
#pragma once

#include <string>

#include "runtime/tracer/mesh.h"

namespace sunbeam {

// Polygons are cut into triangles. Every vertex becomes scale * v + translate. Corners are vertices of their
// own, so texture coordinates may have seams; they, like normals, are used only if every corner has one.
// Throws Error naming the file, and the line where there is one, if the file is missing, has no face, or
// holds a number that is missing or not finite (a vt needs two), an index out of range, a normal of length
// zero or a triangle without area.
Mesh load_obj(const std::string& path, double scale, const Vec3& translate);

}  // namespace sunbeam
