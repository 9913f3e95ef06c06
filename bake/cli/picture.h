// This file reads and writes the pictures of `sunbeam render`, with what they keep beside their pixels.
#pragma once

#include <string>

#include "runtime/tracer/render.h"

namespace sunbeam {

// Says what a picture was made from; its .exr holds it in string attributes "sunbeam.NAME".
struct PictureSource {
  std::string scene;       // path
  std::string scene_hash;  // of the scene file, its number of samples left out
  std::string material, estimators, table_hash;
  std::uint64_t seed = 0;
};

// Writes OUTPUT.exr with all layers: mean, variance.R/G/B, sample_count and, where the picture has them,
// albedo.R/G/B, normal.X/Y/Z and geometric_normal.X/Y/Z (world space), Z (distance from the camera) and
// film_thickness_nm; and a .png beside it, whose clipping goes to stderr if `report` says so.
void write_picture(const std::string& output, const RenderResult& picture, const PictureSource& source,
                   bool report);

// Reads what write_picture() wrote, to go on from; seconds are those it took. Throws Error naming the file
// and what differs if it was made from something else or lacks a layer.
RenderResult read_picture(const std::string& path, const PictureSource& source);

// Returns the path of the .png beside OUTPUT.exr.
std::string png_beside(const std::string& output);

}  // namespace sunbeam
