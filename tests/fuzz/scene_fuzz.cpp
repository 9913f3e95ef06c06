// Scenes without the files that they may name: TOML, keys, ranges, and the shapes that keys make.
#include <cmath>
#include <cstdlib>

#include "runtime/tracer/scene.h"
#include "tests/fuzz/support.h"

namespace {

using namespace sunbeam;

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check_mesh(const Mesh& mesh) {
  for (const Vec3& position : mesh.positions)
    if (!is_finite(position)) std::abort();
  for (const auto& triangle : mesh.triangles)
    for (const auto vertex : triangle)
      if (vertex >= mesh.positions.size()) std::abort();
}

void check_scene(const Scene& scene) {
  if (!is_finite(scene.camera.position)) std::abort();
  for (const SceneObject& object : scene.objects) {
    if (static_cast<std::size_t>(object.material) >= scene.materials.size()) std::abort();
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape)) check_mesh(*mesh);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return test::fuzz(data, size, [](const std::string& bytes) {
    if (bytes.find("file") == std::string::npos) check_scene(read_scene(ConfigTable::parse(bytes, "s")));
  });
}
