// The teach journal: every edit can be taken back.
#include <cstdint>
#include <map>

#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class Undo : public HandboxTest {
 protected:
  // The edits taken back from the last to the first.
  std::map<int, std::string> Undone(std::map<int, std::string> objects) const {
    for (std::size_t i = edits.size(); i-- > 0;) {
      const machine::ProgramEdit& edit = edits[i];
      const Result<std::string> before = family_.UndoEdit(edit, objects[edit.program]);
      EXPECT_TRUE(before) << before.error().detail << " " << edit.text_before << edit.text_after;
      if (!before) break;
      objects[edit.program] = *before;
      if (before->empty()) objects.erase(edit.program);
    }
    return objects;
  }
  std::map<int, std::string> Objects() const {
    std::map<int, std::string> objects;
    for (const auto& [slot, program] : machine->memory().programs) objects[slot] = *program.object;
    return objects;
  }
};

constexpr const char* kTaught =
    "DECLARE A = VR[1]\n10\n20 A = 5.\nDECLARE B = 7\nCONT 3\n30 MOVE (A,0.,0.,0.,0.)/START (IL[B])/TIME (2.,30)\n"
    "40 GOTO VI[1] (10,20,30)\nDECLARE HALF = PI\nTCP (0.,0.,3./0.,0.,-5.)\nWORKDEF 0,0\n50 ENDTASK\n60\n70\n";

// LIVE-7.09: each kind of edit.
TEST_F(Undo, TakesBackEachKind) {
  Have({{12, kTaught}, {45, "DELAY 1\n"}});
  const std::map<int, std::string> before = Objects();
  Keys(
      "JOB 1 2 NEXT 2 ENT DEL 1 MOV ENT REC JOB 4 5 ENT SHIFT DEL 1 REC DLY ENT REC JOB 7 7 ENT REC DEL 1");
  ASSERT_EQ(edits.size(), 7U);
  EXPECT_NE(Objects(), before);
  EXPECT_EQ(Undone(Objects()), before);
}

// LIVE-7.09: of another program nothing is taken back.
TEST_F(Undo, NeedsTheProgramBehindTheEdit) {
  Have({{12, kTaught}});
  Keys("JOB 1 2 NEXT 2 ENT MOV ENT REC MOV ENT REC");
  ASSERT_EQ(edits.size(), 2U);
  const Result<std::string> wrong = family_.UndoEdit(edits[0], ObjectAt(12));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kCellEtagMismatch);
  const Result<std::string> none = family_.UndoEdit(edits[1], "no object");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kCellEtagMismatch);
  // Somebody else's program came between two edits, and looks the same from outside: what was taken
  // out or put in does not belong there.
  Have({{12, kTaught}});
  Keys("JOB 1 2 NEXT 2 ENT DEL 1 MOV ENT REC");
  const machine::Translation other = family_.Translate({.bytes = "ENDTASK\n"}, parameters(), {});
  for (machine::ProgramEdit edit : edits) {
    edit.object = other.object;
    edit.place = std::max(edit.place, 1) + 1;
    const Result<std::string> before = family_.UndoEdit(edit, other.object);
    ASSERT_FALSE(before);
    EXPECT_EQ(before.error().code, ErrorCode::kCellEtagMismatch);
  }
}

// LIVE-7.09 OPT-B.69: sessions of any keys; undo all is the object before, byte for byte.
TEST_F(Undo, RandomSessions) {
  const std::vector<std::string> keys = {"NEXT",
                                         "NEXT",
                                         "PREV",
                                         "REC",
                                         "REC",
                                         "REC",
                                         "DEL 1",
                                         "DEL 1",
                                         "DEL 0",
                                         "MOV ENT",
                                         "MOV NEXT 1 ENT",
                                         "DLY ENT",
                                         "PATH NEXT ENT",
                                         "PATH PREV ENT ENT",
                                         "DYN NEXT ENT",
                                         "OUT 1 1 NEXT 1 ENT",
                                         "WORK ENT NEXT ENT ENT",
                                         "WORK ENT ENT",
                                         "START ENT 4 6 ENT",
                                         "F2 ENT",
                                         "F3 4 4 ENT ENT 0",
                                         "SHIFT F3 NEXT ENT ENT",
                                         "TCP ENT",
                                         "F8 1 0 ENT",
                                         "JOB 1 2 NEXT 3 ENT",
                                         "JOB 4 5 ENT",
                                         "JOB 7 7 ENT",
                                         "SHIFT NEXT",
                                         "SHIFT DEL 1",
                                         "ERR",
                                         "HOLD X+",
                                         "HOLD B-",
                                         "HOLD Z-"};
  std::uint32_t random = 12345;
  std::size_t all = 0;
  for (int session = 0; session < 40; ++session) {
    edits.clear();
    Have({{12, kTaught}, {45, "DELAY 1\nENDTASK\n"}});
    const std::map<int, std::string> before = Objects();
    Keys("JOB 1 2 NEXT 2 ENT");
    for (int i = 0; i < 300; ++i) {
      random = random * 1664525U + 1013904223U;
      const std::string& next = keys[(random >> 8U) % keys.size()];
      if (next.starts_with("HOLD")) {
        Hold(next.substr(5), 0.1);
      } else {
        Keys(next);
      }
      Shows();
    }
    all += edits.size();
    EXPECT_EQ(Undone(Objects()), before) << "session " << session;
  }
  EXPECT_GT(all, 500U);
}

}  // namespace
}  // namespace rmlcell::optimo
