// This file makes the BSDFs of a scene: tables, live models or plain diffuse ones.
#pragma once

#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bake/live/estimator.h"
#include "bake/recipe/recipe.h"
#include "runtime/tracer/scene.h"
#include "runtime/tracer/surface_bsdf.h"
#include "sunbeam/table.h"

namespace sunbeam {

// Holds one BSDF for each material of the scene, in linear Rec.709, the tracer's space. Reads the scene's
// table or recipe, whichever `mode` ("table", "live", "diffuse") needs, and writes the parameters that a skin
// takes from it into the scene. Throws Error naming the file and the material. Where parameters vary over a
// surface, a table clamps them to its grid, with a warning, and the live model is made anew at every hit,
// which is slow.
class SceneMaterials {
 public:
  SceneMaterials(Scene& scene, const std::string& scene_path, const std::string& mode, Estimator estimator);

  std::span<const SurfaceBsdf> bsdfs() const { return bsdfs_; }
  const std::string& table_hash() const { return table_hash_; }
  // Returns the names of the live skins' evaluators; empty if there are none.
  std::string estimators() const;
  // Returns the warnings for people, a line each.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void add(std::unique_ptr<Bsdf> bsdf);
  void add(std::unique_ptr<VaryingBsdf> bsdf);
  void add_table_skin(const SceneMaterial& skin, const Table& table);
  void add_live_skin(const SceneMaterial& skin, const Recipe& recipe, Estimator wanted);

  std::vector<std::unique_ptr<Bsdf>> uniform_;
  std::vector<std::unique_ptr<VaryingBsdf>> varying_;
  std::vector<SurfaceBsdf> bsdfs_;
  std::string table_hash_;
  std::set<std::string> estimators_;
  std::vector<std::string> warnings_;
};

}  // namespace sunbeam
