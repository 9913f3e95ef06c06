#include "runtime/tracer/obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "runtime/tracer/polygon.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Hands out the words of a text, line by line. A line ends with LF, CRLF or CR; a backslash before its end
// joins the next one.
class Words {
 public:
  explicit Words(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}

  long line() const { return line_; }
  bool is_at_end() const { return at_ == end_; }

  // Returns the next word of the line, "" at its end or where a comment begins.
  std::string_view next() {
    while (at_ != end_ && (is_blank(*at_) || is_joint())) {
      if (is_joint())
        ++at_, end_line();
      else
        ++at_;
    }
    if (at_ != end_ && *at_ == '#') return {};
    const char* begin = at_;
    while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_) && *at_ != '#' && !is_joint()) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }

  // Goes behind the end of the line, whatever stands before it.
  void skip_line() {
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    if (at_ != end_) end_line();
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  bool is_joint() const { return *at_ == '\\' && at_ + 1 != end_ && is_line_end(at_[1]); }

  void end_line() {
    ++line_;
    if (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n') ++at_;
    ++at_;
  }

  const char *at_, *end_;
  long line_ = 1;
};

// What faces point into.
struct List {
  const char *keyword, *name;
  std::size_t needed;  // numbers of an entry; more, up to three, may follow
  std::vector<Vec3> entries = {};
  long largest = 0, largest_line = 0;  // index, and where it stands

  long count() const { return static_cast<long>(entries.size()); }
};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& path) : text_(text), path_(path), words_(text) {}

  Mesh mesh() {
    for (; !words_.is_at_end(); words_.skip_line()) read_line();
    for (const List& list : lists_)
      if (list.largest > list.count())
        fail(list.largest_line,
             fmt::format("{} index {}; allowed: 1 to {}", list.name, list.largest, list.count()));
    return cut();
  }

 private:
  using Corner = std::array<std::uint32_t, 3>;  // places in the lists, or kNone

  void read_line() {
    const std::string_view keyword = words_.next();
    if (keyword == "f") return read_face();
    for (List& list : lists_)
      if (keyword == list.keyword) return read_entry(list);
  }

  void read_entry(List& list) {
    std::array<double, 3> numbers = {};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string_view word = words_.next();
      if (i >= list.needed && word.empty()) break;
      if (!parse_number(word, numbers[i]) || !(std::abs(numbers[i]) <= std::numeric_limits<float>::max()))
        fail(words_.line(), fmt::format("'{}' entry {} is '{}'; allowed: a finite number", list.keyword,
                                        i + 1, excerpt(word)));
    }
    list.entries.push_back({numbers[0], numbers[1], numbers[2]});
  }

  void read_face() {
    const std::size_t first = corners_.size();
    for (std::string_view word = words_.next(); !word.empty(); word = words_.next()) {
      corners_.push_back(read_corner(word));
      // An index that is left out may be a number that got lost, unless the whole face has none.
      if (word.ends_with('/') && corners_[first][1] != kNone && corners_.back()[1] == kNone)
        fail_index(lists_[1], word);
    }
    face_ends_.push_back(corners_.size());
  }

  // v, v/vt, v//vn or v/vt/vn; exporters that have no vt or vn also write v/, v// and v/vt/.
  Corner read_corner(std::string_view word) {
    Corner corner = {kNone, kNone, kNone};
    std::string_view rest = word;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string_view field = rest.substr(0, rest.find('/'));
      if (k == 0 || !field.empty()) corner[k] = read_index(lists_[k], field, word);
      if (field.size() == rest.size()) return corner;
      rest.remove_prefix(field.size() + 1);
    }
    fail(words_.line(), fmt::format("a face has the corner '{}'; allowed: up to v/vt/vn", excerpt(word)));
  }

  std::uint32_t read_index(List& list, std::string_view field, std::string_view word) {
    if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
    long index = 0;
    const auto parsed = std::from_chars(field.data(), field.data() + field.size(), index);
    if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size() || index == 0 ||
        index < -list.count())
      fail_index(list, word);
    if (index < 0) return static_cast<std::uint32_t>(list.count() + index);
    if (index > list.largest) list.largest = index, list.largest_line = words_.line();
    return static_cast<std::uint32_t>(index - 1);  // what does not fit is refused at the end
  }

  Mesh cut() {
    const auto every_corner_has = [&](std::size_t k) {
      return std::none_of(corners_.begin(), corners_.end(), [&](const Corner& c) { return c[k] == kNone; });
    };
    has_uvs_ = every_corner_has(1), has_normals_ = every_corner_has(2);
    require_memory();
    PolygonCutter cutter;
    std::vector<Vec3> polygon;
    std::size_t first = 0;
    for (const std::size_t end : face_ends_) {
      polygon.clear();
      for (std::size_t i = first; i < end; ++i) polygon.push_back(lists_[0].entries[corners_[i][0]]);
      for (const auto& triangle : cutter.cut(polygon))
        for (const std::uint32_t i : triangle) add_vertex(corners_[first + i]);
      first = end;
    }
    return std::move(mesh_);
  }

  void require_memory() {
    std::size_t triangles = 0, largest = 0, first = 0;
    for (const std::size_t end : face_ends_) {
      triangles += std::max(end - first, std::size_t{2}) - 2;
      largest = std::max(largest, end - first);
      first = end;
    }
    require_mesh_memory(path_, 3 * triangles, triangles, text_.size());
    require_within_read_limit(fmt::format("{}: a face of {} corners", path_, largest),
                              PolygonCutter::kBytesPerCorner * largest, text_.size());
    mesh_.positions.reserve(3 * triangles);
    if (has_uvs_) mesh_.uvs.reserve(3 * triangles);
    if (has_normals_) mesh_.normals.reserve(3 * triangles);
    mesh_.triangles.reserve(triangles);
  }

  void add_vertex(const Corner& corner) {
    const std::uint32_t vertex = static_cast<std::uint32_t>(mesh_.positions.size());
    mesh_.positions.push_back(lists_[0].entries[corner[0]]);
    if (has_uvs_) {
      const Vec3& uv = lists_[1].entries[corner[1]];
      mesh_.uvs.push_back({uv.x, uv.y});
    }
    if (has_normals_) {
      const Vec3& normal = lists_[2].entries[corner[2]];
      if (!(length(normal) > 0)) throw Error(fmt::format("{}: normal {} has length 0", path_, corner[2] + 1));
      mesh_.normals.push_back(normal);
    }
    if (vertex % 3 == 2) mesh_.triangles.push_back({vertex - 2, vertex - 1, vertex});
  }

  [[noreturn]] void fail_index(const List& list, std::string_view word) const {
    fail(words_.line(), fmt::format("{} index '{}'; allowed: 1 up, or -1 down to -{}", list.name,
                                    excerpt(word), list.count()));
  }

  [[noreturn]] void fail(long line, const std::string& message) const {
    throw Error(fmt::format("{}:{}: {}", path_, line, message));
  }

  std::string_view text_;
  const std::string& path_;
  Words words_;
  // In the order of the fields of a corner, v/vt/vn.
  std::array<List, 3> lists_{{{"v", "face", 3}, {"vt", "texture", 1}, {"vn", "normal", 3}}};
  std::vector<Corner> corners_;
  std::vector<std::size_t> face_ends_;  // in corners_
  bool has_uvs_ = false, has_normals_ = false;
  Mesh mesh_;
};

}  // namespace

LoadedMesh load_obj(const std::string& path) { return parse_obj(read_text(path), path); }

LoadedMesh parse_obj(std::string_view text, const std::string& path) {
  return checked_mesh(path, ObjReader(without_byte_order_mark(text), path).mesh());
}

}  // namespace sunbeam
