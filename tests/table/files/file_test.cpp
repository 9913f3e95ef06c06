#include "sunbeam/detail/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/error_of.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using test::error_of;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

namespace fs = std::filesystem;

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

fs::perms mode_of(const std::string& path) { return fs::status(path).permissions(); }

TEST(File, ReplacedFileKeepsItsModeAndNewOneFollowsTheUmask) {
  const ScratchFolder folder;
  const std::string path = folder.file("f");
  for (const mode_t mask : {0022, 0027, 0077, 0002}) {
    const mode_t before = ::umask(mask);
    write_file_atomically(path, "old");
    ::umask(before);
    EXPECT_EQ(mode_of(path), fs::perms(0666 & ~mask)) << mask;
    write_file_atomically(path, "new");
    EXPECT_EQ(mode_of(path), fs::perms(0666 & ~mask)) << mask;
    EXPECT_EQ(read_file(path), "new");
    fs::remove(path);
  }
}

// Only root can give files away; for others the file is their own before and after.
TEST(File, ReplacedFileKeepsItsOwner) {
  const ScratchFolder folder;
  const std::string path = folder.file("f");
  write_file_atomically(path, "old");
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown(path.c_str(), 65534, 65534), 0);
  }
  struct stat before {};
  struct stat after {};
  ASSERT_EQ(::stat(path.c_str(), &before), 0);
  write_file_atomically(path, "new");
  ASSERT_EQ(::stat(path.c_str(), &after), 0);
  EXPECT_EQ(after.st_mode, before.st_mode);
#ifndef SUNBEAM_PORTABLE
  EXPECT_EQ(after.st_uid, before.st_uid);
  EXPECT_EQ(after.st_gid, before.st_gid);
#endif
}

TEST(File, SymbolicLinksStayLinksAndHardLinksKeepTheOldContents) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkdir(folder.file("sub").c_str(), 0777), 0);
  ASSERT_EQ(::mkdir(folder.file("sub/deep").c_str(), 0777), 0);
  write_file_atomically(folder.file("sub/f"), "old");
  fs::create_symlink("f", folder.file("sub/link"));
  fs::create_symlink("sub/link", folder.file("chain"));
  fs::create_symlink("sub/deep", folder.file("short"));
  fs::create_symlink("short/../f", folder.file("dots"));  // behind a link, .. is the folder above its end
  fs::create_symlink("sub/new", folder.file("dangling"));
  fs::create_hard_link(folder.file("sub/f"), folder.file("hard"));
  for (const std::string name : {"chain", "dots", "dangling"}) {
    require_writable(folder.file(name));
    write_file_atomically(folder.file(name), "by " + name);
    EXPECT_TRUE(fs::is_symlink(folder.file(name)));
    EXPECT_EQ(read_file(folder.file(name == "dangling" ? "sub/new" : "sub/f")), "by " + name);
  }
  EXPECT_THAT(folder.names(), UnorderedElementsAre("sub", "chain", "short", "dots", "dangling", "hard"));
  EXPECT_EQ(read_file(folder.file("hard")), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.file("sub")), fs::directory_iterator()), 4);
}

TEST(File, LinksInACircleAreRefused) {
  const ScratchFolder folder;
  fs::create_symlink("b", folder.file("a"));
  fs::create_symlink("a", folder.file("b"));
  EXPECT_THAT(error_of([&] { write_file_atomically(folder.file("a"), "x"); }), HasSubstr("cannot write"));
  EXPECT_TRUE(fs::is_symlink(folder.file("a")));
}

// By links, so that a writer that replaces them harms no other program.
TEST(File, DevicesAreWrittenToAndStay) {
  const ScratchFolder folder;
  fs::create_symlink("/dev/null", folder.file("null"));
  fs::create_symlink("/dev/full", folder.file("full"));
  require_writable(folder.file("null"));
  write_file_atomically(folder.file("null"), "gone");
  require_writable(folder.file("full"));
  EXPECT_THAT(error_of([&] { write_file_atomically(folder.file("full"), "x"); }),
              AllOf(HasSubstr("full: cannot write"), HasSubstr("No space left")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_TRUE(fs::is_symlink(folder.file("null")));
  EXPECT_EQ(folder.names().size(), 2u);
}

TEST(File, FifoIsWrittenInOneGoAndNotProbed) {
  const ScratchFolder folder;
  const std::string path = folder.file("fifo");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  require_writable(path);  // would wait for a reader
  std::string received;
  std::thread reader([&] { received = read_file(path); });
  {
    AtomicFile file(path);
    file.write("0123456789");
    file.seek(2);
    file.write("ab");
    file.seek(12);
    file.write("cd");
    file.keep();
  }
  reader.join();
  EXPECT_EQ(received, std::string("01ab456789\0\0cd", 14));
  EXPECT_TRUE(fs::is_fifo(path));
  EXPECT_THAT(folder.names(), ElementsAre("fifo"));
}

TEST(File, LongestNames) {
  const ScratchFolder folder;
  std::string umlauts;
  while (umlauts.size() < 254) umlauts += "\xc3\xa4";
  for (const std::string& name : {std::string(255, 'x'), std::string(251, 'y') + ".exr", umlauts}) {
    write_file_atomically(folder.file(name), "old");
    write_file_atomically(folder.file(name), name);
    EXPECT_EQ(read_file(folder.file(name)), name);
  }
  EXPECT_THAT(error_of([&] { write_file_atomically(folder.file(std::string(256, 'z')), ""); }),
              HasSubstr("cannot write"));
  EXPECT_EQ(folder.names().size(), 3u);
}

TEST(File, PathsThatNameNoFile) {
  const ScratchFolder folder;
  write_file_atomically(folder.file("f"), "old");
  for (const std::string& path : {std::string(), folder.file("f/"), folder.file("new/"), folder.file(".")}) {
    EXPECT_THAT(error_of([&] { write_file_atomically(path, "x"); }), HasSubstr("cannot write")) << path;
    EXPECT_THAT(error_of([&] { require_writable(path); }), HasSubstr("cannot write")) << path;
  }
  EXPECT_THAT(error_of([] { read_file(""); }), HasSubstr("'': cannot read: No such file"));
  EXPECT_EQ(read_file(folder.file("f")), "old");
  EXPECT_THAT(folder.names(), ElementsAre("f"));
}

TEST(File, MovedIntoPlace) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkdir(folder.file("sub").c_str(), 0777), 0);
  write_file_atomically(folder.file("sub/old"), "old");
  fs::permissions(folder.file("sub/old"), fs::perms(0600));
  fs::create_symlink("sub/old", folder.file("link"));
  write_file_atomically(folder.file("f"), "new");
  move_into_place(folder.file("f"), folder.file("link"));
  EXPECT_TRUE(fs::is_symlink(folder.file("link")));
  EXPECT_EQ(read_file(folder.file("sub/old")), "new");
  EXPECT_EQ(mode_of(folder.file("sub/old")), fs::perms(0600));
  EXPECT_FALSE(fs::exists(folder.file("f")));
  write_file_atomically(folder.file("f"), "new");
  fs::create_symlink("/dev/null", folder.file("null"));
  move_into_place(folder.file("f"), folder.file("null"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(File, Extension) {
  EXPECT_EQ(extension("a/b.c/T.ExR"), ".exr");
  EXPECT_EQ(extension("a/b.c/t"), "");
  EXPECT_EQ(extension("t.exr.vdb"), ".vdb");
  EXPECT_EQ(extension(".exr"), "");  // a hidden file without extension
}

}  // namespace
}  // namespace sunbeam
