// This file reads meshes from OBJ, PLY and glTF 2.0 files, and writes OBJ and PLY.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "runtime/tracer/mesh.h"

namespace sunbeam {

struct LoadedMesh {
  Mesh mesh;
  std::size_t dropped = 0;  // triangles without area, which are left out
};

// Reads .obj, .ply (ascii or binary), .gltf or .glb. All groups, primitives and nodes become one mesh, the
// transforms of glTF nodes applied; materials are ignored, points and lines left out. Normals and texture
// coordinates (the first set) are used only if all parts have them; v points up, as in OBJ. Axes stay as they
// are: glTF has y up, scenes have z up. Buffers of glTF are read from the folder of `path` and, unless it is
// empty, from `folder`, or below. Throws Error naming the file for another extension, a file that is missing
// or damaged, an index out of range, a number that is not finite, a normal of length zero, a mesh beyond
// read_limit(), or if no triangle with an area is left.
LoadedMesh load_mesh(const std::string& path, const std::string& folder = "");

// Writes .obj, or .ply (binary, little-endian, single precision; texture coordinates as s, t). Throws Error
// for another extension or if the file cannot be written.
void require_mesh_extension(const std::string& path);
void write_mesh(const std::string& path, const Mesh& mesh);

// Finishes a mesh, as every importer does: it makes the checks of load_mesh() on numbers and areas, and makes
// normals unit. Indices must be in range.
LoadedMesh checked_mesh(const std::string& path, Mesh mesh);

// Returns an index that a file gives as a number. Throws Error unless it is whole and below `count`; `name`
// says of what it is an index.
std::uint32_t checked_index(const char* name, double index, std::uint64_t count);

// Throws Error unless indices of 32 bits can count the vertices, and a mesh of this size is within
// read_limit() of a file of `file_bytes`. Importers ask before they make one.
void require_mesh_memory(const std::string& path, std::uint64_t vertices, std::uint64_t triangles,
                         std::uint64_t file_bytes);

}  // namespace sunbeam
