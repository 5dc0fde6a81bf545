// Mice that tell more, less or other numbers than three, on the button of a key.
#include <gtest/gtest.h>

#include <string>

#include "clients/cli/handbox_keys.h"
#include "clients/cli/terminal_bytes.h"

namespace rmlcell::cli {
namespace {

// How many events come of it.
std::size_t EventsOf(const std::string& bytes) { return TerminalBytes().Read(bytes).size(); }

// LIVE-7.11
TEST(BytesOfAMouse, HaveThreeNumbers) {
  const HandboxKey& jog = *HandboxKeyTyped("x");
  const std::string column = std::to_string(jog.cell * kHandboxCell + 2),
                    row = std::to_string(jog.row + 1), place = column + ";" + row;
  EXPECT_EQ(EventsOf("\x1b[<0;" + place + "M"), 1U);
  EXPECT_EQ(EventsOf("\x1b[<0;" + place + "m"), 1U);
  for (const std::string last : {"M", "m"}) {
    EXPECT_EQ(EventsOf("\x1b[<0;" + place + ";1" + last), 0U);
    EXPECT_EQ(EventsOf("\x1b[<0;" + column + last), 0U);
    EXPECT_EQ(EventsOf("\x1b[<;" + place + last), 0U);
    for (const std::string wrong : {"-1", "10001", "4294967298", "1.5"}) {
      EXPECT_EQ(EventsOf("\x1b[<" + wrong + ";" + place + last), 0U) << wrong;
      EXPECT_EQ(EventsOf("\x1b[<0;" + wrong + ";" + row + last), 0U) << wrong;
      EXPECT_EQ(EventsOf("\x1b[<0;" + column + ";" + wrong + last), 0U) << wrong;
    }
  }
}

}  // namespace
}  // namespace rmlcell::cli
