#include "bake/report/slice.h"

#include "bake/base/parallel_tasks.h"

namespace sunbeam {

Image slice_image(const Appearance& skin, int height, int threads) {
  Image image(2 * height, height);
  const auto angle = [&](int k) { return (k + 0.5) / height * (kPi / 2); };
  std::vector<Vec3> wo;
  for (int x = 0; x < image.width; ++x) wo.push_back(spherical_direction(angle(x) - kPi / 2, kPi));
  run_parallel_tasks(static_cast<std::size_t>(height), threads, {}, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const std::vector<Rgb> values = skin.rest(spherical_direction(angle(height - 1 - y), 0), wo);
    for (int x = 0; x < image.width; ++x) image.set(x, y, kPi * values[static_cast<std::size_t>(x)]);
  });
  return image;
}

double brightest(const Image& image) { return *std::max_element(image.rgb.begin(), image.rgb.end()); }

Image scaled(Image image, double factor) {
  for (float& value : image.rgb) value *= static_cast<float>(factor);
  return image;
}

}  // namespace sunbeam
