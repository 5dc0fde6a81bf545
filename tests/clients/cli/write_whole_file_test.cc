// clients/cli/program_files.h: a file is written whole or not at all.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <iterator>
#include <system_error>

#include "clients/cli/program_files.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

unsigned ModeOf(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 07777U;
}

// No file of this process gets larger than this while it lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

class WriteWholeFileTest : public testing::Test {
 protected:
  static void ExpectUnwritable(const Status& written, const std::string& path) {
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::kCellFileUnwritable);
    EXPECT_TRUE(written.error().detail.starts_with(path + ": ")) << written.error().detail;
  }
  CliFolder folder;
};

TEST_F(WriteWholeFileTest, ANewFileHasAllBytesAndTheModeOfTheUser) {
  const mode_t before = ::umask(027);
  const std::string bytes("a\0b\r\n", 5);
  EXPECT_TRUE(WriteWholeFile(folder.File("new"), bytes));
  EXPECT_TRUE(WriteWholeFile(folder.File("empty"), ""));
  EXPECT_EQ(::umask(before), 027U);  // as it was
  EXPECT_EQ(folder.Read("new"), bytes);
  EXPECT_EQ(folder.Read("empty"), "");
  EXPECT_EQ(ModeOf(folder.File("new")), 0640U);
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("new", "empty"));
}

TEST_F(WriteWholeFileTest, AnotherFileTakesTheModeOfTheOldOne) {
  const std::string path = folder.Put("a.S", "a long text that was there before");
  for (const mode_t mode : {0600U, 0755U, 0666U}) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    EXPECT_TRUE(WriteWholeFile(path, "short"));
    EXPECT_EQ(folder.Read("a.S"), "short");
    EXPECT_EQ(ModeOf(path), mode);
  }
  EXPECT_THAT(folder.Names(), ElementsAre("a.S"));
}

TEST_F(WriteWholeFileTest, ALinkStaysALink) {
  const std::string path = folder.Put("below/a.S", "old");
  const std::string link = folder.File("link.S");
  fs::create_symlink("below/a.S", link);
  EXPECT_TRUE(WriteWholeFile(link, "new"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(fs::read_symlink(link), "below/a.S");
  EXPECT_FALSE(fs::is_symlink(path));
  EXPECT_EQ(folder.Read("below/a.S"), "new");
}

TEST_F(WriteWholeFileTest, ALinkMayLeadToAFileThatIsStillToBeMade) {
  const std::string link = folder.File("link.S");
  fs::create_symlink("a.S", link);
  EXPECT_TRUE(WriteWholeFile(link, "new"));
  EXPECT_EQ(fs::read_symlink(link), "a.S");
  EXPECT_EQ(folder.Read("a.S"), "new");
  const std::string round = folder.File("round.S");
  fs::create_symlink("round.S", round);
  ExpectUnwritable(WriteWholeFile(round, "new"), round);
}

// As many behind each other as the system itself follows.
TEST_F(WriteWholeFileTest, FortyLinksAreFollowed) {
  folder.Put("0", "old");
  for (int n = 1; n <= 41; ++n)
    fs::create_symlink(std::to_string(n - 1), folder.File(std::to_string(n)));
  const std::string farther = folder.File("41");
  const Status refused = WriteWholeFile(farther, "new");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellFileUnwritable);
  EXPECT_EQ(refused.error().detail, farther + ": " + std::generic_category().message(ELOOP));
  EXPECT_EQ(folder.Read("0"), "old");
  EXPECT_TRUE(WriteWholeFile(folder.File("40"), "new"));
  EXPECT_EQ(folder.Read("0"), "new");
  EXPECT_FALSE(fs::is_symlink(folder.File("0")));
  for (int n = 1; n <= 41; ++n) EXPECT_TRUE(fs::is_symlink(folder.File(std::to_string(n)))) << n;
  EXPECT_EQ(folder.Names().size(), 42U);
}

// Nobody may make a file beside it: the name leaves no room for one, whoever runs the test.
TEST_F(WriteWholeFileTest, WhereNoFileCanBeMadeTheOldOneStays) {
  const std::string name(250, 'n');
  const std::string path = folder.Put(name, "old");
  ExpectUnwritable(WriteWholeFile(path, "new"), path);
  EXPECT_EQ(folder.Read(name), "old");
  const std::string nowhere = folder.File("none/a.S");
  ExpectUnwritable(WriteWholeFile(nowhere, "new"), nowhere);
  EXPECT_THAT(folder.Names(), ElementsAre(name));
}

TEST_F(WriteWholeFileTest, AFileThatCannotBeWrittenToItsEndLeavesTheOldOne) {
  const std::string path = folder.Put("a.S", "old");
  {
    const FileSizeLimit limit(4096);
    EXPECT_TRUE(WriteWholeFile(path, std::string(4096, 'x')));
    ExpectUnwritable(WriteWholeFile(path, std::string(4097, 'y')), path);
    ExpectUnwritable(WriteWholeFile(folder.File("b.S"), std::string(4097, 'y')),
                     folder.File("b.S"));
  }
  EXPECT_EQ(folder.Read("a.S"), std::string(4096, 'x'));
  EXPECT_THAT(folder.Names(), ElementsAre("a.S"));
}

TEST_F(WriteWholeFileTest, NoDescriptorIsLeftOpen) {
  const auto descriptors = [] {
    return std::distance(fs::directory_iterator("/proc/self/fd"), {});
  };
  const auto before = descriptors();
  EXPECT_TRUE(WriteWholeFile(folder.File("a.S"), "new"));
  EXPECT_EQ(descriptors(), before);
  {
    const FileSizeLimit limit(4096);
    EXPECT_FALSE(WriteWholeFile(folder.File("a.S"), std::string(4097, 'y')));
  }
  EXPECT_EQ(descriptors(), before);
}

TEST_F(WriteWholeFileTest, APipeTakesTheBytesAndStaysAPipe) {
  const std::string path = folder.File("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);  // or the writer would wait
  ASSERT_GE(reader, 0);
  EXPECT_TRUE(WriteWholeFile(path, "into the pipe"));
  char room[64] = {};
  EXPECT_EQ(::read(reader, room, sizeof room), 13);
  EXPECT_STREQ(room, "into the pipe");
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(path));
  EXPECT_THAT(folder.Names(), ElementsAre("pipe"));
}

// A device of the test's own: a mistake would put a file in the place of the machine's.
TEST_F(WriteWholeFileTest, ADeviceIsWrittenAsItIs) {
  const std::string null = folder.File("null");
  const std::string full = folder.File("full");
  if (::mknod(null.c_str(), S_IFCHR | 0600, ::makedev(1, 3)) != 0 ||
      ::mknod(full.c_str(), S_IFCHR | 0600, ::makedev(1, 7)) != 0) {
    GTEST_SKIP() << "this user may not make devices here";
  }
  const int usable = ::open(null.c_str(), O_WRONLY);
  if (usable < 0) GTEST_SKIP() << "devices do not work here";
  ::close(usable);
  EXPECT_TRUE(WriteWholeFile(null, "bytes"));
  ExpectUnwritable(WriteWholeFile(full, "bytes"), full);
  EXPECT_TRUE(fs::is_character_file(null));
  EXPECT_TRUE(fs::is_character_file(full));
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("null", "full"));
}

TEST_F(WriteWholeFileTest, AFolderIsNoFile) {
  folder.Put("below/a.S", "old");
  const std::string below = folder.File("below");
  ExpectUnwritable(WriteWholeFile(below, "bytes"), below);
  EXPECT_EQ(folder.Read("below/a.S"), "old");
}

}  // namespace
}  // namespace rmlcell::cli
