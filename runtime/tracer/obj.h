// This file reads Wavefront OBJ files: positions, texture coordinates, normals and faces of all groups become
// one mesh; materials are ignored.
#pragma once

#include <string>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam {

// Polygons are cut into triangles. Corners are vertices of their own, so texture coordinates may have seams;
// they, like normals, are used only if every corner has one. Throws Error naming the file, and the line where
// there is one, if the file is missing, or holds a number that is missing or not finite (a vt needs two), an
// index out of range, a normal of length zero, or no triangle with an area.
LoadedMesh load_obj(const std::string& path);

}  // namespace sunbeam
