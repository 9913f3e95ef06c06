#include "sunbeam/detail/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>

#include "tests/support/error_of.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using test::error_of;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// While it lives, no file may grow beyond `bytes`: what a full disk is to the writer.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(File, RoundTripOfAnyBytes) {
  const ScratchFolder folder;
  std::string bytes;
  for (int k = 0; k < 100000; ++k) bytes += static_cast<char>(k * 7 % 256);
  for (const std::string& content : {bytes, std::string(), std::string("\0\r\n\x1a", 4)}) {
    write_file_atomically(folder.file("f"), content);
    EXPECT_EQ(read_file(folder.file("f")), content);
  }
  EXPECT_THAT(folder.names(), ElementsAre("f"));
}

TEST(File, TextIsUtf8WithOrWithoutItsMark) {
  const ScratchFolder folder;
  write_file_atomically(folder.file("f"),
                        "\xef\xbb\xbf"
                        "a");
  EXPECT_EQ(read_text(folder.file("f")), "a");
  write_file_atomically(folder.file("f"), "a");
  EXPECT_EQ(read_text(folder.file("f")), "a");
  write_file_atomically(folder.file("f"),
                        "\xff\xfe"
                        "a");
  EXPECT_THAT(error_of([&] { read_text(folder.file("f")); }),
              HasSubstr("f: the text is UTF-16; allowed: UTF-8"));
}

TEST(File, FailedWriteLeavesTheOldFile) {
  const ScratchFolder folder;
  write_file_atomically(folder.file("f"), "old");
  std::string message;
  {
    const FileSizeLimit limit(1000);
    message = error_of([&] { write_file_atomically(folder.file("f"), std::string(10000, 'x')); });
  }
  EXPECT_THAT(message, AllOf(HasSubstr(folder.file("f")), HasSubstr("cannot write")));
  EXPECT_EQ(read_file(folder.file("f")), "old");
  EXPECT_THAT(folder.names(), ElementsAre("f"));
}

TEST(File, FailedFirstWriteLeavesNothing) {
  const ScratchFolder folder;
  std::string message;
  {
    const FileSizeLimit limit(1000);
    message = error_of([&] { write_file_atomically(folder.file("f"), std::string(10000, 'x')); });
  }
  EXPECT_THAT(message, HasSubstr("cannot write"));
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(File, ImpossiblePlaces) {
  const ScratchFolder folder;
  write_file_atomically(folder.file("plain"), "old");
  ASSERT_EQ(::mkdir(folder.file("sub").c_str(), 0777), 0);
  for (const std::string name : {"none/f", "plain/f", "sub"}) {
    const std::string path = folder.file(name);
    EXPECT_THAT(error_of([&] { write_file_atomically(path, "new"); }), HasSubstr(path));
    EXPECT_THAT(error_of([&] { require_writable(path); }), HasSubstr(path));
    EXPECT_THAT(error_of([&] { read_file(path); }), HasSubstr(path));
  }
  EXPECT_EQ(read_file(folder.file("plain")), "old");
  EXPECT_EQ(folder.names().size(), 2u);
}

TEST(File, RequireWritableTouchesNothing) {
  const ScratchFolder folder;
  require_writable(folder.file("new"));
  EXPECT_THAT(folder.names(), IsEmpty());
  write_file_atomically(folder.file("f"), "old");
  require_writable(folder.file("f"));
  EXPECT_EQ(read_file(folder.file("f")), "old");
  EXPECT_THAT(folder.names(), ElementsAre("f"));
}

TEST(File, Extension) {
  EXPECT_EQ(extension("a/b.c/T.ExR"), ".exr");
  EXPECT_EQ(extension("a/b.c/t"), "");
  EXPECT_EQ(extension("t.exr.vdb"), ".vdb");
  EXPECT_EQ(extension(".exr"), "");  // a hidden file without extension
}

}  // namespace
}  // namespace sunbeam
