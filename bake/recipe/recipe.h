// A recipe says what to bake, over which grid, how finely and how accurately. It is written in TOML;
// docs/reference/recipe.md lists the keys.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bake/live/estimator.h"
#include "bake/optics/spectrum.h"
#include "bake/recipe/encoding.h"
#include "sunbeam/detail/axis.h"
#include "sunbeam/detail/nd_array.h"
#include "sunbeam/material.h"
#include "sunbeam/table.h"

namespace sunbeam {

// Says where the values of a dense table come from. `automatic` takes adding and doubling where it solves the
// material (live/adding_doubling/slab_solver.h), else walks.
enum class TableValues { automatic, walks };

inline constexpr int kMostDirectionNodes = 512;  // of table.angles and table.azimuths

struct Recipe {
  Material
      material;  // [material]: fixed values, and defaults of the grid's parameters; albedo as Spectrum has it
  std::vector<Axis> grid;  // [grid]: the three parameter axes in table order; one node if not swept

  struct {
    int angles = 12;  // nodes over cos(theta), for wi and wo alike
    // In a dense table these are the nodes over |dphi| in [0, pi]; 1 where the rest has no azimuth. An
    // anisotropic film has this many nodes over phi_o in [0, 2 pi), a multiple of 4, and azimuths / 4 + 1
    // over phi_i in [0, pi/2].
    int azimuths = 1;
    Precision precision = Precision::half_float;
    Encoding encoding = Encoding::automatic;
    TableValues values = TableValues::automatic;
  } table;

  struct {
    // This relative standard error is allowed of any tabulated value. Unless given it is tolerance_median, at
    // most 0.005.
    double noise = 0.005;
    double tolerance_median = 0.01;  // of verify's error
    double tolerance_p99 = 0.05;
    Estimator estimator = Estimator::pfmc;  // or bidirectional
  } accuracy;

  Spectrum spectrum;  // [spectrum], with albedo and absorption_spectrum of [material]

  std::string name;  // file name, for messages
  std::string text;  // canonical TOML with overrides applied
  std::string hash;  // of `text`
};

inline Symmetry symmetry_of(const Recipe& recipe) {
  return recipe.material.roughness.is_isotropic() ? Symmetry::isotropic : Symmetry::anisotropic;
}

// Says whether film and base are more than one clear layer of constant index on a clear base.
inline bool is_layered(const Recipe& recipe) { return recipe.spectrum.film().is_layered(recipe.material); }

// Says whether some base IOR of the recipe lies below the exterior's.
bool reaches_below(const Recipe& recipe);

// Returns the material at the lowest base IOR of the grid.
Material at_lowest_base_ior(const Recipe& recipe);

// Returns true if a dense table of the recipe is solved, false if it is walked.
inline bool is_solved(const Recipe& recipe) {
  return recipe.table.values == TableValues::automatic && has_solution(recipe.material);
}

// Reads a recipe from a file or a text. `overrides` are "section.key=value". Throws Error for anything
// unknown, missing or out of range.
Recipe load_recipe(const std::string& path, const std::vector<std::string>& overrides = {});
Recipe parse_recipe(const std::string& text, const std::string& name,
                    const std::vector<std::string>& overrides = {});
// Reads the recipe that a table was baked from. Keys that recipes had once and have no more are passed over.
Recipe parse_stored_recipe(const std::string& text, const std::string& name);

}  // namespace sunbeam
