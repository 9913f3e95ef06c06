// glTF and GLB: JSON, accessors, skins, morph targets. No buffer is read from a file, for there is no such
// folder.
#include "runtime/tracer/gltf.h"
#include "tests/fuzz/sound_mesh.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) {
    test::require_sound(parse_gltf(bytes, "m", {"/nowhere"}));
  });
}
