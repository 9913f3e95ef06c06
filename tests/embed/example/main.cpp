// Loads a table, binds it to the parameters it was baked for, evaluates and samples it once.
#include <sunbeam/core/error.h>
#include <sunbeam/table_bsdf.h>
#include <sunbeam/table_io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace sunbeam;
  if (argc != 2) return std::puts("usage: example TABLE.exr"), 2;
  try {
    const Table table = load_table_exr(argv[1]);
    const TableBsdf skin(table, Parameters::of(table.material), {.outside = OutsideGrid::clamp});
    Rng rng(1, 0);
    const Vec3 viewer = direction_from_cosine(0.8, 0),
               light = direction_from_cosine(0.6, kPi);  // mirror side
    const Rgb f = skin.eval(viewer, light, rng);
    std::printf("eval %.17g %.17g %.17g\npdf %.17g\n", f.r, f.g, f.b, skin.pdf(viewer, light, rng));
    if (const auto sample = skin.sample(viewer, rng))
      std::printf("sample %.17g %.17g %.17g\n", sample->wi.x, sample->wi.y, sample->wi.z);
  } catch (const Error& error) {
    return std::fprintf(stderr, "example: %s\n", error.what()), 1;
  }
}
