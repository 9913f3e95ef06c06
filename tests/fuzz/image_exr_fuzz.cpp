// EXR pictures: environments, heights, what is compared, and what a render goes on from.
#include "bake/compare/rendering.h"
#include "tests/fuzz/pictures.h"
#include "tests/fuzz/support.h"

namespace {

void read_for_compare_and_resume(const std::string& bytes) {
  using namespace sunbeam;
  const ExrImage all = parse_exr(bytes, "a.exr");
  test::require_picture(all.mean);
  test::require(all.window->columns() == all.mean.width && all.window->rows() == all.mean.height);
  for (const auto& [name, values] : all.layers) test::require(3 * values.size() == all.mean.rgb.size());
  test::require_picture(parse_rendering(bytes, "a.exr").picture.mean);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  test::fuzz(data, size, read_for_compare_and_resume);
  test::fuzz(data, size,
             [](const std::string& bytes) { test::require_heights(parse_height_map(bytes, "a.exr")); });
  return test::fuzz(data, size, [](const std::string& bytes) {
    if (is_exr(bytes)) test::require_environment(parse_environment_map(bytes, "a.exr"));
  });
}
