#include <fmt/format.h>

#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "runtime/tracer/height_map.h"
#include "runtime/tracer/scales.h"
#include "runtime/tracer/snake_scales.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

ScaleLayout layout_of(const TextureOptions& options) {
  if (options.rows % 2 != 0)
    throw Error(
        fmt::format("--rows: found {}; allowed: an even number, for rows are offset in turns", options.rows));
  if (!(options.jitter >= 0 && options.jitter <= 1))
    throw Error(fmt::format("--jitter: found {:g}; allowed: 0 to 1", options.jitter));
  if (!(options.edge >= 0.02 && options.edge <= 0.5))
    throw Error(fmt::format("--edge: found {:g}; allowed: 0.02 to 0.5", options.edge));
  const bool is_voronoi = options.pattern == "voronoi", is_snake = options.pattern.starts_with("snake");
  if (is_snake && (options.columns < kMinSnakeColumns || options.columns > kMaxSnakeColumns))
    throw Error(fmt::format("--columns: found {}; allowed for the pattern of a snake: {} to {}",
                            options.columns, kMinSnakeColumns, kMaxSnakeColumns));
  return {options.columns, options.rows, is_voronoi ? options.jitter : 0, options.seed,
          options.pattern == "snake"        ? ScalePattern::snake_body
          : options.pattern == "snake_head" ? ScalePattern::snake_head
                                            : ScalePattern::grid};
}

void require_size(const TextureOptions& options, const Point2& tile) {
  constexpr double kMaxPixels = 1 << 27;
  const double pixels = tile.x * tile.y * square(options.pixels_per_scale);
  if (pixels > kMaxPixels)
    throw Error(fmt::format("--pixels-per-scale: found {}, {:.3g} pixels in all; allowed: {:.3g}",
                            options.pixels_per_scale, pixels, kMaxPixels));
}

}  // namespace

int run_texture(const TextureOptions& options) {
  const ScaleLayout layout = layout_of(options);
  require_height_map_extension(options.output);
  require_size(options, tile_size(layout));
  require_writable(options.output);
  const HeightMap map = scale_height_map(layout, options.edge, options.pixels_per_scale);
  write_height_map(options.output, map);
  const Point2 size = tile_size(layout);
  message("{}: {} x {} pixels, {:g} x {:.4f} scale widths", options.output, map.width, map.height, size.x,
          size.y);
  return 0;
}

}  // namespace sunbeam
