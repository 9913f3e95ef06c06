// What tests of pictures share: PNG files of every kind, as bytes.
#pragma once

#include <png.h>

#include <functional>
#include <string>
#include <vector>

namespace sunbeam {

struct PngFile {
  int width = 4, height = 3;
  int bits = 8;
  int color_type = PNG_COLOR_TYPE_GRAY;
  bool is_interlaced = false;
  // Packed rows as the file has them; 16 bits with the high byte first.
  std::vector<std::vector<png_byte>> rows;
  std::function<void(png_structp, png_infop)> edit = [](png_structp, png_infop) {};

  std::string bytes() const {
    std::string result;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    const auto append = [](png_structp p, png_bytep data, std::size_t size) {
      static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), size);
    };
    png_set_write_fn(png, &result, append, nullptr);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits,
                 color_type, is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    edit(png, info);
    png_write_info(png, info);
    const int passes = png_set_interlace_handling(png);
    for (int pass = 0; pass < passes; ++pass)
      for (const auto& row : rows) png_write_row(png, row.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return result;
  }
};

// All pixels are the numbers of `pixel`.
inline PngFile even_png(int bits, int color_type, const std::vector<png_byte>& pixel, int width = 4,
                        int height = 3) {
  PngFile file{.width = width, .height = height, .bits = bits, .color_type = color_type, .rows = {}};
  std::vector<png_byte> row;
  for (int x = 0; x < width; ++x) row.insert(row.end(), pixel.begin(), pixel.end());
  file.rows.assign(static_cast<std::size_t>(height), row);
  return file;
}

}  // namespace sunbeam
