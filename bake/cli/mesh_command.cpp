#include <fmt/format.h>

#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "runtime/tracer/mesh_file.h"
#include "runtime/tracer/snake.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

void require_length(const char* option, double value) {
  if (!(value >= 1e-6 && value <= 1e6))
    throw Error(fmt::format("{}: found {:g}; allowed: 1e-06 to 1e+06", option, value));
}

Mesh make_torus(const MeshOptions& options) {
  require_length("--major-radius", options.major_radius);
  require_length("--minor-radius", options.minor_radius);
  if (options.minor_radius >= options.major_radius)
    throw Error(fmt::format("--minor-radius: found {:g}; allowed: below --major-radius, {:g}",
                            options.minor_radius, options.major_radius));
  return torus_mesh({}, options.major_radius, options.minor_radius, {}, options.resolution);
}

Mesh make_sphere(const MeshOptions& options) {
  require_length("--radius", options.radius);
  return sphere_mesh(options.radius, options.resolution);
}

Mesh make_snake(const MeshOptions& options) {
  require_length("--body-radius", options.body_radius);
  if (!(options.turns >= 1 && options.turns <= 6))
    throw Error(fmt::format("--turns: found {:g}; allowed: 1 to 6", options.turns));
  return snake_mesh({options.body_radius, options.turns, options.resolution});
}

}  // namespace

int run_mesh(const MeshOptions& options) {
  require_mesh_extension(options.output);
  require_writable(options.output);
  const Mesh mesh = options.shape == "snake"   ? make_snake(options)
                    : options.shape == "torus" ? make_torus(options)
                                               : make_sphere(options);
  write_mesh(options.output, mesh);
  message("{}: {} vertices, {} triangles", options.output, mesh.positions.size(), mesh.triangles.size());
  return 0;
}

}  // namespace sunbeam
