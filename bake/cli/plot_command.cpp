#include <fmt/format.h>

#include <memory>

#include "bake/cli/commands.h"
#include "bake/cli/separate_files.h"
#include "bake/recipe/recipe.h"
#include "bake/report/chart.h"
#include "bake/report/polar_chart.h"
#include "bake/report/reflectance_chart.h"
#include "bake/report/slice.h"
#include "bake/report/sphere.h"
#include "runtime/tracer/image_io.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

constexpr int kSpherePixels = 512, kSliceHeight = 256;
constexpr double kDefaultThetaI = 30, kLargestThetaI = 89;

void check_extension(const PlotOptions& options) {
  const bool is_image = options.what == "slice" || options.what == "sphere";
  const std::string allowed = is_image ? ".png" : ".svg", found = extension(options.output);
  if (found != allowed)
    throw Error(fmt::format("{}: extension is '{}'; allowed for --what {}: {}", options.output, found,
                            options.what, allowed));
}

double theta_i_deg(const PlotOptions& options) {
  if (options.theta_i_deg && options.what != "polar")
    throw Error(fmt::format("--theta-i: found with --what {}; allowed with --what polar", options.what));
  const double degrees = options.theta_i_deg.value_or(kDefaultThetaI);
  if (!(degrees >= 0 && degrees <= kLargestThetaI))
    throw Error(fmt::format("--theta-i: found {:g}; allowed: 0 to {:g}", degrees, kLargestThetaI));
  return degrees;
}

Parameters parameters_of(const PlotOptions& options, const Material& material) {
  return {options.film_thickness_nm.value_or(material.film_thickness_nm),
          options.base_ior.value_or(material.base_ior),
          options.absorption_per_nm.value_or(material.absorption_per_nm)};
}

std::string polar_file(const Table& table, const TableAppearance& skin, double degrees) {
  const Recipe recipe = parse_stored_recipe(table.info.at("recipe"), "recipe of the table");
  const LiveAppearance live(skin.material(), recipe.spectrum, kCurveEstimates);
  const Vec3 wi = spherical_direction(degrees * kPi / 180, 0);
  return svg_document(kPolarWidth, kPolarHeight, fmt::format("BRDF times cosine, theta_i {:g}", degrees),
                      polar_chart(skin, live, wi));
}

std::string reflectance_file(const Table& table, const Parameters& parameters) {
  return svg_document(kReflectanceWidth, kReflectanceHeight, "Film reflectance",
                      reflectance_chart(table, parameters));
}

// Scaled so that the brightest value is 1.
Image slice_file(const TableAppearance& skin) {
  const Image image = slice_image(skin, kSliceHeight);
  const double peak = brightest(image);
  return peak > 0 ? scaled(image, 1 / peak) : image;
}

std::unique_ptr<TableAppearance> bind(const Table& table, const Parameters& parameters,
                                      const std::string& path) {
  try {
    return std::make_unique<TableAppearance>(table, parameters, OutsideGrid::refuse);
  } catch (const Error& error) {
    throw Error(path + ": " + error.what());
  }
}

}  // namespace

int run_plot(const PlotOptions& options) {
  check_extension(options);
  const double degrees = theta_i_deg(options);
  require_separate({options.table}, {options.output});
  const Table table = load_table(options.table);
  const Parameters parameters = parameters_of(options, table.material);
  const auto skin = bind(table, parameters, options.table);
  require_writable(options.output);
  if (options.what == "polar")
    write_file_atomically(options.output, polar_file(table, *skin, degrees));
  else if (options.what == "reflectance")
    write_file_atomically(options.output, reflectance_file(table, parameters));
  else
    write_png(options.output,
              options.what == "slice" ? slice_file(*skin) : sphere_image(*skin, kSpherePixels));
  return 0;
}

}  // namespace sunbeam
