// What tests of pictures share: EXR files of every kind that other programs write, as bytes.
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfTiledOutputPart.h>

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sunbeam {

// The value of a channel at pixel (x, y) of the data window, which counts from its own corner.
using ChannelValue = std::function<float(int x, int y)>;

struct ExrPart {
  int width = 4, height = 3;  // of the data window
  std::map<std::string, ChannelValue> channels;
  Imath::V2i corner{0, 0};  // of the data window
  Imath::Box2i display{};   // the data window if it is empty
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  Imf::PixelType type = Imf::FLOAT;
  bool is_tiled = false;  // of 16 x 16 pixels, with mip levels
  std::function<void(Imf::Header&)> edit = [](Imf::Header&) {};

  Imf::Header header(int index) const {
    const Imath::Box2i data(corner, corner + Imath::V2i(width - 1, height - 1));
    Imf::Header header(display.isEmpty() ? data : display, data);
    header.compression() = compression;
    header.setName("part " + std::to_string(index));
    header.setType(is_tiled ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    if (is_tiled) header.setTileDescription(Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS));
    for (const auto& [name, value] : channels) header.channels().insert(name, Imf::Channel(type));
    edit(header);
    return header;
  }
};

// Writes values as floats, halfs or whole numbers. Further mip levels hold -1.
inline void write_part(Imf::MultiPartOutputFile& file, int index, const ExrPart& part) {
  const auto pixels = static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height);
  std::vector<std::vector<char>> storage;
  const auto buffer_of = [&](bool is_whole) {
    Imf::FrameBuffer buffer;
    for (const auto& [name, value] : part.channels) {
      const int size = part.type == Imf::HALF ? 2 : 4;
      storage.emplace_back(pixels * static_cast<std::size_t>(size));
      char* at = storage.back().data();
      for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x, at += size) {
          const float v = is_whole ? value(x, y) : -1;
          if (part.type == Imf::HALF) *reinterpret_cast<half*>(at) = half(v);
          if (part.type == Imf::FLOAT) *reinterpret_cast<float*>(at) = v;
          if (part.type == Imf::UINT)
            *reinterpret_cast<unsigned*>(at) = static_cast<unsigned>(std::max(v, 0.0f));
        }
      char* origin = storage.back().data() - static_cast<std::ptrdiff_t>(size) *
                                                 (part.corner.x + std::ptrdiff_t{part.width} * part.corner.y);
      buffer.insert(name, Imf::Slice(part.type, origin, static_cast<std::size_t>(size),
                                     static_cast<std::size_t>(size) * static_cast<std::size_t>(part.width)));
    }
    return buffer;
  };
  if (!part.is_tiled) {
    Imf::OutputPart out(file, index);
    out.setFrameBuffer(buffer_of(true));
    out.writePixels(part.height);
    return;
  }
  Imf::TiledOutputPart out(file, index);
  for (int level = 0; level < out.numLevels(); ++level) {
    out.setFrameBuffer(buffer_of(level == 0));
    out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
  }
}

inline std::string exr_file(const std::vector<ExrPart>& parts) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts) headers.push_back(part.header(static_cast<int>(headers.size())));
  Imf::StdOSStream stream;
  {
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
    for (std::size_t k = 0; k < parts.size(); ++k) write_part(file, static_cast<int>(k), parts[k]);
  }  // the table of offsets is written at the end
  return stream.str();
}

inline ChannelValue constant(float value) {
  return [=](int, int) { return value; };
}

// One part with R, G and B.
inline ExrPart rgb_part(int width, int height, const ChannelValue& r, const ChannelValue& g,
                        const ChannelValue& b) {
  ExrPart part;
  part.width = width;
  part.height = height;
  part.channels = {{"R", r}, {"G", g}, {"B", b}};
  return part;
}

inline ExrPart grey_part(int width, int height, float value) {
  return rgb_part(width, height, constant(value), constant(value), constant(value));
}

// Overwrites the rows of a window: what a damaged or hostile header may claim.
inline std::string with_rows(std::string bytes, const std::string& attribute, int first, int last) {
  const std::string head = attribute + std::string("\0box2i\0\x10\0\0\0", 11);
  const std::size_t at = bytes.find(head) + head.size();
  for (std::size_t k = 0; k < 4; ++k) {
    bytes[at + 4 + k] = static_cast<char>(first >> 8 * k);
    bytes[at + 12 + k] = static_cast<char>(last >> 8 * k);
  }
  return bytes;
}

// The most rows that OpenEXR takes for sound, 2147483644.
inline std::string with_most_rows(const std::string& bytes, const std::string& attribute) {
  return with_rows(bytes, attribute, -1073741822, 1073741821);
}

}  // namespace sunbeam
