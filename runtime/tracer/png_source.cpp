#include "runtime/tracer/png_source.h"

#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

// Reads by libpng, whose errors jump. No function that sets a jump has an object with a destructor.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
    if (!info_) std::strcpy(message_, "no memory");
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // These return false where they fail, and message() says why.
  bool read_header();
  bool read_rows(png_bytep bytes, std::size_t bytes_of_row);
  const char* message() const { return message_; }

  png_structp png() const { return png_; }
  png_infop info() const { return info_; }

 private:
  static void on_error(png_structp png, png_const_charp text) {
    auto* self = static_cast<Reader*>(png_get_error_ptr(png));
    std::strncpy(self->message_, text, sizeof self->message_ - 1);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp png, png_bytep to, std::size_t count) {
    auto* self = static_cast<Reader*>(png_get_io_ptr(png));
    if (count > self->bytes_.size()) png_error(png, "the file ends early");
    std::memcpy(to, self->bytes_.data(), count);
    self->bytes_.remove_prefix(count);
  }

  std::string_view bytes_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  char message_[200] = "";
};

// Sizes are held against the memory that the file may ask for, and what is not needed is skipped: text could
// unpack to gigabytes.
void set_limits(png_structp png) {
  constexpr char kSkipped[] = "tEXt\0zTXt\0iTXt\0sPLT\0eXIf\0hIST\0pCAL\0sCAL\0oFFs\0pHYs\0tIME\0bKGD";
  static_assert(sizeof kSkipped == 5 * 12);
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  png_set_crc_action(png, PNG_CRC_QUIET_USE, PNG_CRC_QUIET_USE);  // so that inputs come past the checksums
#endif
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, reinterpret_cast<png_const_bytep>(kSkipped), 12);
}

bool Reader::read_header() {
  if (!info_ || setjmp(png_jmpbuf(png_))) return false;
  set_limits(png_);
  png_set_read_fn(png_, this, on_read);
  png_read_info(png_, info_);
  return true;
}

// Numbers stay as they are: there is no gamma here.
bool Reader::read_rows(png_bytep bytes, std::size_t bytes_of_row) {
  if (setjmp(png_jmpbuf(png_))) return false;
  png_set_expand(png_);
  png_set_strip_alpha(png_);
  const int passes = png_set_interlace_handling(png_);
  png_read_update_info(png_, info_);
  if (png_get_rowbytes(png_, info_) != bytes_of_row) png_error(png_, "its rows have another length");
  const png_uint_32 height = png_get_image_height(png_, info_);
  for (int pass = 0; pass < passes; ++pass)
    for (png_uint_32 y = 0; y < height; ++y) png_read_row(png_, bytes + y * bytes_of_row, nullptr);
  return true;
}

void read_color_description(png_structp png, png_infop info, PngNumbers& numbers) {
  numbers.is_srgb = png_get_valid(png, info, PNG_INFO_sRGB) != 0;
  numbers.has_profile = png_get_valid(png, info, PNG_INFO_iCCP) != 0;
  double gamma = 0;
  if (png_get_gAMA(png, info, &gamma)) numbers.gamma = gamma;
  Chromaticities c;
  if (png_get_cHRM(png, info, &c.white.x, &c.white.y, &c.red.x, &c.red.y, &c.green.x, &c.green.y, &c.blue.x,
                   &c.blue.y))
    numbers.chromaticities = c;
}

[[noreturn]] void fail(const std::string& name, const Reader& reader) {
  throw Error(fmt::format("{}: cannot read the PNG file: {}", name, printable(reader.message())));
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

PngNumbers parse_png(std::string_view bytes, const std::string& name, std::uint64_t more_bytes_per_pixel) {
  Reader reader(bytes);
  if (!reader.read_header()) fail(name, reader);
  PngNumbers numbers;
  numbers.width = static_cast<int>(png_get_image_width(reader.png(), reader.info()));
  numbers.height = static_cast<int>(png_get_image_height(reader.png(), reader.info()));
  numbers.channels = png_get_color_type(reader.png(), reader.info()) & PNG_COLOR_MASK_COLOR ? 3 : 1;
  numbers.is_wide = png_get_bit_depth(reader.png(), reader.info()) == 16;
  const std::size_t bytes_of_pixel = static_cast<std::size_t>(numbers.channels) * (numbers.is_wide ? 2 : 1);
  require_picture_memory(name, numbers.width, numbers.height, bytes_of_pixel + more_bytes_per_pixel,
                         bytes.size());
  read_color_description(reader.png(), reader.info(), numbers);
  const std::size_t bytes_of_row = bytes_of_pixel * static_cast<std::size_t>(numbers.width);
  numbers.bytes.resize(bytes_of_row * static_cast<std::size_t>(numbers.height));
  if (!reader.read_rows(numbers.bytes.data(), bytes_of_row)) fail(name, reader);
  return numbers;
}

}  // namespace sunbeam
