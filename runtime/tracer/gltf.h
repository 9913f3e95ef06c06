// This file reads glTF 2.0: .gltf with its buffers beside or inside it, and .glb.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "runtime/tracer/mesh_file.h"

namespace sunbeam {

// Returns the triangles, strips and fans of all nodes of the default scene (the first if none is named), as
// they stand without animation: morph targets have their weights, a skinned mesh follows its joints, all
// others the matrices of their nodes. Buffers in other files lie in the folder of `path` or in `folder`, if
// that is given, or below. Throws Error as load_mesh() does, and for what is not read: compressed data and
// required extensions that change geometry.
LoadedMesh load_gltf(const std::string& path, const std::string& folder = "");

// Does the same with the bytes of a file; `path` names it in messages, and uris start from folders[0].
LoadedMesh parse_gltf(std::string_view bytes, const std::string& path, std::vector<std::string> folders);

}  // namespace sunbeam
