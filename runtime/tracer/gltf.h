// This file reads glTF 2.0: .gltf with its buffers beside or inside it, and .glb.
#pragma once

#include <string>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam {

// Returns the triangles of all nodes of the default scene (the first if none is named), each node's matrix
// applied. Throws Error as load_mesh() does, and for what is not read: compressed or sparse data and triangle
// strips.
LoadedMesh load_gltf(const std::string& path);

}  // namespace sunbeam
