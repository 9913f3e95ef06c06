// Headers of OpenEXR files that must be refused before the library sees them, and files of every kind that
// pass. Headers that no library writes are put together here, byte by byte.
#include "sunbeam/detail/exr_headers.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "sunbeam/core/read_limit.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using testing::HasSubstr;

template <class T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string name(const std::string& text) { return text + '\0'; }

std::string attribute(const std::string& key, const std::string& type, const std::string& value) {
  return name(key) + name(type) + bytes_of(static_cast<int>(value.size())) + value;
}

std::string window(int x0, int y0, int x1, int y1) {
  return bytes_of(x0) + bytes_of(y0) + bytes_of(x1) + bytes_of(y1);
}

std::string channel(const std::string& key, int type = 2, int sampling = 1) {
  return name(key) + bytes_of(type) + bytes_of(0) + bytes_of(sampling) + bytes_of(sampling);
}

// The attributes of an uncompressed picture of 4 x 4 floats; a test replaces some.
struct Header {
  std::string channels = attribute("channels", "chlist", channel("Y") + '\0');
  std::string compression = attribute("compression", "compression", std::string(1, '\0'));
  std::string data_window = attribute("dataWindow", "box2i", window(0, 0, 3, 3));
  std::string display_window = attribute("displayWindow", "box2i", window(0, 0, 3, 3));
  std::string more{};

  std::string text() const { return channels + compression + data_window + display_window + more + '\0'; }
};

constexpr int kTiled = 0x200, kDeep = 0x800, kManyParts = 0x1000;

std::string file_of(const std::string& headers, int version = 2, std::size_t pixel_bytes = 4096) {
  return bytes_of(20000630) + bytes_of(version) + headers + std::string(pixel_bytes, '\0');
}

std::string error_of(const std::string& bytes) {
  return test::error_of([&] { check_exr_headers(bytes, "a.exr"); });
}
std::string error_of(const Header& header, int version = 2, std::size_t pixel_bytes = 4096) {
  return error_of(file_of(header.text(), version, pixel_bytes));
}

Header of_size(int width, int height, int compression = 0, const std::string& channels = channel("Y")) {
  Header header;
  header.data_window = attribute("dataWindow", "box2i", window(0, 0, width - 1, height - 1));
  header.compression =
      attribute("compression", "compression", std::string(1, static_cast<char>(compression)));
  header.channels = attribute("channels", "chlist", channels + '\0');
  return header;
}

std::string tiles(unsigned width, unsigned height, int mode) {
  return attribute("tiles", "tiledesc", bytes_of(width) + bytes_of(height) + static_cast<char>(mode));
}

TEST(ExrHeaders, TakesASmallPicture) { check_exr_headers(file_of(Header().text()), "a.exr"); }

TEST(ExrHeaders, FileEndsWithinTheHeader) {
  const std::string whole = file_of(Header().text(), 2, 0);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THAT(error_of(whole.substr(0, size)), HasSubstr("a.exr: not a usable OpenEXR file: ")) << size;
}

TEST(ExrHeaders, OtherFilesAndVersions) {
  EXPECT_THAT(error_of("\x89PNG\r\n\x1a\n0000"), HasSubstr("does not begin as one"));
  EXPECT_THAT(error_of(Header(), 3), HasSubstr("its version is 3 with flags 0; allowed: version 2"));
  EXPECT_THAT(error_of(Header(), 2 + 0x2000), HasSubstr("its version is 2 with flags 32"));
  EXPECT_THAT(error_of(Header(), 2 + kDeep), HasSubstr("it holds deep pixels, which are not read"));
  EXPECT_THAT(error_of(Header(), 2 + kTiled + kManyParts), HasSubstr("it is tiled and has many parts"));
}

TEST(ExrHeaders, MoreRowsThanTheFileHasRoomFor) {
  EXPECT_THAT(error_of(of_size(1, 2000000000)), HasSubstr("which is no window"));
  EXPECT_THAT(error_of(of_size(1, 1 << 29)),
              HasSubstr("its data windows ask for 536870912 chunks and at least 2147483648 bytes of pixels; "
                        "the file has 4096 bytes for both"));
  EXPECT_THAT(error_of(of_size(1, 1 << 29, 9)), HasSubstr("its data windows ask for 2097152 chunks"));
  EXPECT_EQ(error_of(of_size(1, 341), 2, 341 * 12), "");
  EXPECT_THAT(error_of(of_size(1, 341), 2, 341 * 12 - 1), HasSubstr("ask for 341 chunks"));
}

TEST(ExrHeaders, MorePixelsThanItsBytesCanUnpackTo) {
  const int zip = 3, dwab = 9;
  EXPECT_THAT(error_of(of_size(8192, 1024, zip)), HasSubstr("and at least 32514 bytes of pixels"));
  EXPECT_EQ(error_of(of_size(8192, 1024, zip), 2, 32514 + 8 * 64), "");
  EXPECT_EQ(error_of(of_size(8192, 1024, dwab)), "");
}

TEST(ExrHeaders, MorePixelsThanTheLimit) {
  const int dwab = 9;
  EXPECT_THAT(error_of(of_size(20000, 20000, dwab), 2, 20000),
              HasSubstr("reading its pixels asks for"));  // 1.6 GB, and buffers
  // A row alone is small, 256 of them are not.
  EXPECT_THAT(error_of(of_size(1 << 20, 1, dwab)), HasSubstr("reading its pixels asks for 4"));
}

TEST(ExrHeaders, PixelsOfAllPartsCount) {
  constexpr int dwab = 9;
  const auto parts = [](int count) {
    std::string headers;
    for (int part = 0; part < count; ++part) {
      Header header = of_size(8192, 4096, dwab);
      header.more = attribute("name", "string", "part" + std::to_string(part)) +
                    attribute("type", "string", "scanlineimage");
      headers += header.text();
    }
    return file_of(headers + '\0', 2 + kManyParts, 20000);
  };
  EXPECT_EQ(error_of(parts(2)), "");
  EXPECT_THAT(error_of(parts(16)), HasSubstr("reading its pixels asks for"));
}

TEST(ExrHeaders, WindowsThatAreNone) {
  for (const auto& [x0, y0, x1, y1] : std::vector<std::array<int, 4>>{
           {1, 0, 0, 0}, {0, 1, 0, 0}, {-2147483647 - 1, 0, 3, 3}, {0, 0, 3, 2147483647}}) {
    Header header;
    header.data_window = attribute("dataWindow", "box2i", window(x0, y0, x1, y1));
    EXPECT_THAT(error_of(header), HasSubstr("part 0: attribute 'dataWindow' runs from"));
    header = Header();
    header.display_window = attribute("displayWindow", "box2i", window(x0, y0, x1, y1));
    EXPECT_THAT(error_of(header), HasSubstr("part 0: attribute 'displayWindow' runs from"));
  }
}

TEST(ExrHeaders, AttributesOfAnotherSizeThanTheirType) {
  Header header;
  header.data_window = attribute("dataWindow", "box2i", std::string(4, '\0'));
  EXPECT_THAT(error_of(header), HasSubstr("attribute 'dataWindow' of type 'box2i' has 4 bytes; allowed: 16"));
  header = Header();
  header.more = attribute("p", "preview", bytes_of(1 << 15) + bytes_of(1 << 15) + "1234");
  EXPECT_THAT(error_of(header),
              HasSubstr("attribute 'p' of type 'preview' has another size than its pixels"));
  header.more = attribute("v", "stringvector", bytes_of(2000000000) + "abc");
  EXPECT_THAT(error_of(header), HasSubstr("its header ends too early"));
  header.more = attribute("v", "stringvector", bytes_of(-1) + "abc");
  EXPECT_THAT(error_of(header), HasSubstr("holds a text of negative length"));
  header.more = attribute("v", "stringvector", bytes_of(3) + "abc" + bytes_of(0));
  EXPECT_EQ(error_of(header), "");
}

// The library reads such a list up to its empty name and takes what follows for further attributes.
TEST(ExrHeaders, ListsOfChannelsThatEndElsewhere) {
  for (const std::string& value :
       {channel("Y"), channel("Y") + '\0' + "and more", std::string(), std::string("Y")}) {
    Header header;
    header.more = attribute("mine", "chlist", value);
    EXPECT_NE(error_of(header), "");
  }
  Header header;
  header.more = attribute("mine", "chlist", channel("Y") + '\0');
  EXPECT_EQ(error_of(header), "");
}

TEST(ExrHeaders, AttributesThatTheFileHasNoRoomFor) {
  for (const int size : {2000000000, -1, 5000}) {
    Header header;
    header.more = name("s") + name("string") + bytes_of(size);
    EXPECT_THAT(error_of(header), HasSubstr("attribute 's' claims " + std::to_string(size) + " bytes"));
  }
}

TEST(ExrHeaders, AttributesTwiceOrMissingOrOfAnotherType) {
  Header header;
  header.more = header.data_window;
  EXPECT_THAT(error_of(header), HasSubstr("attribute 'dataWindow' is there twice"));
  header = Header();
  header.data_window = "";
  EXPECT_THAT(error_of(header), HasSubstr("attribute 'dataWindow' is missing"));
  header.data_window = attribute("dataWindow", "string", window(0, 0, 3, 3));
  EXPECT_THAT(error_of(header), HasSubstr("attribute 'dataWindow' has type 'string'; allowed: box2i"));
}

TEST(ExrHeaders, TooManyAttributesOrChannels) {
  Header header;
  for (int k = 0; k < 5000; ++k) header.more += attribute("a" + std::to_string(k), "int", bytes_of(k));
  EXPECT_THAT(error_of(header), HasSubstr("more than 4096 attributes"));
  std::string channels;
  for (int k = 0; k < 5000; ++k) channels += channel("c" + std::to_string(k));
  EXPECT_THAT(error_of(of_size(4, 4, 0, channels), 2, 1 << 20), HasSubstr("more than 4096 channels"));
}

TEST(ExrHeaders, TooManyParts) {
  std::string headers;
  for (int k = 0; k < 5000; ++k) headers += attribute("a", "int", bytes_of(k)) + '\0';
  EXPECT_THAT(error_of(file_of(headers + '\0', 2 + kManyParts)),
              HasSubstr("its headers are too large; allowed: 4096 parts"));
}

TEST(ExrHeaders, ChannelsThatAreNone) {
  EXPECT_THAT(error_of(of_size(4, 4, 0, "")), HasSubstr("'channels' is not a list of channels"));
  EXPECT_THAT(error_of(of_size(4, 4, 0, channel("Y", 3))), HasSubstr("pixel type 3; allowed: 0 to 2"));
  EXPECT_THAT(error_of(of_size(4, 4, 0, channel("Y", 2, 0))), HasSubstr("a sampling below 1"));
  EXPECT_THAT(error_of(of_size(4, 4, 10)), HasSubstr("compression is 10; allowed: 0 to 9"));
}

TEST(ExrHeaders, TilesThatAreNone) {
  Header header;
  EXPECT_THAT(error_of(header, 2 + kTiled), HasSubstr("attribute 'tiles' is missing"));
  header.more = tiles(0, 32, 0);
  EXPECT_THAT(error_of(header, 2 + kTiled), HasSubstr("tiles have 0 x 32 pixels"));
  header.more = tiles(1u << 31, 1u << 31, 0);
  EXPECT_THAT(error_of(header, 2 + kTiled), HasSubstr("tiles have 2147483648 x 2147483648 pixels"));
  header.more = tiles(1 << 14, 1 << 14, 0);
  EXPECT_THAT(error_of(header, 2 + kTiled), HasSubstr("reading its pixels asks for"));
  header.more = tiles(32, 32, 3);
  EXPECT_THAT(error_of(header, 2 + kTiled), HasSubstr("an unknown mode"));
}

TEST(ExrHeaders, PartsThatAreNotFlat) {
  for (const char* type : {"deepscanline", "deeptile"}) {
    Header header;
    header.more = attribute("name", "string", "a") + attribute("type", "string", type);
    EXPECT_THAT(error_of(file_of(header.text() + '\0', 2 + kManyParts)), HasSubstr("holds deep pixels"));
  }
  Header header;
  header.more = attribute("name", "string", "a") + attribute("type", "string", "x\ny");
  EXPECT_THAT(error_of(file_of(header.text() + '\0', 2 + kManyParts)),
              HasSubstr("has type 'x\\ny'; allowed: scanlineimage, tiledimage"));
  EXPECT_THAT(error_of(file_of(Header().text() + '\0', 2 + kManyParts)), HasSubstr("no name or no type"));
}

TEST(ExrHeaders, ChunkCountThatIsNotThatOfItsWindow) {
  Header header;
  header.more = attribute("name", "string", "a") + attribute("type", "string", "scanlineimage") +
                attribute("chunkCount", "int", bytes_of(2000000000));
  EXPECT_THAT(error_of(file_of(header.text() + '\0', 2 + kManyParts)),
              HasSubstr("attribute 'chunkCount' is 2000000000; its windows give 4"));
}

// Pixels that are all zero pack best: so many bytes must be believed.
Imf::Header black(int width, int height, Imf::Compression compression) {
  Imf::Header header(width, height);
  header.compression() = compression;
  header.channels().insert("H", Imf::Channel(Imf::HALF));
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  return header;
}

Imf::FrameBuffer zeros(std::vector<float>& values, int width, int height) {
  values.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f);
  auto* base = reinterpret_cast<char*>(values.data());
  Imf::FrameBuffer buffer;
  buffer.insert("H", Imf::Slice(Imf::HALF, base, 2, 2 * static_cast<std::size_t>(width)));
  buffer.insert("Y", Imf::Slice(Imf::FLOAT, base, 4, 4 * static_cast<std::size_t>(width)));
  return buffer;
}

TEST(ExrHeaders, TakesBlackPicturesOfEveryCompression) {
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    Imf::StdOSStream stream;
    {
      Imf::OutputFile file(stream, black(1100, 1000, static_cast<Imf::Compression>(compression)));
      std::vector<float> values;
      file.setFrameBuffer(zeros(values, 1100, 1000));
      file.writePixels(1000);
    }
    EXPECT_EQ(error_of(stream.str()), "") << compression;
  }
}

// The library writes the number of chunks into the headers of parts, and ours must be the same.
TEST(ExrHeaders, CountsTilesOfEveryMode) {
  for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS})
    for (const auto rounding : {Imf::ROUND_DOWN, Imf::ROUND_UP})
      for (const int height : {1, 77, 400}) {
        Imf::Header header = black(301, height, Imf::ZIP_COMPRESSION);
        header.setTileDescription({32, 16, mode, rounding});
        header.setType(Imf::TILEDIMAGE);
        header.setName("tiles");
        Imf::StdOSStream stream;
        { const Imf::MultiPartOutputFile file(stream, &header, 1); }
        const std::string tiles(4096, '\0');
        EXPECT_EQ(error_of(stream.str() + tiles), "") << mode << rounding << height;
      }
}

TEST(ExrHeaders, TakesPartsWithTheirChunkCounts) {
  std::vector<Imf::Header> headers;
  for (int part = 0; part < 3; ++part) {
    headers.push_back(black(40, 50, part == 0 ? Imf::ZIP_COMPRESSION : Imf::DWAB_COMPRESSION));
    headers.back().setName("part" + std::to_string(part));
    headers.back().setType(Imf::SCANLINEIMAGE);
  }
  Imf::StdOSStream stream;
  {
    Imf::MultiPartOutputFile file(stream, headers.data(), 3);
    std::vector<float> values;
    for (int part = 0; part < 3; ++part) {
      Imf::OutputPart output(file, part);
      output.setFrameBuffer(zeros(values, 40, 50));
      output.writePixels(50);
    }
  }
  EXPECT_EQ(error_of(stream.str()), "");
}

}  // namespace
}  // namespace sunbeam
