// Work and parts that the command line cannot make: of another version of the tool, and those whose hashes
// are right while what they say is not.
#include <gmock/gmock.h>

#include <filesystem>
#include <limits>

#include "bake/base/version.h"
#include "bake/blocks/parts.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/hash.h"
#include "tests/accuracy/support.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using test::error_of;

const BakeIdentity kThis{kToolVersion, "hash", "[material]\n", "dense", 1, 0, 1};

BakeIdentity of_another_version() {
  BakeIdentity identity = kThis;
  identity.version = "0.0.0";
  return identity;
}

class OfAnotherVersion : public testing::Test {
 protected:
  OfAnotherVersion() : path_(testing::TempDir() + "of_another_version.blocks") {
    std::filesystem::remove(path_);
    Journal::open(path_, of_another_version())->add(0, {{1, 0.5}, "values"});
  }
  ~OfAnotherVersion() override { std::filesystem::remove(path_); }

  std::string path_;
};

TEST_F(OfAnotherVersion, WorkIsNotContinued) {
  const auto message = error_of([&] { Journal::open(path_, kThis); });
  EXPECT_EQ(message,
            path_ + ": holds the work of another bake: the tool's version 0.0.0 against " + kToolVersion);
  EXPECT_EQ(Journal::read(path_)->blocks(), 1U);
  EXPECT_EQ(Journal::open(path_, of_another_version())->values(0), "values");
}

TEST_F(OfAnotherVersion, PartsAreNotMerged) {
  EXPECT_EQ(error_of([&] { Parts parts({path_}); }),
            path_ + ": is of version 0.0.0 of the tool; this is " + kToolVersion);
}

template <class T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string header_of(const std::string& text) {
  return "SUNBAKE1" + bytes_of(std::uint64_t{text.size()}) + content_hash(text) + text;
}

std::string record_of(std::uint64_t task, double worst_error, const std::string& values) {
  const std::string head = bytes_of(task) + bytes_of(std::uint64_t{7}) + bytes_of(worst_error) +
                           bytes_of(std::uint64_t{values.size()});
  return head + content_hash(head + values) + values;
}

// The text of kThis with one property replaced, or left out.
std::string text_with(const std::string& key, const std::string& value) {
  std::string text = kThis.text();
  const auto begin = text.find(key + " "), end = text.find('\n', begin);
  return text.replace(begin, end + 1 - begin, value.empty() ? "" : key + " " + value + "\n");
}

class CraftedPart : public testing::Test {
 protected:
  CraftedPart() : path_(testing::TempDir() + "crafted.part") {}
  ~CraftedPart() override { std::filesystem::remove(path_); }

  std::string refusal(const std::string& bytes) {
    write_file_atomically(path_, bytes);
    return error_of([&] { Parts parts({path_}); });
  }

  std::string path_;
};

TEST_F(CraftedPart, IsRead) { EXPECT_EQ(refusal(header_of(kThis.text()) + record_of(0, 0.5, "values")), ""); }

TEST_F(CraftedPart, NumbersOutOfRange) {
  const std::string ten_billions = "10000000000";
  for (const auto& [key, value, allowed] : std::vector<std::array<std::string, 3>>{
           {"shards", "40000000", "1 to 100000"},
           {"shards", ten_billions, "1 to 100000"},
           {"shards", "0", "1 to 100000"},
           {"shards", "-1", "1 to 100000"},
           {"shards", "1x", "1 to 100000"},
           {"shard", "1", "0 to 0"},
           {"shard", ten_billions, "0 to 0"},
           {"seed", "99999999999999999999999", "0 to 18446744073709551615"},
           {"seed", "one", "0 to 18446744073709551615"}}) {
    const std::string expected = path_ + ": its header has " + key + " '" + value + "'; allowed: " + allowed;
    EXPECT_EQ(refusal(header_of(text_with(key, value))), expected);
  }
}

TEST_F(CraftedPart, PropertiesMissingOrTwice) {
  for (const std::string key : {"version", "recipe_hash", "encoding", "seed", "shard", "shards"}) {
    EXPECT_EQ(refusal(header_of(text_with(key, ""))), path_ + ": its header has no '" + key + "'");
    EXPECT_EQ(refusal(header_of(text_with(key, "1\n" + key + " 1"))),
              path_ + ": its header has '" + key + "' twice");
  }
  EXPECT_EQ(refusal(header_of("one\n\n")), path_ + ": its header has a line without a value");
  EXPECT_EQ(refusal(header_of("version 1")), path_ + ": its header has no recipe");
}

TEST_F(CraftedPart, BlocksThatAreNone) {
  const std::string header = header_of(kThis.text()), good = record_of(0, 0.5, "values");
  EXPECT_EQ(refusal(header + good + good), path_ + ": is damaged: it holds block 0 twice");
  for (const double error :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
    write_file_atomically(path_, header + good + record_of(1, error, "more"));
    const auto journal = Journal::read(path_);
    EXPECT_EQ(journal->blocks(), 1u);
    EXPECT_EQ(journal->damaged_bytes(), record_of(1, error, "more").size());
  }
}

TEST_F(CraftedPart, ListsTenMissingParts) {
  const std::string text = text_with("shards", "100000");
  EXPECT_EQ(refusal(header_of(text)),
            "of 100000 parts these are missing: 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 99989 more");
}

}  // namespace
}  // namespace sunbeam
