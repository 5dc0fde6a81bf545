// What an editor asks over the API (proto/rmlcell/v1/language.proto): places, the programs of a
// machine around a text, and what is refused. What is said about RML itself has tests of its own.
#include "server/programs/language_tools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "server/base/config.h"
#include "server/programs/edited_text.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kText =
    "DECLARE WAY = 5\n"
    "10 VR[1] = WAY\n"
    "CALL 44\n"
    "GOTO 10\n";

class LanguageToolsTest : public testing::Test {
 protected:
  LanguageToolsTest() {
    EXPECT_TRUE(programs.Store({.name = "machines/optimo-1/programs/44",
                                .file_name = "44.S",
                                .bytes = "; the helper\nDELAY 1\n"}));
    Must(bed.store().PutSchedule({.machine = "optimo-1",
                                  .number = 7,
                                  .name = "thin",
                                  .mode = "PULSE",
                                  .power_percent = 40.0},
                                 0));
  }
  static v1::EditedText Text(const std::string& content = kText,
                             const std::string& machine = "machines/optimo-1") {
    v1::EditedText text;
    text.mutable_program()->set_file_name("45.S");
    text.mutable_program()->set_content(content);
    text.set_machine(machine);
    return text;
  }
  template <class Request>
  static Request At(int line, int column, const v1::EditedText& text = Text()) {
    Request request;
    *request.mutable_text() = text;
    request.mutable_position()->set_line(line);
    request.mutable_position()->set_column(column);
    return request;
  }
  // "1:9-1:12", with the program in front where it is another.
  static std::string Word(const v1::TextRange& range) {
    const auto place = [](const v1::TextPosition& at) {
      return std::to_string(at.line()) + ":" + std::to_string(at.column());
    };
    return place(range.begin()) + "-" + place(range.end());
  }
  static std::vector<std::string> Words(
      const google::protobuf::RepeatedPtrField<v1::TextLocation>& found) {
    std::vector<std::string> words;
    for (const v1::TextLocation& one : found)
      words.push_back((one.program().empty() ? "" : one.program() + " ") + Word(one.range()));
    return words;
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  LanguageTools tools{bed.store(), programs};
};

TEST_F(LanguageToolsTest, WordsOfBothLanguages) {
  v1::GetLanguageRequest request;
  request.set_family("optimo");
  const auto optimo = Must(tools.Words(request));
  const auto move = std::ranges::find(optimo.words(), "MOVE", &v1::LanguageWord::name);
  ASSERT_NE(move, optimo.words().end());
  EXPECT_THAT(move->syntax(), HasSubstr("MOVE (X, Y, Z"));
  EXPECT_THAT(move->rule(), HasSubstr("OPT-"));
  std::set<std::string> rules;
  for (const v1::LanguageWord& word : optimo.words()) rules.insert(word.rule());
  EXPECT_EQ(rules.size(), 75U);  // OPT-W.01 to W.75
  request.set_family("rml1");
  const auto mill = Must(tools.Words(request));
  const auto down = std::ranges::find(mill.words(), "PD", &v1::LanguageWord::name);
  ASSERT_NE(down, mill.words().end());
  EXPECT_EQ(down->syntax(), "PD x,y,...");
  EXPECT_EQ(down->rule(), "RML1-3B.13");
  for (const v1::LanguageWord& word : mill.words()) EXPECT_NE(word.description(), "");
  EXPECT_TRUE(std::ranges::is_sorted(mill.words(), {}, &v1::LanguageWord::name));
  request.set_family("lathe");
  EXPECT_EQ(CodeOf(tools.Words(request)), ErrorCode::kCellUnknownFamily);
}

TEST_F(LanguageToolsTest, HoverTellsOfAWordAndOfTheProgramThatIsCalled) {
  const auto name = Must(tools.Hover(At<v1::HoverRequest>(2, 13)));
  EXPECT_THAT(name.text(), HasSubstr("5"));
  EXPECT_EQ(Word(name.range()), "2:12-2:15");
  const auto called = Must(tools.Hover(At<v1::HoverRequest>(3, 7)));
  EXPECT_THAT(called.text(), HasSubstr("the helper"));
  // Without a machine nothing lies around.
  const auto alone = Must(tools.Hover(At<v1::HoverRequest>(3, 7, Text(kText, ""))));
  EXPECT_THAT(alone.text(), Not(HasSubstr("the helper")));
}

TEST_F(LanguageToolsTest, HoverOfAScheduleHasTheOneOfTheMachine) {
  const v1::EditedText text = Text("WORKDEF 2,0 (7)\n");
  EXPECT_THAT(Must(tools.Hover(At<v1::HoverRequest>(1, 3, text))).text(),
              HasSubstr("PULSE, 40 %, thin"));
}

TEST_F(LanguageToolsTest, DefinitionAndReferences) {
  EXPECT_THAT(Words(Must(tools.FindDefinition(At<v1::FindDefinitionRequest>(2, 12))).definitions()),
              ElementsAre("1:9-1:12"));
  auto request = At<v1::FindReferencesRequest>(1, 9);
  EXPECT_THAT(Words(Must(tools.FindReferences(request)).references()),
              ElementsAre("1:9-1:12", "2:12-2:15"));
  request.set_uses_only(true);
  EXPECT_THAT(Words(Must(tools.FindReferences(request)).references()), ElementsAre("2:12-2:15"));
  // A called program is defined elsewhere.
  const auto called = Must(tools.FindDefinition(At<v1::FindDefinitionRequest>(3, 6)));
  ASSERT_EQ(called.definitions_size(), 1);
  EXPECT_EQ(called.definitions(0).program(), "machines/optimo-1/programs/44");
  EXPECT_EQ(called.definitions(0).range().begin().line(), 1);
}

TEST_F(LanguageToolsTest, CompletionsSayWhatTheyReplace) {
  const auto found = Must(tools.Complete(At<v1::CompleteRequest>(1, 3, Text("MO\n"))));
  EXPECT_EQ(Word(found.typed()), "1:1-1:3");
  const auto move = std::ranges::find(found.completions(), "MOVE", &v1::Completion::label);
  ASSERT_NE(move, found.completions().end());
  EXPECT_EQ(move->kind(), v1::Completion::KIND_WORD);
  EXPECT_THAT(move->detail(), HasSubstr("MOVE"));
  EXPECT_NE(move->description(), "");
  // Programs of the machine behind CALL.
  const auto called = Must(tools.Complete(At<v1::CompleteRequest>(1, 6, Text("CALL \n"))));
  const auto program = std::ranges::find(called.completions(), "44", &v1::Completion::label);
  ASSERT_NE(program, called.completions().end());
  EXPECT_EQ(program->kind(), v1::Completion::KIND_PROGRAM);
  // Sequence numbers of the text behind GOTO.
  const auto jumps = Must(tools.Complete(At<v1::CompleteRequest>(4, 6)));
  const auto jump = std::ranges::find(jumps.completions(), "10", &v1::Completion::label);
  ASSERT_NE(jump, jumps.completions().end());
  EXPECT_EQ(jump->kind(), v1::Completion::KIND_SEQUENCE_NUMBER);
}

// OPT-1.10: those of the first and of the last slot among them.
TEST_F(LanguageToolsTest, BehindACallAllProgramsAreOffered) {
  for (const std::string slot : {"1", "99"}) {
    EXPECT_TRUE(programs.Store({.name = "machines/optimo-1/programs/" + slot,
                                .file_name = slot + ".S",
                                .bytes = "DELAY 1\n"}));
  }
  std::vector<std::string> offered;
  const auto found = Must(tools.Complete(At<v1::CompleteRequest>(1, 6, Text("CALL \n"))));
  for (const v1::Completion& one : found.completions()) {
    if (one.kind() == v1::Completion::KIND_PROGRAM) offered.push_back(one.label());
  }
  EXPECT_THAT(offered, testing::UnorderedElementsAre("1", "44", "99"));
}

TEST_F(LanguageToolsTest, RenameGivesWhatToReplaceOrWhyNot) {
  auto request = At<v1::RenameRequest>(1, 10);
  request.set_name("DISTANCE");
  const auto renamed = Must(tools.Rename(request));
  ASSERT_EQ(renamed.fixes_size(), 2);
  EXPECT_EQ(renamed.fixes(0).byte_offset(), 8);
  EXPECT_EQ(renamed.fixes(0).length(), 3);
  EXPECT_EQ(renamed.fixes(0).text(), "DISTANCE");
  EXPECT_EQ(renamed.fixes(1).byte_offset(), 27);
  request.set_name("MOVE");
  const auto refused = tools.Rename(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_NE(refused.error().detail, "");
}

TEST_F(LanguageToolsTest, OutlineHasPartsWithTheirPlaces) {
  v1::OutlineRequest request;
  *request.mutable_text() = Text();
  const auto outline = Must(tools.Outline(request));
  const auto label = std::ranges::find(outline.parts(), "10", &v1::OutlinePart::name);
  ASSERT_NE(label, outline.parts().end());
  EXPECT_EQ(label->kind(), v1::OutlinePart::KIND_SEQUENCE_NUMBER);
  EXPECT_EQ(label->name_range().begin().line(), 2);
}

TEST_F(LanguageToolsTest, WhatIsRefused) {
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(0, 1))), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(6, 1))), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(1, 1, Text("")))),
            ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(1, 1, Text(kText, "machines/none")))),
            ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(1, 1, Text(kText, "none")))),
            ErrorCode::kCellInvalidArgument);
  // Streams are not written by hand.
  const auto stream = tools.Hover(At<v1::HoverRequest>(1, 1, Text("PU;", "machines/mill-1")));
  ASSERT_FALSE(stream);
  EXPECT_EQ(stream.error().code, ErrorCode::kCellPrecondition);
  v1::EditedText nameless = Text(kText, "");
  nameless.mutable_program()->clear_file_name();
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(1, 1, nameless))),
            ErrorCode::kCellFamilyUnknownFromName);
  nameless.set_family("optimo");
  EXPECT_TRUE(tools.Hover(At<v1::HoverRequest>(1, 1, nameless)));
  nameless.set_family("lathe");
  EXPECT_EQ(CodeOf(tools.Hover(At<v1::HoverRequest>(1, 1, nameless))),
            ErrorCode::kCellUnknownFamily);
}

// Each of them refuses a place that is not in the text, and a machine that is not there.
TEST_F(LanguageToolsTest, WhatEachOfThemRefuses) {
  const auto codes = [this](int line, const v1::EditedText& text) {
    auto rename = At<v1::RenameRequest>(line, 9, text);
    rename.set_name("OTHER");
    v1::OutlineRequest outline;
    *outline.mutable_text() = text;
    std::vector<std::optional<ErrorCode>> told = {
        CodeOf(tools.Complete(At<v1::CompleteRequest>(line, 9, text))),
        CodeOf(tools.FindDefinition(At<v1::FindDefinitionRequest>(line, 9, text))),
        CodeOf(tools.FindReferences(At<v1::FindReferencesRequest>(line, 9, text))),
        CodeOf(tools.Rename(rename))};
    if (line > 0) told.push_back(CodeOf(tools.Outline(outline)));
    return told;
  };
  EXPECT_THAT(codes(1, Text()), testing::Each(std::optional<ErrorCode>()));
  EXPECT_THAT(codes(0, Text()), testing::Each(std::optional(ErrorCode::kCellInvalidArgument)));
  EXPECT_THAT(codes(1, Text(kText, "machines/none")),
              testing::Each(std::optional(ErrorCode::kCellUnknownMachine)));
}

// Of an empty line nothing is told; a schedule that the machine has not is as none.
TEST_F(LanguageToolsTest, HoverOfNothing) {
  const auto empty = Must(tools.Hover(At<v1::HoverRequest>(1, 1, Text("\nSTOP\n"))));
  EXPECT_EQ(empty.text(), "");
  EXPECT_FALSE(empty.has_range());
  const auto of_schedule = [this](const std::string& number, const std::string& machine) {
    const v1::EditedText text = Text("WORKDEF 2,0 (" + number + ")\n", machine);
    return Must(tools.Hover(At<v1::HoverRequest>(1, 3, text))).text();
  };
  EXPECT_EQ(of_schedule("8", "machines/optimo-1"), of_schedule("8", ""));
  EXPECT_NE(of_schedule("7", "machines/optimo-1"), of_schedule("7", ""));
}

// Without a store nothing lies around the text, and what is in it is told all the same.
TEST_F(LanguageToolsTest, WhatCannotBeReadDoesNotLieAround) {
  FailingStore store(bed.store());
  ProgramBook read(store, config);
  LanguageTools failing(store, read);
  const auto hover = At<v1::HoverRequest>(3, 7);
  for (int call = 1; call <= 2; ++call) {  // whether there is such a machine, and of which family
    store.FailAt(call);
    EXPECT_EQ(CodeOf(failing.Hover(hover)), ErrorCode::kCellStoreFailed) << call;
  }
  const auto work = At<v1::HoverRequest>(1, 3, Text("WORKDEF 2,0 (7)\n"));
  for (int call = 3; call <= 5; ++call) {
    store.FailAt(call);
    EXPECT_TRUE(failing.Hover(hover)) << call;
    store.FailAt(call);
    EXPECT_TRUE(failing.Hover(work)) << call;
  }
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 46, .object = "no object"}}, {}));
  EXPECT_TRUE(tools.Hover(At<v1::HoverRequest>(1, 6, Text("CALL 46\n"))));
}

// Columns count bytes from 1, or UTF-16 units from 0, as browsers do.
TEST(TextPlacesOf, BytesAndUtf16) {
  const std::string text = "a\xC3\xA4\xF0\x9F\x99\x82z\nb";  // a ä 🙂 z
  const TextPlaces places(text);
  const auto offset = [&](int line, int column, int utf16) {
    v1::TextPosition position;
    position.set_line(line);
    position.set_column(column);
    position.set_utf16_column(utf16);
    return Must(places.OffsetOf(position));
  };
  EXPECT_EQ(offset(1, 1, 99), 0U);  // the column in bytes counts
  EXPECT_EQ(offset(1, 8, 0), 7U);
  EXPECT_EQ(offset(1, 0, 0), 0U);
  EXPECT_EQ(offset(1, 0, 2), 3U);
  EXPECT_EQ(offset(1, 0, 4), 7U);
  EXPECT_EQ(offset(1, 0, 99), 8U);  // the end of the line
  EXPECT_EQ(offset(1, 99, 0), 8U);
  EXPECT_EQ(offset(2, 1, 0), 9U);
  const v1::TextPosition z = places.PositionOf(7);
  EXPECT_EQ(z.line(), 1);
  EXPECT_EQ(z.column(), 8);
  EXPECT_EQ(z.utf16_column(), 4);
}

}  // namespace
}  // namespace rmlcell::server
