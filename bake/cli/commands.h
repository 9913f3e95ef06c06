// This file declares the subcommands of `sunbeam`, each as a plain struct of options and a function. main.cpp
// fills the options from the command line; every function returns the exit code and throws Error for bad
// input.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bake/compare/flip.h"

namespace sunbeam {

struct BakeOptions {
  std::string recipe, output;
  std::vector<std::string> overrides;
  std::string progress = "text";
  int threads = 0;
  std::uint64_t seed = 1;
  int shard = 0, shards = 0;  // shard counts from 1; 0: all in one go
  bool resume = false, preview = false;
};
int run_bake(const BakeOptions& options);

struct MergeOptions {
  std::vector<std::string> parts;
  std::string output;
  std::string progress = "text";
  int threads = 0;
};
int run_merge(const MergeOptions& options);

struct InfoOptions {
  std::string source;  // table or recipe
  bool json = false;
};
int run_info(const InfoOptions& options);

struct EvalOptions {
  std::string source, points;
  std::string quantity = "brdf";
  std::string estimator = "auto";
  std::vector<std::string> overrides;
  std::int64_t samples = 10000;
  std::uint64_t seed = 1;
};
int run_eval(const EvalOptions& options);

struct VerifyOptions {
  std::string table, json, html;
  std::string truth;  // empty: the default of the recipe
  int points = 1000;
  int threads = 0;
  std::uint64_t seed = 2024;
};
int run_verify(const VerifyOptions& options);

struct PlotOptions {
  std::string table, output, what;
  // Values that are not given are the table's defaults.
  std::optional<double> film_thickness_nm, base_ior, absorption_per_nm;
  std::optional<double> theta_i_deg;  // of --what polar
};
int run_plot(const PlotOptions& options);

struct RenderOptions {
  std::string scene, output, stats;
  std::string table;  // in place of the scene's own
  std::vector<std::string> overrides;
  std::string material = "table";
  std::string estimator = "auto";   // of --material live
  std::optional<std::string> size;  // WIDTHxHEIGHT; as the scene says if not given
  int samples_per_pixel = 0;        // 0: as the scene says
  std::optional<std::string> time;  // limit, with its unit
  std::optional<std::string> crop;  // X0,Y0,X1,Y1
  double noise = 0;                 // limit; 0: none
  double watch_seconds = 0;         // between pictures on disk; 0: only the last
  bool aovs = false;
  std::string resume;  // picture to go on from
  int threads = 0;
  std::uint64_t seed = 1;
};
int run_render(const RenderOptions& options);

struct CompareOptions {
  std::string test, reference;
  std::string png;  // false-colour FLIP; empty: none
  bool json = false;
  double pixels_per_degree = kDefaultPixelsPerDegree;
  // The exit code is 1 above these.
  std::optional<double> max_rmse, max_relmse, max_flip, max_bias, max_bias_z;
};
int run_compare(const CompareOptions& options);

struct TextureOptions {
  std::string output;
  std::string pattern = "hexagonal";  // or voronoi, snake, snake_head
  int columns = 8, rows = 10;         // of scales in the tile
  double edge = 0.35, jitter = 1;
  int pixels_per_scale = 64;
  std::uint64_t seed = 1;
};
int run_texture(const TextureOptions& options);

struct MeshOptions {
  std::string shape, output;  // snake, torus or sphere
  int resolution = 128;
  double body_radius = 0.25, turns = 2.5;          // of the snake
  double major_radius = 1.0, minor_radius = 0.35;  // of the torus
  double radius = 1.0;                             // of the sphere
};
int run_mesh(const MeshOptions& options);

}  // namespace sunbeam
