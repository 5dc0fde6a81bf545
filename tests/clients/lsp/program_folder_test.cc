#include "clients/lsp/program_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace rmlcell::lsp {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kExtensions = {".S", ".SI", ".CMP"};

TEST(ProgramFolder, PathsAndUrisGoBothWays) {
  for (const char* path : {"/work/12.S", "/a b/\xC3\xA4%20?#.S", "/"})
    EXPECT_EQ(PathOfUri(UriOfPath(path)), path);
  EXPECT_EQ(UriOfPath("/a b.S"), "file:///a%20b.S");
  EXPECT_EQ(PathOfUri("file://host/a%2Fb.S"), "/a/b.S");
  EXPECT_EQ(PathOfUri("file:///a.S?x#y"), "/a.S");
  EXPECT_EQ(PathOfUri("untitled:Untitled-1"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///a%2"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///a%zz"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///a%00b"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///%0F%F0%f0%aF%09%90"), "/\x0F\xF0\xF0\xAF\x09\x90");
  EXPECT_EQ(PathOfUri("file:///%AG"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///%g0"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///%:0"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///%0/"), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///a%41"), "/aA");
  EXPECT_EQ(PathOfUri("file:///a%4"), std::nullopt);
  EXPECT_EQ(PathOfUri("file://host"), std::nullopt);
  EXPECT_EQ(UriOfPath("/azAZ09-._~"), "file:///azAZ09-._~");
  EXPECT_EQ(UriOfPath("/@[`{:\x7F\xFF"), "file:///%40%5B%60%7B%3A%7F%FF");
}

// OPT-1.10
TEST(ProgramFolder, AProgramNumberIsTheWholeNameFrom1To99) {
  EXPECT_EQ(ProgramNumberOf("file:///work/44.S", kExtensions), 44);
  EXPECT_EQ(ProgramNumberOf("/work/007.si", kExtensions), 7);
  EXPECT_EQ(ProgramNumberOf("44.CMP", kExtensions), 44);
  EXPECT_EQ(ProgramNumberOf("1.S", kExtensions), 1);
  EXPECT_EQ(ProgramNumberOf("99.S", kExtensions), 99);
  for (const char* name :
       {"0.S", "100.S", "44.O", "44.rml", "44", "a44.S", "4 4.S", "-4.S", ".S", ""})
    EXPECT_EQ(ProgramNumberOf(name, kExtensions), std::nullopt) << name;
}

class OnDisk : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "lsp-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }
  void Write(const std::string& name, std::string_view text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string Uri(const std::string& name) { return UriOfPath((folder_ / name).string()); }

  fs::path folder_;
  DiskFolder disk_;
};

TEST_F(OnDisk, ProgramsOfTheFolderAreOrderedByNumberAndForm) {
  for (const char* name : {"44.CMP", "44.S", "7.SI", "100.S", "notes.txt", "12.O"})
    Write(name, "x");
  fs::create_directory(folder_ / "9.S");
  EXPECT_EQ(
      disk_.Programs(Uri("12.S"), kExtensions),
      (std::vector<machine::NumberedFile>{
          {7, Uri("7.SI"), "7.SI"}, {44, Uri("44.S"), "44.S"}, {44, Uri("44.CMP"), "44.CMP"}}));
  EXPECT_TRUE(disk_.Programs("untitled:1", kExtensions).empty());
  EXPECT_TRUE(disk_.Programs(UriOfPath("/nowhere/at/all/12.S"), kExtensions).empty());
}

TEST_F(OnDisk, FilesAreReadUpToALimitAndNothingElseIs) {
  Write("44.S", std::string("a\0b\xFF", 4));
  EXPECT_EQ(*disk_.Read(Uri("44.S")), std::string("a\0b\xFF", 4));
  Write("45.S", std::string(kProgramBytesMax, 'x'));
  EXPECT_TRUE(disk_.Read(Uri("45.S")));
  Write("46.S", std::string(kProgramBytesMax + 1, 'x'));
  EXPECT_EQ(disk_.Read(Uri("46.S")).error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(disk_.Read(Uri("47.S")).error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(disk_.Read(Uri("")).error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(disk_.Read("untitled:1").error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(disk_.Read(Uri("47.S")).error().detail, (folder_ / "47.S").string());
  Write("49.S", "");
  EXPECT_EQ(*disk_.Read(Uri("49.S")), "");
  ASSERT_EQ(mkfifo((folder_ / "48.S").c_str(), 0600), 0);
  EXPECT_EQ(disk_.Read(Uri("48.S")).error().code,
            ErrorCode::kCellFileUnreadable);  // and no waiting
}

// What opens cannot always be read: the kernel knows no speed of the network inside of a machine.
TEST_F(OnDisk, AFileWhoseReadingFailsIsRefused) {
  const std::string path = "/sys/class/net/lo/speed";
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  char byte = 0;
  const bool fails = file >= 0 && ::read(file, &byte, 1) < 0;
  if (file >= 0) ::close(file);
  if (!fails) GTEST_SKIP() << "no such file is known here";
  const Result<std::string> text = disk_.Read(UriOfPath(path));
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(text.error().detail, path);
}

// The kernel says of its files that they are longer than what is in them.
TEST_F(OnDisk, AFileThatIsShorterThanItsSizeIsReadToItsEnd) {
  const std::string path = "/sys/class/net/lo/mtu";
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || bytes.empty() || size <= bytes.size()) GTEST_SKIP() << "no such file is known here";
  const Result<std::string> text = disk_.Read(UriOfPath(path));
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, bytes);
}

// A folder may be large: 20,000 names are looked at, whatever they are.
TEST_F(OnDisk, TwentyThousandNamesAreLookedAt) {
  std::string zeros;
  std::size_t made = 0;
  while (made <= kFolderEntriesMax) {  // "1.S" to "99.S", "01.S" to "099.S" ...
    for (int number = 1; number <= 99 && made <= kFolderEntriesMax; ++number, ++made)
      Write(zeros + std::to_string(number) + ".S", "");
    zeros += '0';
  }
  EXPECT_EQ(disk_.Programs(Uri("12.S"), kExtensions).size(), kFolderEntriesMax);
}

}  // namespace
}  // namespace rmlcell::lsp
