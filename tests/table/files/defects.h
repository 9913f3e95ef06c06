// What readers must say of a table that is not sound, and what they must survive.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/table/support.h"

namespace sunbeam::test {

inline constexpr const char* kName = "folder/some.table";

struct Defect {
  std::string description;
  std::function<void(Table&)> make;
  std::vector<std::string> named;  // what the message must say
};

inline void expect_named(const Table& sound, const std::vector<Defect>& defects) {
  for (const Form& form : forms())
    for (const Defect& defect : defects) {
      Table table = sound;
      ASSERT_EQ(refusal(form, form.bytes(table), kName), "accepted");
      defect.make(table);
      const std::string message = refusal(form, form.bytes(table), kName);
      EXPECT_THAT(message, ::testing::StartsWith(kName)) << form.name << ", " << defect.description;
      for (const std::string& part : defect.named)
        EXPECT_THAT(message, ::testing::HasSubstr(part)) << form.name << ", " << defect.description;
    }
}

// Every outcome but a crash or a wrong table: an Error that names the file, or the very table.
inline void expect_survives_flipped_bits(const Table& table, std::uint64_t stream) {
  for (const Form& form : forms()) {
    const std::string bytes = form.bytes(table);
    Rng rng(1, stream);
    for (int k = 0; k < 300; ++k) {
      const auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(bytes.size()));
      const unsigned bit = rng.next() % 8;
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
      expect_error_or_equal(form, damaged, kName, table,
                            "bit " + std::to_string(bit) + " of byte " + std::to_string(at));
    }
  }
}

inline void expect_survives_truncation(const Table& table) {
  for (const Form& form : forms()) {
    const std::string bytes = form.bytes(table);
    for (std::size_t k = 0; k < 50; ++k)
      EXPECT_THAT(refusal(form, bytes.substr(0, bytes.size() * k / 50), kName), ::testing::StartsWith(kName))
          << form.name;
    EXPECT_THAT(refusal(form, bytes.substr(0, bytes.size() - 1), kName), ::testing::StartsWith(kName))
        << form.name;
  }
}

}  // namespace sunbeam::test
