// This file reads PLY files, ascii or binary of either byte order.
#pragma once

#include <string>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam {

// Reads of the element `vertex` x, y, z; nx, ny, nz; s, t or u, v or texture_u, texture_v. Of `face` it reads
// vertex_indices or vertex_index, cut into a fan of triangles. All else is passed over. Throws Error as
// load_mesh() does.
LoadedMesh load_ply(const std::string& path);

}  // namespace sunbeam
