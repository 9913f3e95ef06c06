#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/json_text.h"
#include "bake/cli/separate_files.h"
#include "bake/compare/difference.h"
#include "bake/compare/false_color.h"
#include "bake/compare/flip.h"
#include "bake/compare/rendering.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

using Json = nlohmann::ordered_json;

struct Comparison {
  Difference difference;
  double flip = 0;  // mean over the picture
};

double largest(const Rgb& color) {
  return max_component(transform(color, [](double c) { return std::abs(c); }));
}

struct Limit {
  const char* option;
  std::optional<double> most;
  double value;

  bool is_exceeded() const { return most && !(value <= *most); }
};

std::vector<Limit> limits_of(const CompareOptions& options, const Comparison& comparison) {
  const Difference& d = comparison.difference;
  return {{"--max-rmse", options.max_rmse, d.rmse},
          {"--max-relmse", options.max_relmse, d.rel_mse},
          {"--max-flip", options.max_flip, comparison.flip},
          {"--max-bias", options.max_bias, largest(d.bias)},
          {"--max-bias-z", options.max_bias_z, d.noise ? largest(d.noise->bias_z) : 0}};
}

Json to_json(const Rgb& color) { return {color.r, color.g, color.b}; }

Json to_json(const ZCount& z) { return {{"tested", z.tested}, {"beyond", z.beyond}, {"share", z.share()}}; }

Json to_json(const CompareOptions& options, const Comparison& comparison) {
  const Difference& d = comparison.difference;
  Json json = {{"rmse", d.rmse},
               {"relmse", d.rel_mse},
               {"relmse_epsilon", kRelativeMseEpsilon},
               {"flip", comparison.flip},
               {"pixels_per_degree", options.pixels_per_degree},
               {"bias", to_json(d.bias)},
               {"reference_mean", to_json(d.reference_mean)}};
  if (d.noise) {
    json["bias_ci95"] = to_json(kZ95 * d.noise->bias_error);
    json["bias_z"] = to_json(d.noise->bias_z);
    json["beyond_3_sigma"] = {{"expected_share", expected_share_beyond()},
                              {"pixels", to_json(d.noise->pixels)},
                              {"blocks", to_json(d.noise->blocks)}};
  }
  json["exceeded"] = Json::array();
  for (const Limit& limit : limits_of(options, comparison))
    if (limit.is_exceeded()) json["exceeded"].push_back(limit.option);
  return json;
}

void print_noise(const NoiseTest& noise) {
  const auto print_share = [](const std::string& name, const ZCount& z) {
    out("{:<20}{:.4g} % of {} values beyond {:g} sigma; noise alone: {:.2g} %\n", name, 100 * z.share(),
        z.tested, kZLimit, 100 * expected_share_beyond());
  };
  print_share("pixels", noise.pixels);
  print_share(fmt::format("blocks of {0} x {0}", kBlockSize), noise.blocks);
}

void print_text(const CompareOptions& options, const Comparison& comparison) {
  const Difference& d = comparison.difference;
  out("{:<20}{:.6g}\n", "rmse", d.rmse);
  out("{:<20}{:.6g}   mean of (A - B)^2 / (B^2 + {:g})\n", "relmse", d.rel_mse, kRelativeMseEpsilon);
  out("{:<20}{:.6g}   mean, {:g} pixels a degree\n", "flip", comparison.flip, options.pixels_per_degree);
  for (int channel = 0; channel < 3; ++channel) {
    out("{:<20}{:.6g}", fmt::format("bias {}", "RGB"[channel]), d.bias[channel]);
    if (d.noise)
      out(" +- {:.3g} (95 %), {:.2f} sigma", kZ95 * d.noise->bias_error[channel], d.noise->bias_z[channel]);
    out("   mean of B {:.6g}\n", d.reference_mean[channel]);
  }
  if (d.noise) print_noise(*d.noise);
}

void check_options(const CompareOptions& options) {
  if (options.png.empty()) return;
  if (extension(options.png) != ".png")
    throw Error(
        fmt::format("{}: extension is '{}'; allowed for --png: .png", options.png, extension(options.png)));
  require_writable(options.png);
}

// Without variance there is no telling noise from bias.
void note_missing_variance(const CompareOptions& options, const ExrImage& test, const ExrImage& reference) {
  const std::string path = test.variance.empty()        ? options.test
                           : reference.variance.empty() ? options.reference
                                                        : "";
  if (path.empty()) return;
  const std::string what = path + ": no channels variance.R, variance.G and variance.B";
  if (options.max_bias_z) throw Error(what + ", which --max-bias-z needs");
  message("note: {}; hence no confidence interval and no test against noise", what);
}

// A PNG holds what a display shows already.
Image shown(const Rendering& rendering) {
  return rendering.is_displayed ? rendering.picture.mean : displayed(rendering.picture.mean);
}

Rendering read_noted(const std::string& path) {
  Rendering rendering = read_rendering(path);
  if (!rendering.note.empty()) message("note: {}", rendering.note);
  return rendering;
}

}  // namespace

int run_compare(const CompareOptions& options) {
  check_options(options);
  require_separate({options.test, options.reference}, {options.png});
  const Rendering a = read_noted(options.test), b = read_noted(options.reference);
  const ExrImage &test = a.picture, &reference = b.picture;
  Comparison comparison;
  try {
    comparison.difference = difference(test, reference);
  } catch (const Error& error) {
    throw Error(fmt::format("{} and {}: {}", options.test, options.reference, error.what()));
  }
  note_missing_variance(options, test, reference);
  const std::vector<double> map = flip(shown(a), shown(b), options.pixels_per_degree);
  comparison.flip = std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());

  if (!options.png.empty())
    write_file_atomically(options.png, magma_png(map, test.mean.width, test.mean.height));
  if (options.json)
    out("{}\n", json_text(to_json(options, comparison)));
  else
    print_text(options, comparison);
  if (!options.png.empty()) message("{}: FLIP of every pixel; black 0, pale yellow 1", options.png);

  int exit_code = 0;
  for (const Limit& limit : limits_of(options, comparison))
    if (limit.is_exceeded()) {
      message("FAIL: {:.6g} is above {} {:g}", limit.value, limit.option, *limit.most);
      exit_code = 1;
    }
  return exit_code;
}

}  // namespace sunbeam
