// This file reads Wavefront OBJ files: positions, texture coordinates, normals and faces of all groups become
// one mesh; materials are ignored.
#pragma once

#include <string>
#include <string_view>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam {

// Reads `v`, `vt` (v is 0 where it is left out), `vn` and `f`, and passes over all other lines. Lines end
// with LF, CRLF or CR; a backslash at their end joins the next one. Polygons are cut into triangles. Corners
// are vertices of their own, so texture coordinates may have seams; they, like normals, are used only if
// every corner has one. Throws Error naming the file, and the line where there is one, if the file is
// missing, or holds a number that is missing or not finite in single precision, an index out of range, a
// normal of length zero, or no triangle with an area.
LoadedMesh load_obj(const std::string& path);

// Does the same with the text of a file; `path` names it in messages.
LoadedMesh parse_obj(std::string_view text, const std::string& path);

}  // namespace sunbeam
