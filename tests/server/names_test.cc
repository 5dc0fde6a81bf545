#include "server/base/names.h"

#include <gtest/gtest.h>

#include "server/base/readable.h"

namespace rmlcell::server {
namespace {

template <class T>
std::optional<ErrorCode> CodeOf(const Result<T>& result) {
  return result ? std::nullopt : std::optional(result.error().code);
}
constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;

TEST(Names, IdsHaveOneToSixtyThreeLettersDigitsAndDashes) {
  EXPECT_TRUE(CheckResourceId("a", "id"));
  EXPECT_TRUE(CheckResourceId("optimo-1", "id"));
  EXPECT_TRUE(CheckResourceId("a" + std::string(62, '9'), "id"));
  EXPECT_TRUE(CheckResourceId("zaz09-", "id"));
  for (const std::string id : {"", "A", "1", "-a", "`", "{", "a_b", "a.b", "a/b", "a:b", "a`b",
                               "a{b", "a b", "\xC3\xA4", "a\n"}) {
    const Status checked = CheckResourceId(id, "project_id");
    ASSERT_FALSE(checked) << id;
    EXPECT_EQ(checked.error().code, kInvalid);
    EXPECT_TRUE(checked.error().detail.starts_with("project_id: ")) << checked.error().detail;
  }
  EXPECT_FALSE(CheckResourceId("a" + std::string(63, '9'), "id"));
}

TEST(Names, AreReadBackFromWhatIsWritten) {
  EXPECT_EQ(*ParseMachineName(MachineName("optimo-1")), "optimo-1");
  EXPECT_EQ(*ParseProjectName(ProjectName("bracket")), "bracket");
  EXPECT_EQ(*ParseJobName(JobName(17)), 17);
  EXPECT_EQ(*ParseJobName("jobs/9223372036854775807"), INT64_MAX);
  const Result<ProgramName> program = ParseProgramName(NameOfProgram("m", 45));
  ASSERT_TRUE(program);
  EXPECT_EQ(program->machine, "m");
  EXPECT_EQ(program->slot, 45);
  EXPECT_FALSE(program->executable);
  const Result<ScheduleName> schedule = ParseScheduleName(NameOfSchedule("m", 63));
  ASSERT_TRUE(schedule);
  EXPECT_EQ(schedule->machine, "m");
  EXPECT_EQ(schedule->number, 63);
}

TEST(Names, OfAnotherFormAreRefused) {
  for (const std::string name :
       {"", "machines/", "machine/a", "machines/A", "machines/a/", "machines/a/b", "/machines/a",
        "machines//a", " machines/a", "projects/a"}) {
    EXPECT_EQ(CodeOf(ParseMachineName(name)), kInvalid) << name;
  }
  for (const std::string name : {"", "projects/", "projects/a/b", "projects/..", "machines/a"}) {
    EXPECT_EQ(CodeOf(ParseProjectName(name)), kInvalid) << name;
  }
  for (const std::string name :
       {"", "jobs/", "jobs/0", "jobs/-1", "jobs/+1", "jobs/01", "jobs/1 ", "jobs/1.0", "jobs/a",
        "jobs/9223372036854775808", "jobs/1/events", "job/1"}) {
    EXPECT_EQ(CodeOf(ParseJobName(name)), kInvalid) << name;
  }
  for (const std::string name :
       {"", "programs/1", "machines/a/programs/", "machines/a/programs/x", "machines/a/programs/01",
        "machines/A/programs/1", "machines/a/program/1", "machines/a/programs/1/x", "machines/a",
        "machines//programs/1", "machines/a/laserSchedules/1"}) {
    EXPECT_EQ(CodeOf(ParseProgramName(name)), kInvalid) << name;
  }
  for (const std::string name : {"", "machines/a/laserSchedules/", "machines/a/laserSchedules/x",
                                 "machines/a/programs/1", "machines/a/laserSchedules/011"}) {
    EXPECT_EQ(CodeOf(ParseScheduleName(name)), kInvalid) << name;
  }
}

// OPT-1.10, OPT-1.11: slots 1 to 99, the executable of slot n at n + 100.
TEST(Names, ProgramNumbersAreSlotsOrTheirExecutables) {
  struct Case {
    int number;
    int slot;  // 0: neither
    bool executable;
  };
  for (const Case& one :
       {Case{0, 0, false}, Case{1, 1, false}, Case{99, 99, false}, Case{100, 0, false},
        Case{101, 1, true}, Case{199, 99, true}, Case{200, 0, false}, Case{-1, 0, false}}) {
    const Result<ProgramName> name =
        ParseProgramName("machines/m/programs/" + std::to_string(one.number));
    ASSERT_TRUE(name) << one.number;
    EXPECT_EQ(name->number, one.number);
    EXPECT_EQ(name->slot, one.slot);
    if (one.slot != 0) {
      EXPECT_EQ(name->executable, one.executable);
    }
  }
  EXPECT_FALSE(ParseProgramName("machines/m/programs/100")->executable);  // there is no slot 0
}

TEST(Names, AnErrorShowsAReadableBeginningOnly) {
  const Result<std::string> name =
      ParseMachineName("machines/\x1B[2J\xFF" + std::string(1 << 20, 'x'));
  ASSERT_FALSE(name);
  EXPECT_LT(name.error().detail.size(), 200U);
  for (const char c : name.error().detail) EXPECT_TRUE(c >= 0x20 && c < 0x7F);
}

// Of what a client sent 80 bytes are shown; a longer text is seen to be cut.
TEST(Names, EightyBytesAreReadable) {
  EXPECT_EQ(Readable(" a~"), " a~");
  EXPECT_EQ(Readable("\x1F\x7F\xC3\xA4\n"), "?????");
  EXPECT_EQ(Readable(std::string(80, 'x')), std::string(80, 'x'));
  EXPECT_EQ(Readable(std::string(81, 'x')), std::string(80, 'x') + "...");
}

// A title has up to 200 characters, of however many bytes: U+0041, U+00E4, U+20AC, U+1F600.
TEST(Names, TitlesAreCountedInCharacters) {
  for (const std::string character : {"A", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"}) {
    std::string title;
    for (int n = 0; n < 200; ++n) title += character;
    EXPECT_TRUE(CheckTitle(title, "title"));
    const Status longer = CheckTitle(title + character, "programs.title");
    ASSERT_FALSE(longer) << character;
    EXPECT_EQ(longer.error().code, kInvalid);
    EXPECT_EQ(longer.error().detail, "programs.title is longer than 200 characters");
  }
  EXPECT_TRUE(CheckTitle("", "title"));
}

// So has a reason, and it has one at least.
TEST(Names, ReasonsAreCountedInCharacters) {
  for (const std::string character : {"A", "\xC3\xA4"}) {
    std::string reason;
    for (int n = 0; n < 200; ++n) reason += character;
    EXPECT_TRUE(CheckReason(character));
    EXPECT_TRUE(CheckReason(reason));
    const Status longer = CheckReason(reason + character);
    ASSERT_FALSE(longer) << character;
    EXPECT_EQ(longer.error().code, kInvalid);
    EXPECT_EQ(longer.error().detail, "reason: why, in 1 to 200 characters");
  }
  EXPECT_FALSE(CheckReason(""));
}

TEST(Names, EtagsAreRevisionsOfOurs) {
  EXPECT_EQ(*ParseEtag(""), storage::kAnyRevision);
  EXPECT_EQ(*ParseEtag("none"), 0);
  EXPECT_EQ(*ParseEtag("1"), 1);
  EXPECT_EQ(*ParseEtag("9223372036854775807"), INT64_MAX);
  for (const std::string etag :
       {"0", "-1", "01", "+1", "1 ", "NONE", "\"1\"", "W/1", "*", "9223372036854775808"}) {
    EXPECT_EQ(CodeOf(ParseEtag(etag)), ErrorCode::kCellEtagMismatch) << etag;
  }
}

TEST(Names, PagesHaveTheSizeAskedForUpToTheMost) {
  constexpr PageSizes kSizes{.fallback = 50, .max = 1000};
  EXPECT_EQ(CodeOf(PageSize(-1, kSizes)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(*PageSize(0, kSizes), 50);
  EXPECT_EQ(*PageSize(1, kSizes), 1);
  EXPECT_EQ(*PageSize(1000, kSizes), 1000);
  EXPECT_EQ(*PageSize(1001, kSizes), 1000);
}

}  // namespace
}  // namespace rmlcell::server
