// Pictures of a scene, its skins from a table or live by PFMC, and how far apart two of them are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "bake/live/live_bsdf.h"
#include "bake/recipe/recipe.h"
#include "runtime/tracer/gloss.h"
#include "runtime/tracer/lambert.h"
#include "runtime/tracer/render.h"
#include "runtime/tracer/scene.h"
#include "sunbeam/color_converted_bsdf.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam::test {

// A BSDF `factor` times as bright, sampled as before.
class BrighterBsdf final : public Bsdf {
 public:
  BrighterBsdf(std::unique_ptr<const Bsdf> bsdf, double factor) : bsdf_(std::move(bsdf)), factor_(factor) {}
  Rgb eval(const Vec3& wo, const Vec3& wi, Rng& rng) const override {
    return factor_ * bsdf_->eval(wo, wi, rng);
  }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    auto sample = bsdf_->sample(wo, rng);
    if (sample) sample->throughput = factor_ * sample->throughput;
    return sample;
  }
  double pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const override { return bsdf_->pdf(wo, wi, rng); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override { return bsdf_->mis_pdf(wo, wi); }

 private:
  std::unique_ptr<const Bsdf> bsdf_;
  double factor_;
};

struct Skins {
  const Table& table;     // live skins take its material and spectrum
  bool live = false;      // else from the table
  double brightness = 1;  // 1: as they are
};

inline Material own_material(const SceneMaterial& skin, const Material& material) {
  auto values = Parameters::of(material).values();
  for (std::size_t k = 0; k < values.size(); ++k)
    if (skin.parameters[k]) values[k] = skin.parameters[k]->from;
  return Parameters{values[0], values[1], values[2]}.applied_to(material);
}

inline std::unique_ptr<const Bsdf> skin_bsdf(const SceneMaterial& scene_material, const Skins& skins) {
  const Material material = own_material(scene_material, skins.table.material);
  const ColorMatrix to_rec709 = rgb_to_rgb(skins.table.color_space(), ColorSpace::rec709);
  std::unique_ptr<const Bsdf> bsdf;
  if (skins.live) {
    const Spectrum spectrum = parse_stored_recipe(skins.table.info.at("recipe"), "recipe").spectrum;
    bsdf = std::make_unique<ColorConvertedBsdf<LiveBsdf>>(LiveBsdf(material, spectrum.wavelengths(material)),
                                                          to_rec709);
  } else {
    bsdf = std::make_unique<ColorConvertedBsdf<TableBsdf>>(TableBsdf(skins.table, Parameters::of(material)),
                                                           to_rec709);
  }
  if (skins.brightness != 1) bsdf = std::make_unique<BrighterBsdf>(std::move(bsdf), skins.brightness);
  return bsdf;
}

inline RenderResult render_scene(const Scene& scene, const Skins& skins, const RenderSettings& settings) {
  std::vector<std::unique_ptr<const Bsdf>> owned;
  std::vector<SurfaceBsdf> bsdfs;
  for (const SceneMaterial& m : scene.materials) {
    if (m.type == SceneMaterial::Type::diffuse)
      owned.push_back(std::make_unique<Lambert>(m.albedo));
    else if (m.type == SceneMaterial::Type::gloss)
      owned.push_back(std::make_unique<Gloss>(m.ior, m.roughness));
    else
      owned.push_back(skin_bsdf(m, skins));
    bsdfs.push_back(owned.back().get());
  }
  return render(scene, bsdfs, settings);
}

// Means of blocks of pixels are close to normal, whatever one pixel's distribution is.
struct Block {
  double mean = 0, variance = 0;  // of the block's mean
  double variance_error = 0;      // standard error of `variance`, from how it differs between pixels; too
                                  // large rather than too small, since pixels truly differ
};

// Column by column within rows; the picture must be a whole number of blocks.
inline std::vector<Block> blocks(const RenderResult& picture, int channel, int width, int height) {
  std::vector<Block> result;
  const double pixels = width * height;
  for (int y = 0; y < picture.mean.height; y += height)
    for (int x = 0; x < picture.mean.width; x += width) {
      Block block;
      double squares = 0;
      for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
          const double variance = picture.variance.get(x + i, y + j)[channel];
          block.mean += picture.mean.get(x + i, y + j)[channel] / pixels;
          block.variance += variance / (pixels * pixels);
          squares += variance * variance;
        }
      const double mean_variance = block.variance * pixels;
      block.variance_error =
          std::sqrt(std::max(0.0, squares - pixels * mean_variance * mean_variance)) / (pixels * pixels);
      result.push_back(block);
    }
  return result;
}

// Largest |z| of the differences of all blocks' means in all channels, allowing a systematic difference of
// `tolerance` of the value.
inline double largest_z(const RenderResult& a, const RenderResult& b, int width, int height,
                        double tolerance = 0) {
  double largest = 0;
  for (int channel = 0; channel < 3; ++channel) {
    const auto block_a = blocks(a, channel, width, height), block_b = blocks(b, channel, width, height);
    for (std::size_t k = 0; k < block_a.size(); ++k) {
      const double difference = std::abs(block_a[k].mean - block_b[k].mean) - tolerance * block_b[k].mean;
      largest = std::max(largest, difference / std::sqrt(block_a[k].variance + block_b[k].variance));
    }
  }
  return largest;
}

// Of whole pictures, each channel: how far the mean of `a` lies over that of `b`, in standard errors.
inline std::array<double, 3> mean_z(const RenderResult& a, const RenderResult& b) {
  std::array<double, 3> z;
  for (int channel = 0; channel < 3; ++channel) {
    const Block whole_a = blocks(a, channel, a.mean.width, a.mean.height)[0];
    const Block whole_b = blocks(b, channel, b.mean.width, b.mean.height)[0];
    z[channel] = (whole_a.mean - whole_b.mean) / std::sqrt(whole_a.variance + whole_b.variance);
  }
  return z;
}

// The same of the variances of these means: above 0 where `a` is the noisier one.
inline std::array<double, 3> excess_variance_z(const RenderResult& a, const RenderResult& b) {
  std::array<double, 3> z;
  for (int channel = 0; channel < 3; ++channel) {
    const Block whole_a = blocks(a, channel, a.mean.width, a.mean.height)[0];
    const Block whole_b = blocks(b, channel, b.mean.width, b.mean.height)[0];
    z[channel] =
        (whole_a.variance - whole_b.variance) / std::hypot(whole_a.variance_error, whole_b.variance_error);
  }
  return z;
}

}  // namespace sunbeam::test
