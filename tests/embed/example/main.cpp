// Loads a table, binds it to the parameters it was baked for, in Rec.709, evaluates and samples it once.
#include <sunbeam/table_bsdf.h>
#include <sunbeam/table_io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace sunbeam;
  if (argc != 2) return std::puts("usage: example TABLE.exr"), 2;
  const Result<Table> table = try_load_table_exr(argv[1]);
  if (!table) return std::fprintf(stderr, "example: %s\n", table.error().c_str()), 1;
  const TableBsdf skin = table->bind(Parameters::of(table->material), {.color_space = ColorSpace::rec709});
  const Vec3 viewer = direction_from_cosine(0.8, 0), light = direction_from_cosine(0.6, kPi);  // mirror side
  const Rgb f = skin.eval(viewer, light);
  std::printf("eval %.17g %.17g %.17g\npdf %.17g\n", f.r, f.g, f.b, skin.pdf(viewer, light));
  if (const auto sample = skin.sample(viewer, {0.3, 0.6, 0.1}))
    std::printf("sample %.17g %.17g %.17g\n", sample->wi.x, sample->wi.y, sample->wi.z);
}
