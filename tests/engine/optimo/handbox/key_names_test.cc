// What the handbox says of a key that it does not have, and of its modes.
#include <string>

#include "tests/engine/core/arguments_text.h"
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

using KeyNames = HandboxTest;

TEST_F(KeyNames, AKeyThatIsNoneIsNamed) {
  Have({});
  const Result<machine::KeyAnswer> answer = machine->PressKey("F99", KeyAction::kTap);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(answer.error().detail, "there is no key F99 on the handbox");
  EXPECT_EQ(rmlcell::ArgumentsText(answer.error().detail), "key='F99'");
}

// LIVE-7.09, OPT-5.14: the radius is a mode of the handbox, too.
TEST_F(KeyNames, EditsTellTheRadiusOfTheirHoles) {
  Have({{12, "ENDTASK\n"}});
  Keys("JOB 1 2 NEXT 1 ENT PATH PREV ENT DEL 7 POINT 5 ENT REC");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0].text_after, "PATH HOLE (7.5)");
  EXPECT_EQ(edits[0].note.modes, "PATH HOLE (7.5) FLY 0");
}

}  // namespace
}  // namespace rmlcell::optimo
