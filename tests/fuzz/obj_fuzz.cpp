// OBJ: lines, numbers, indices and polygons.
#include "runtime/tracer/obj.h"
#include "tests/fuzz/sound_mesh.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) { test::require_sound(parse_obj(bytes, "m")); });
}
