#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

// "12.S 3:0" for each location: file, line and character.
std::vector<std::string> Places(const Json& locations) {
  std::vector<std::string> places;
  for (const Json& location : locations) {
    const Json& start = location["range"]["start"];
    places.push_back(FileNameOfUri(location["uri"].get<std::string>()) + " " +
                     std::to_string(start["line"].get<int>()) + ":" +
                     std::to_string(start["character"].get<int>()));
  }
  return places;
}
std::vector<std::string> DefinitionOf(std::string_view marked, Editor& editor) {
  return Places(editor.At("textDocument/definition", marked)["result"]);
}
std::vector<std::string> DefinitionOf(std::string_view marked) {
  Editor editor;
  return DefinitionOf(marked, editor);
}
std::vector<std::string> ReferencesOf(std::string_view marked, bool declaration, Editor& editor) {
  return Places(editor.At("textDocument/references", marked,
                          {{"context", {{"includeDeclaration", declaration}}}})["result"]);
}
using Strings = std::vector<std::string>;

// OPT-7.15, OPT-1.25
TEST(Navigation, AJumpLeadsToItsSequenceNumber) {
  EXPECT_EQ(DefinitionOf("GOTO 1|0\nSPEED 5\n  010 SPEED 6\n"), Strings{"12.S 2:2"});
  EXPECT_EQ(DefinitionOf("IF VL[0] THEN 5 ELSE |6\n5 STOP\n6 STOP\n"), Strings{"12.S 2:0"});
  EXPECT_EQ(DefinitionOf("MOVE (1,2,3,0,0)/TIME (2.,9|00)\n900 RETURN\n"), Strings{"12.S 1:0"});
  EXPECT_EQ(DefinitionOf("GOTO 9|9\n"), Strings{});
}

// OPT-7.44, OPT-7.46
TEST(Navigation, ANameLeadsToItsDeclare) {
  EXPECT_EQ(DefinitionOf("; \xC3\xA4\n DECLARE XHOME = 10.5\nVR[0] = XH|OME + 1\n"),
            Strings{"12.S 1:9"});
  EXPECT_EQ(DefinitionOf("DECLARE POSITION1 = 5\nVR[POSITION|9] = 1\n"), Strings{"12.S 0:8"});
  EXPECT_EQ(DefinitionOf("VR[0] = NO|NE\n"), Strings{});
}

// OPT-7.07, OPT-9.01
TEST(Navigation, ACallLeadsToTheFileOfTheProgram) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "SPEED 5\n";
  editor.folder.files["file:///elsewhere/45.S"] = "SPEED 5\n";
  EXPECT_EQ(DefinitionOf("CALL 4|4\n", editor), Strings{"44.S 0:0"});
  EXPECT_EQ(DefinitionOf("FUNCTION 0|44\n", editor), Strings{"44.S 0:0"});
  EXPECT_EQ(DefinitionOf("CALL 4|5\n", editor), Strings{});
  EXPECT_EQ(DefinitionOf("DECLARE RECT = 44\nFUNCTION RE|CT\n", editor),
            (Strings{"12.S 0:8", "44.S 0:0"}));
  EXPECT_EQ(DefinitionOf("DECLARE RECT = 44\nFUNCTION 44 (RE|CT)\n", editor), Strings{"12.S 0:8"});
}

// OPT-3.11: the nearest one before.
TEST(Navigation, AWorkLeadsToItsWorkdef) {
  EXPECT_EQ(DefinitionOf("WORKDEF 1,0 (1,2,3,4)\nWORKDEF 1,0 (2,2,3,4)\nWO|RK 1,0/ON\n"),
            Strings{"12.S 1:0"});
  EXPECT_EQ(DefinitionOf("WORKDEF 1,1 (1,2,3,4)\nWORKDEF 2,0 (5)\nWO|RK 1,0/ON\nWORKDEF 1,0 "
                         "(2,2,3,4)\nWORKDEF 1,0 (3,2,3,4)\n"),
            Strings{"12.S 3:0"});
  EXPECT_EQ(DefinitionOf("WORKDEF 1,0 (1,2,3,4)\nWORK 1,0/O|N\n"), Strings{});
  EXPECT_EQ(DefinitionOf("WORK|DEF 1,0 (1,2,3,4)\n"), Strings{});
  // WORK where a value is still to be written uses nothing.
  EXPECT_EQ(DefinitionOf("WORKDEF 1,0 (1,2,3,4)\nWORKDEF 1,0 (5,6, WO|RK\n"), Strings{});
}

TEST(Navigation, ReferencesAreTheSequenceNumberAndItsJumps) {
  Editor editor;
  constexpr const char* kText = "10 GOTO 10\nGOSUB 1|0\nDELAY 10\nERR 20 ; GOTO 10\n";
  EXPECT_EQ(ReferencesOf(kText, true, editor), (Strings{"12.S 0:0", "12.S 0:8", "12.S 1:6"}));
  EXPECT_EQ(ReferencesOf(kText, false, editor), (Strings{"12.S 0:8", "12.S 1:6"}));
}

TEST(Navigation, ReferencesOfNamesAndVariables) {
  Editor editor;
  EXPECT_EQ(ReferencesOf("DECLARE X = VR[5]\nX = |x + VR[5]\n", true, editor),
            (Strings{"12.S 0:8", "12.S 1:0", "12.S 1:4"}));
  EXPECT_EQ(ReferencesOf("DECLARE X = VR[5]\nX = x + VR[|05]\n", true, editor),
            (Strings{"12.S 0:12", "12.S 1:8"}));
  // Of the group and of the index.
  EXPECT_EQ(ReferencesOf("VR[|5] = VI[5]\nVR[6] = VR[5]\n", true, editor),
            (Strings{"12.S 0:0", "12.S 1:8"}));
}

TEST(Navigation, ReferencesOfAProgramAreThoseOfItsFolder) {
  Editor editor;
  editor.folder.files["file:///work/12.S"] = "CALL 44 ; on the disk, older\n";
  editor.folder.files["file:///work/13.S"] = "SPEED 5\nFUNCTION 44\n";
  editor.folder.files["file:///work/44.S"] = "CALL 45\n";
  editor.Open("\n\nGO 44\n", "file:///work/14.S");
  editor.folder.files["file:///work/14.S"] = "GO 45\n";
  EXPECT_EQ(ReferencesOf("\nCALL 4|4\n", true, editor),
            (Strings{"12.S 1:5", "13.S 1:9", "14.S 2:3"}));
}

// Slots begin with 1.
TEST(Navigation, ReferencesOfAProgramAreThoseOfTheFirstSlotToo) {
  Editor editor;
  editor.folder.files["file:///work/1.S"] = "CALL 44\n";
  editor.folder.files["file:///work/2.S"] = "SPEED 5\n";
  EXPECT_EQ(ReferencesOf("CALL 4|4\n", true, editor), (Strings{"12.S 0:5", "1.S 0:5"}));
}

// Of several files for one number the first is the program.
TEST(Navigation, ReferencesOfAProgramAreNotThoseOfItsOtherForms) {
  Editor editor;
  for (const char* name : {"13.S", "13.SI", "14.SI"})
    editor.folder.files[std::string("file:///work/") + name] = "CALL 44\n";
  EXPECT_EQ(ReferencesOf("CALL 4|4\n", true, editor),
            (Strings{"12.S 0:5", "13.S 0:5", "14.SI 0:5"}));
}

// The text that is open is one of its folder, in whatever escapes its address is written there.
TEST(Navigation, ReferencesOfAProgramAreToldOnce) {
  Editor editor;
  editor.folder.files["file:///work/%31%32.S"] = "CALL 44 ; on the disk, older\n";
  editor.folder.files["file:///work/13.S"] = "CALL 44\n";
  EXPECT_EQ(ReferencesOf("\nCALL 4|4\n", true, editor), (Strings{"12.S 1:5", "13.S 0:5"}));
  // A name that stands for no program leads to none.
  EXPECT_EQ(DefinitionOf("CALL NO|NE\n", editor), Strings{});
}

TEST(Navigation, HighlightsTellWritingFromReading) {
  Editor editor;
  const Json found =
      editor.At("textDocument/documentHighlight", "DECLARE X = 1\nVR[0] = |X\n")["result"];
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]["kind"], 3);
  EXPECT_EQ(found[1]["kind"], 2);
}

}  // namespace
}  // namespace rmlcell::lsp
