// A journal keeps the finished blocks of a bake in one file that only grows, so that a bake may be killed at
// any moment. It is what a resumed bake goes on from, and the part that a shard hands to `sunbeam merge`.
//
// The file is a header, which says as text what is baked, and records, each of them with a hash. A record
// that was cut short or damaged ends the file for a reader. Numbers are in the order of the machine
// (little-endian).
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>

#include "bake/blocks/run.h"

namespace sunbeam {

// Says what is baked: blocks of different identities do not mix.
struct BakeIdentity {
  std::string version;      // of the tool
  std::string recipe_hash;  // of `recipe`
  std::string recipe;       // with overrides, canonical TOML
  std::string encoding;     // factored or dense
  std::uint64_t seed = 1;
  int shard = 0, shards = 1;  // shard counts from 0

  static constexpr int kMostShards = 100000;

  std::string text() const;
  // Throws Error unless the text has each property once, and the shard is one of 1 to kMostShards.
  static BakeIdentity parse(const std::string& text);

  // Returns an empty text if blocks of both mix, else which property differs and how. Shards are not
  // compared.
  std::string difference(const BakeIdentity& other) const;
};

class Journal : public BlockStore {
 public:
  // Opens a new file, or one that has been started. Throws Error if it cannot be written, is in use by
  // another bake or is of another identity or shard. A damaged end is cut off.
  static std::unique_ptr<Journal> open(const std::string& path, const BakeIdentity& identity);

  // Opens a file for reading alone. Throws Error naming the file if it is no journal.
  static std::unique_ptr<Journal> read(const std::string& path);

  ~Journal() override;
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const std::string& path() const { return path_; }
  const BakeIdentity& identity() const { return identity_; }
  std::size_t blocks() const;
  // Returns the number of bytes at the end that are no whole record.
  std::uint64_t damaged_bytes() const { return damaged_bytes_; }

  // Appends a block, and flushes the file to disk if the last flush was kSyncSeconds ago. Throws Error (disk
  // full) and leaves the file as it was.
  void add(std::size_t task, const Block& block) override;
  bool has(std::size_t task) const override;
  BlockSummary summary(std::size_t task) const override;
  std::string values(std::size_t task) const override;
  void sync();

 private:
  static constexpr double kSyncSeconds = 5;

  struct Place {
    BlockSummary summary;
    std::uint64_t offset, size;  // of the values
  };

  Journal(std::string path, int descriptor);
  void write_header(const BakeIdentity& identity);
  void require_regular_file() const;
  void read_header();
  void read_records();
  void append(const std::string& bytes);
  bool read_at(std::uint64_t offset, char* bytes, std::uint64_t count) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  int descriptor_;
  BakeIdentity identity_;
  std::uint64_t end_ = 0, damaged_bytes_ = 0;
  double synced_at_ = 0;
  mutable std::mutex mutex_;  // of places_
  std::unordered_map<std::size_t, Place> places_;
};

}  // namespace sunbeam
