#include "bake/blocks/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/hash.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr std::string_view kMagic = "SUNBAKE1";
constexpr std::uint64_t kLargestHeader = 1 << 24, kLargestBlock = std::uint64_t{1} << 40;

struct RecordHead {
  std::uint64_t task, walks;
  double worst_error;
  std::uint64_t size;
};
constexpr std::size_t kHashSize = 32;
constexpr std::size_t kHeaderStart =
    kMagic.size() + sizeof(std::uint64_t) + kHashSize;  // size and hash of the text

std::string bytes_of(const RecordHead& head) { return {reinterpret_cast<const char*>(&head), sizeof head}; }

std::string record_hash(const RecordHead& head, std::string_view values) {
  ContentHash hash;
  hash.add(bytes_of(head));
  hash.add(values);
  return hash.text();
}

using Properties = std::map<std::string, std::string, std::less<>>;

// Lines of "key value". A key that is there twice is an error.
Properties read_properties(std::string_view text) {
  Properties properties;
  for (const auto& line : split(text, '\n')) {
    const auto space = line.find(' ');
    if (space == std::string::npos) throw Error("its header has a line without a value");
    if (!properties.emplace(line.substr(0, space), line.substr(space + 1)).second)
      throw Error(fmt::format("its header has '{}' twice", line.substr(0, space)));
  }
  return properties;
}

const std::string& find(const Properties& properties, std::string_view key) {
  const auto at = properties.find(key);
  if (at == properties.end()) throw Error(fmt::format("its header has no '{}'", key));
  return at->second;
}

std::uint64_t whole_number(const Properties& properties, std::string_view key, std::uint64_t least,
                           std::uint64_t most) {
  std::uint64_t value = 0;
  const std::string& text = find(properties, key);
  if (!parse_whole_number(text, value) || value < least || value > most)
    throw Error(fmt::format("its header has {} '{:.40}'; allowed: {} to {}", key, text, least, most));
  return value;
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string BakeIdentity::text() const {
  return fmt::format("version {}\nrecipe_hash {}\nencoding {}\nseed {}\nshard {}\nshards {}\n\n{}", version,
                     recipe_hash, encoding, seed, shard, shards, recipe);
}

BakeIdentity BakeIdentity::parse(const std::string& text) {
  const auto blank = text.find("\n\n");
  if (blank == std::string::npos) throw Error("its header has no recipe");
  const Properties properties = read_properties(std::string_view(text).substr(0, blank));
  BakeIdentity identity;
  identity.version = find(properties, "version");
  identity.recipe_hash = find(properties, "recipe_hash");
  identity.encoding = find(properties, "encoding");
  identity.seed = whole_number(properties, "seed", 0, std::numeric_limits<std::uint64_t>::max());
  identity.shards = static_cast<int>(whole_number(properties, "shards", 1, kMostShards));
  const auto last = static_cast<std::uint64_t>(identity.shards - 1);
  identity.shard = static_cast<int>(whole_number(properties, "shard", 0, last));
  identity.recipe = text.substr(blank + 2);
  return identity;
}

std::string BakeIdentity::difference(const BakeIdentity& other) const {
  const auto differs = [](const char* what, const auto& a, const auto& b) {
    return fmt::format("{} {} against {}", what, a, b);
  };
  if (version != other.version) return differs("the tool's version", version, other.version);
  if (recipe_hash != other.recipe_hash) return differs("a recipe of hash", recipe_hash, other.recipe_hash);
  if (seed != other.seed) return differs("seed", seed, other.seed);
  if (encoding != other.encoding) return differs("encoding", encoding, other.encoding);
  return {};
}

Journal::Journal(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

Journal::~Journal() { ::close(descriptor_); }

std::unique_ptr<Journal> Journal::open(const std::string& path, const BakeIdentity& identity) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) throw Error(path + ": cannot write: " + std::strerror(errno));
  std::unique_ptr<Journal> journal(new Journal(path, descriptor));
  // Some network file systems know no locks: then nobody is shut out.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw Error(path + ": another bake is writing it");
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) journal->fail("cannot read");
  try {
    journal->read_header();
  } catch (const Error&) {
    // Killed before the header was whole: nothing is lost by starting anew.
    if (static_cast<std::uint64_t>(status.st_size) > kHeaderStart + identity.text().size()) throw;
    journal->write_header(identity);
    return journal;
  }
  const BakeIdentity& found = journal->identity_;
  if (const auto difference = found.difference(identity); !difference.empty())
    throw Error(path + ": holds the work of another bake: " + difference);
  if (found.shard != identity.shard || found.shards != identity.shards)
    throw Error(fmt::format("{}: holds the work of shard {}/{}; asked for {}/{}", path, found.shard + 1,
                            found.shards, identity.shard + 1, identity.shards));
  journal->read_records();
  if (::ftruncate(descriptor, static_cast<off_t>(journal->end_)) != 0) journal->fail("cannot write");
  return journal;
}

std::unique_ptr<Journal> Journal::read(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw Error(path + ": cannot read: " + std::strerror(errno));
  std::unique_ptr<Journal> journal(new Journal(path, descriptor));
  journal->require_regular_file();
  journal->read_header();
  journal->read_records();
  return journal;
}

void Journal::require_regular_file() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("cannot read");
  if (!S_ISREG(status.st_mode)) throw Error(path_ + ": is not a regular file; allowed: the part of a bake");
}

void Journal::write_header(const BakeIdentity& identity) {
  identity_ = identity;
  if (::ftruncate(descriptor_, 0) != 0) fail("cannot write");
  const std::string text = identity.text();
  const std::uint64_t size = text.size();
  append(std::string(kMagic) + std::string(reinterpret_cast<const char*>(&size), sizeof size) +
         content_hash(text) + text);
  sync();
}

void Journal::read_header() {
  char magic[kMagic.size()], hash[kHashSize];
  std::uint64_t size = 0;
  if (!read_at(0, magic, sizeof magic) || std::string_view(magic, sizeof magic) != kMagic)
    throw Error(path_ + ": is not the work or a part of a bake");
  std::string text;
  if (read_at(sizeof magic, reinterpret_cast<char*>(&size), sizeof size) &&
      read_at(sizeof magic + sizeof size, hash, sizeof hash) && size <= kLargestHeader)
    text.resize(size);
  end_ = kHeaderStart + text.size();
  if (text.empty() || !read_at(kHeaderStart, text.data(), text.size()))
    throw Error(path_ + ": its header is cut short");
  if (!is_hash_of_content({hash, sizeof hash}, content_hash(text)))
    throw Error(path_ + ": its header is damaged");
  try {
    identity_ = BakeIdentity::parse(text);
  } catch (const Error& error) {
    throw Error(path_ + ": " + error.what());
  }
}

void Journal::read_records() {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("cannot read");
  const auto file_size = static_cast<std::uint64_t>(status.st_size);
  for (;;) {
    RecordHead head{};
    char hash[kHashSize];
    const std::uint64_t start = end_ + sizeof head + sizeof hash;
    if (start > file_size || !read_at(end_, reinterpret_cast<char*>(&head), sizeof head) ||
        !read_at(end_ + sizeof head, hash, sizeof hash) || head.size > kLargestBlock ||
        start + head.size > file_size)
      break;
    std::string values(head.size, '\0');
    if (!read_at(start, values.data(), head.size) ||
        !is_hash_of_content({hash, sizeof hash}, record_hash(head, values)))
      break;
    if (!(head.worst_error >= 0) || !std::isfinite(head.worst_error)) break;
    const Place place{{head.walks, head.worst_error}, start, head.size};
    if (!places_.emplace(head.task, place).second)
      throw Error(fmt::format("{}: is damaged: it holds block {} twice", path_, head.task));
    end_ = start + head.size;
  }
  damaged_bytes_ = file_size - end_;
}

std::size_t Journal::blocks() const {
  const std::lock_guard lock(mutex_);
  return places_.size();
}

void Journal::add(std::size_t task, const Block& block) {
  const RecordHead head{task, block.summary.walks, block.summary.worst_error, block.values.size()};
  const std::uint64_t start = end_ + sizeof head + kHashSize;
  append(bytes_of(head) + record_hash(head, block.values) + block.values);
  if (seconds_now() - synced_at_ > kSyncSeconds) sync();
  const std::lock_guard lock(mutex_);
  places_[task] = {block.summary, start, head.size};
}

bool Journal::has(std::size_t task) const {
  const std::lock_guard lock(mutex_);
  return places_.contains(task);
}

BlockSummary Journal::summary(std::size_t task) const {
  const std::lock_guard lock(mutex_);
  return places_.at(task).summary;
}

std::string Journal::values(std::size_t task) const {
  Place place;
  {
    const std::lock_guard lock(mutex_);
    place = places_.at(task);
  }
  std::string bytes(place.size, '\0');
  if (!read_at(place.offset, bytes.data(), place.size)) fail("cannot read");
  return bytes;
}

void Journal::sync() {
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL) fail("cannot write");
  synced_at_ = seconds_now();
}

void Journal::append(const std::string& bytes) {
  std::uint64_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::pwrite(descriptor_, bytes.data() + written, bytes.size() - written,
                                   static_cast<off_t>(end_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const std::string reason = std::strerror(errno);
      // If not even that can be done, the next reader cuts the broken record off.
      [[maybe_unused]] const int cut = ::ftruncate(descriptor_, static_cast<off_t>(end_));
      throw Error(path_ + ": cannot write: " + reason);
    }
    written += static_cast<std::uint64_t>(count);
  }
  end_ += bytes.size();
}

bool Journal::read_at(std::uint64_t offset, char* bytes, std::uint64_t count) const {
  while (count > 0) {
    const ssize_t got = ::pread(descriptor_, bytes, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<std::uint64_t>(got);
    bytes += got;
    count -= static_cast<std::uint64_t>(got);
  }
  return true;
}

void Journal::fail(const std::string& what) const {
  throw Error(path_ + ": " + what + ": " + std::strerror(errno));
}

}  // namespace sunbeam
