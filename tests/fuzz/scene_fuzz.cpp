// Scenes without the files that they may name: TOML, keys, ranges, and the shapes that keys make.
#include <cstdlib>

#include "runtime/tracer/scene.h"
#include "tests/fuzz/sound_mesh.h"
#include "tests/fuzz/support.h"

namespace {

using namespace sunbeam;

void check_scene(const Scene& scene) {
  if (!test::is_finite(scene.camera.position)) std::abort();
  for (const SceneObject& object : scene.objects) {
    if (static_cast<std::size_t>(object.material) >= scene.materials.size()) std::abort();
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape)) test::require_sound({*mesh, 0});
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return test::fuzz(data, size, [](const std::string& bytes) {
    if (bytes.find("file") == std::string::npos) check_scene(read_scene(ConfigTable::parse(bytes, "s")));
  });
}
