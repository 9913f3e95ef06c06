// PLY: headers, numbers in text and binary, faces and strips.
#include "runtime/tracer/ply.h"
#include "tests/fuzz/sound_mesh.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) { test::require_sound(parse_ply(bytes, "m")); });
}
