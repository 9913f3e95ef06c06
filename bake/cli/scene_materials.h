// The BSDFs of a scene: tables, live models or plain diffuse ones.
#pragma once

#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bake/estimator.h"
#include "bake/live/spectrum.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/bsdf.h"
#include "sunbeam/core/color_space.h"
#include "sunbeam/material.h"

namespace sunbeam {

// One BSDF for each material of the scene, in linear Rec.709, the tracer's space. Reads the scene's table or
// recipe, whichever `mode` ("table", "live", "diffuse") needs, and writes the parameters that a skin takes
// from it into the scene. Throws Error naming the file and the material.
class SceneMaterials {
 public:
  SceneMaterials(Scene& scene, const std::string& scene_path, const std::string& mode, Estimator estimator);

  std::span<const Bsdf* const> bsdfs() const { return pointers_; }
  const std::string& table_hash() const { return table_hash_; }
  // The live skins' evaluators, by name; empty if there are none.
  std::string estimators() const;

 private:
  void add_live(const Material& material, const Spectrum& spectrum, Estimator wanted,
                const std::string& where);
  void add(std::unique_ptr<Bsdf> bsdf);
  void add_skin(std::unique_ptr<Bsdf> bsdf, ColorSpace space);

  std::vector<std::unique_ptr<Bsdf>> owned_;
  std::vector<const Bsdf*> pointers_;
  std::string table_hash_;
  std::set<std::string> estimators_;
};

}  // namespace sunbeam
