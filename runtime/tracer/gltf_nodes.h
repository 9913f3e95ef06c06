// This file places the nodes of a glTF scene.
#pragma once

#include <optional>
#include <vector>

#include "runtime/tracer/affine.h"
#include "runtime/tracer/gltf_document.h"

namespace sunbeam {

struct GltfNodes {
  std::vector<std::size_t> order;               // of the scene's nodes, each before its children
  std::vector<std::optional<Affine>> to_world;  // of every node of the file, if the scene has it
};

// Takes the default scene, the first if none is named, or all nodes if there are no scenes. Throws Error if a
// node is met twice, or for a matrix that is not affine.
GltfNodes place_nodes(const GltfDocument& document);

// Makes a map of the 16 numbers of a matrix, column by column. Throws Error unless its last row is 0 0 0 1.
Affine affine_of(const double* numbers);

}  // namespace sunbeam
