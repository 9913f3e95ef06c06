#include "sunbeam/detail/exr_headers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "runtime/src/exr/exr_attributes.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kTiled = 0x200, kLongNames = 0x400, kDeep = 0x800, kManyParts = 0x1000;
constexpr std::size_t kMostParts = 4096, kMostChannels = 4096;
constexpr std::size_t kMostAttributes = 1 << 16;      // of all parts
constexpr std::size_t kLargestHeaders = 1 << 25;      // bytes; the library copies headers several times
constexpr std::int32_t kLargestCoordinate = 1 << 30;  // as the library has it, near enough

constexpr double kBuffers = 4;   // of a chunk: packed, unpacked, and between them
constexpr double kEntry = 2000;  // bytes of an attribute or channel in the library's copies of a header

// Holds how many rows a method packs into one chunk, and an upper bound of the bytes that one byte of a file
// unpacks to. A byte of zlib gives 1032 at most; DWA packs runs of zeros before that.
struct Compression {
  std::uint64_t rows;
  double most_unpacked;
};
constexpr std::array<Compression, 10> kCompressions = {{{1, 1},         // none
                                                        {1, 64},        // RLE
                                                        {1, 1032},      // ZIPS
                                                        {16, 1032},     // ZIP
                                                        {32, 512},      // PIZ: runs of 256 values in 9 bits
                                                        {16, 1376},     // PXR24: zlib, 3 bytes of 4
                                                        {32, 11},       // B44
                                                        {32, 11},       // B44A: 16 halves in 3 bytes
                                                        {32, 1 << 17},  // DWAA
                                                        {256, 1 << 17}}};  // DWAB

struct Window {
  std::uint64_t width, height;
};

struct Channel {
  std::uint64_t bytes, x_sampling, y_sampling;
};

struct Tiles {
  std::uint64_t width, height;
  unsigned mode;  // 0 one level, 1 mip levels, 2 rip levels
  bool rounds_up;
};

const std::string_view* find(const ExrAttributes& attributes, const char* name, const char* type) {
  const auto at = attributes.find(name);
  if (at == attributes.end()) return nullptr;
  if (at->second.type != type)
    throw Error(std::string("attribute '") + name + "' has type '" + printable(at->second.type) +
                "'; allowed: " + type);
  return &at->second.value;
}

ExrBytes require(const ExrAttributes& attributes, const char* name, const char* type) {
  const auto* value = find(attributes, name, type);
  if (!value) throw Error(std::string("attribute '") + name + "' is missing");
  return ExrBytes(*value);
}

Window read_window(const ExrAttributes& attributes, const char* name) {
  ExrBytes bytes = require(attributes, name, "box2i");
  std::array<std::int32_t, 4> corner{};  // x0, y0, x1, y1
  for (auto& coordinate : corner) coordinate = bytes.number<std::int32_t>();
  const bool is_sane = std::ranges::all_of(
      corner, [](std::int32_t c) { return c > -kLargestCoordinate && c < kLargestCoordinate; });
  if (!is_sane || corner[0] > corner[2] || corner[1] > corner[3])
    throw Error(std::string("attribute '") + name + "' runs from " + std::to_string(corner[0]) + ", " +
                std::to_string(corner[1]) + " to " + std::to_string(corner[2]) + ", " +
                std::to_string(corner[3]) + ", which is no window");
  return {static_cast<std::uint64_t>(corner[2] - corner[0]) + 1,
          static_cast<std::uint64_t>(corner[3] - corner[1]) + 1};
}

Channel read_channel(ExrBytes& bytes) {
  const auto type = bytes.number<std::uint32_t>();
  bytes.take(4);  // pLinear and reserved bytes
  const auto x_sampling = bytes.number<std::int32_t>(), y_sampling = bytes.number<std::int32_t>();
  if (type > 2) throw Error("a channel has pixel type " + std::to_string(type) + "; allowed: 0 to 2");
  if (x_sampling < 1 || y_sampling < 1) throw Error("a channel has a sampling below 1");
  return {type == 1 ? 2u : 4u, static_cast<std::uint64_t>(x_sampling),
          static_cast<std::uint64_t>(y_sampling)};
}

std::vector<Channel> read_channels(const ExrAttributes& attributes) {
  ExrBytes bytes = require(attributes, "channels", "chlist");
  std::vector<Channel> channels;
  while (!bytes.name().empty()) {
    channels.push_back(read_channel(bytes));
    if (channels.size() > kMostChannels)
      throw Error("a part has more than " + std::to_string(kMostChannels) + " channels");
  }
  if (channels.empty() || bytes.left() > 0) throw Error("attribute 'channels' is not a list of channels");
  return channels;
}

Compression read_compression(const ExrAttributes& attributes) {
  const auto number = require(attributes, "compression", "compression").number<std::uint8_t>();
  if (number >= kCompressions.size())
    throw Error("compression is " + std::to_string(number) + "; allowed: 0 to 9");
  return kCompressions[number];
}

Tiles read_tiles(const ExrAttributes& attributes) {
  ExrBytes bytes = require(attributes, "tiles", "tiledesc");
  const auto width = bytes.number<std::uint32_t>(), height = bytes.number<std::uint32_t>();
  const auto mode = bytes.number<std::uint8_t>();
  constexpr std::uint32_t kLargestTile = 1 << 30;
  if (width < 1 || height < 1 || width > kLargestTile || height > kLargestTile)
    throw Error("tiles have " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  if ((mode & 15) > 2 || (mode >> 4) > 1) throw Error("attribute 'tiles' has an unknown mode");
  return {width, height, mode & 15u, (mode >> 4) == 1};
}

// The tiles along one side of each level.
std::vector<std::uint64_t> tiles_of_levels(std::uint64_t size, std::uint64_t levels_of, std::uint64_t tile,
                                           const Tiles& tiles) {
  const auto round = [&](std::uint64_t value, unsigned shift) {
    const std::uint64_t up = tiles.rounds_up ? (std::uint64_t{1} << shift) - 1 : 0;
    return std::max<std::uint64_t>(1, (value + up) >> shift);
  };
  std::vector<std::uint64_t> counts;
  for (unsigned level = 0;; ++level) {
    counts.push_back((round(size, level) + tile - 1) / tile);
    if (tiles.mode == 0 || round(levels_of, level) == 1) return counts;
  }
}

double count_tiles(const Window& window, const Tiles& tiles) {
  const std::uint64_t longest = std::max(window.width, window.height);
  const bool is_rip = tiles.mode == 2;
  const auto across = tiles_of_levels(window.width, is_rip ? window.width : longest, tiles.width, tiles);
  const auto down = tiles_of_levels(window.height, is_rip ? window.height : longest, tiles.height, tiles);
  double count = 0;
  for (std::size_t x = 0; x < across.size(); ++x)
    for (std::size_t y = 0; y < down.size(); ++y)
      if (is_rip || x == y) count += static_cast<double>(across[x]) * static_cast<double>(down[y]);
  return count;
}

// What parts take, in bytes; sums of products of the file's numbers pass the range of integers.
struct Need {
  double least_in_file = 0, chunks = 0, memory = 0;
};

bool is_tiled(const ExrAttributes& attributes, std::uint32_t flags) {
  const auto* type = find(attributes, "type", "string");
  if (type && type->starts_with("deep")) throw Error("holds deep pixels, which are not read");
  if (!(flags & kManyParts)) return flags & kTiled;
  if (!type || !find(attributes, "name", "string"))
    throw Error("one of several parts has no name or no type");
  if (*type != "scanlineimage" && *type != "tiledimage")
    throw Error("has type '" + printable(*type) + "'; allowed: scanlineimage, tiledimage");
  return *type == "tiledimage";
}

// Adds what the library needs beside the pixels.
void add_scan_lines(const Window& window, const Compression& compression, double pixel, Need& need) {
  constexpr double kTablesOfRow = 24;  // bytes of a row in the library's tables
  const auto width = static_cast<double>(window.width), height = static_cast<double>(window.height);
  need.chunks = static_cast<double>((window.height + compression.rows - 1) / compression.rows);
  need.memory += kBuffers * pixel * width * static_cast<double>(compression.rows) + kTablesOfRow * height;
}

void add_tiles(const Window& window, const Tiles& tiles, double pixel, Need& need) {
  need.chunks = count_tiles(window, tiles);
  need.memory += kBuffers * pixel * static_cast<double>(std::max(window.width, tiles.width)) *
                 static_cast<double>(tiles.height);
}

void check_chunk_count(const ExrAttributes& attributes, double expected) {
  const auto* value = find(attributes, "chunkCount", "int");
  if (!value) return;
  const auto found = ExrBytes(*value).number<std::int32_t>();
  if (found != expected)
    throw Error("attribute 'chunkCount' is " + std::to_string(found) + "; its windows give " +
                to_text(expected));
}

Need need_of(const ExrAttributes& attributes, std::uint32_t flags) {
  const Window window = read_window(attributes, "dataWindow");
  read_window(attributes, "displayWindow");
  const Compression compression = read_compression(attributes);
  const std::vector<Channel> channels = read_channels(attributes);
  const double pixels = static_cast<double>(window.width) * static_cast<double>(window.height);
  double pixel = 0, unpacked = 0;
  for (const Channel& channel : channels) {
    pixel += static_cast<double>(channel.bytes);
    unpacked += static_cast<double>(channel.bytes * (window.width / channel.x_sampling)) *
                static_cast<double>(window.height / channel.y_sampling);
  }
  const auto entries = static_cast<double>(channels.size() + attributes.size());
  Need need{unpacked / compression.most_unpacked, 0,
            sizeof(float) * pixels * static_cast<double>(channels.size()) + kEntry * entries};
  if (is_tiled(attributes, flags))
    add_tiles(window, read_tiles(attributes), pixel, need);
  else
    add_scan_lines(window, compression, pixel, need);
  check_chunk_count(attributes, need.chunks);
  return need;
}

Need need_of_part(const std::vector<ExrAttributes>& parts, std::size_t part, std::uint32_t flags) {
  try {
    return need_of(parts[part], flags);
  } catch (const Error& error) {
    throw Error("part " + std::to_string(part) + ": " + error.what());
  }
}

std::vector<ExrAttributes> read_headers(ExrBytes& bytes, std::uint32_t flags) {
  std::vector<ExrAttributes> parts;
  std::size_t attributes = 0;
  const std::size_t size = bytes.left();
  do {
    parts.push_back(read_exr_attributes(bytes));
    attributes += parts.back().size();
    if (parts.size() > kMostParts || attributes > kMostAttributes || size - bytes.left() > kLargestHeaders)
      throw Error("its headers are too large; allowed: " + std::to_string(kMostParts) + " parts, " +
                  std::to_string(kMostAttributes) + " attributes, " + std::to_string(kLargestHeaders) +
                  " bytes");
  } while ((flags & kManyParts) && !parts.back().empty());
  if (flags & kManyParts) parts.pop_back();
  if (parts.empty()) throw Error("it has no header");
  return parts;
}

void check(std::string_view file) {
  ExrBytes bytes(file);
  if (bytes.number<std::uint32_t>() != kMagic) throw Error("it does not begin as one");
  const auto version = bytes.number<std::uint32_t>(), flags = version & ~255u;
  if ((version & 255u) != 2 || (flags & ~(kTiled | kLongNames | kDeep | kManyParts)))
    throw Error("its version is " + std::to_string(version & 255u) + " with flags " +
                std::to_string(flags >> 8) + "; allowed: version 2 with flags 0 to 31");
  if (flags & kDeep) throw Error("it holds deep pixels, which are not read");
  if ((flags & kTiled) && (flags & kManyParts)) throw Error("it is tiled and has many parts");
  const std::vector<ExrAttributes> parts = read_headers(bytes, flags);
  Need sum;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Need need = need_of_part(parts, k, flags);
    sum.least_in_file += need.least_in_file;
    sum.chunks += need.chunks;
    sum.memory += need.memory;
  }
  constexpr double kOffset = 8;  // bytes of a chunk in the table of them
  if (sum.chunks * kOffset + sum.least_in_file > static_cast<double>(bytes.left()))
    throw Error("its data windows ask for " + to_text(sum.chunks) + " chunks and at least " +
                to_text(std::ceil(sum.least_in_file)) + " bytes of pixels; the file has " +
                std::to_string(bytes.left()) + " bytes for both");
  constexpr double kMost = 1e18;
  require_within_read_limit("reading its pixels", static_cast<std::uint64_t>(std::min(sum.memory, kMost)),
                            file.size());
}

}  // namespace

void check_exr_headers(std::string_view bytes, const std::string& name) {
  try {
    check(bytes);
  } catch (const Error& error) {
    throw Error(name + ": not a usable OpenEXR file: " + error.what());
  }
}

}  // namespace v1
}  // namespace sunbeam
