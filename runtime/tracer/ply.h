// This file reads PLY files, ascii or binary of either byte order.
#pragma once

#include <string>
#include <string_view>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam {

// Reads of the element `vertex` x, y, z; nx, ny, nz; s, t or u, v or texture_u, texture_v. Of `face` it reads
// vertex_indices or vertex_index, polygons that are cut into triangles, and texcoord, u and v for each
// corner, which count before those of vertices if all faces have them; corners are vertices of their own
// then. Of `tristrips` it reads vertex_indices or vertex_index, strips of triangles that -1 ends. All else is
// passed over. Throws Error as load_mesh() does.
LoadedMesh load_ply(const std::string& path);

// Does the same with the bytes of a file; `path` names it in messages.
LoadedMesh parse_ply(std::string_view bytes, const std::string& path);

}  // namespace sunbeam
