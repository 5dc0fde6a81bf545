#include "clients/cli/terminal_bytes.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace rmlcell::cli {
namespace {

using Kind = TerminalEvent::Kind;

// "X+ /down:X+ /up": what is told, in order.
std::string EventsText(const std::vector<TerminalEvent>& events) {
  const std::map<Kind, std::string> kKinds = {{Kind::kTyped, ""},      {Kind::kMouseDown, "/down:"},
                                              {Kind::kMouseUp, "/up"}, {Kind::kAnswers, "/answers"},
                                              {Kind::kLeft, "/left"},  {Kind::kQuit, "/quit"}};
  std::string told;
  for (const TerminalEvent& event : events) {
    told += (told.empty() ? "" : " ") + kKinds.at(event.kind);
    if (event.key != nullptr) told += event.key->name;
  }
  return told;
}

std::string Of(std::string_view bytes) { return EventsText(TerminalBytes().Read(bytes)); }

std::string ByteByByte(std::string_view bytes) {
  TerminalBytes reader;
  std::vector<TerminalEvent> events;
  for (const char byte : bytes) {
    for (const TerminalEvent& event : reader.Read(std::string_view(&byte, 1)))
      events.push_back(event);
  }
  EXPECT_FALSE(reader.begun());
  return EventsText(events);
}

// What terminals send for keys that are no character.
const std::multimap<std::string_view, std::string_view> kSent = {
    {"Spc", " "},       {"Tab", "\t"},       {"Ent", "\r"},      {"Ent", "\n"},
    {"Hom", "\x1b[H"},  {"Hom", "\x1bOH"},   {"Hom", "\x1b[1~"}, {"Hom", "\x1b[7~"},
    {"Del", "\x1b[3~"}, {"Bsp", "\x7f"},     {"Bsp", "\b"},      {"Up", "\x1b[A"},
    {"Down", "\x1bOB"}, {"Right", "\x1b[C"}, {"Left", "\x1b[D"}, {"PgU", "\x1b[5~"},
    {"PgD", "\x1b[6~"}, {"F1", "\x1bOP"},    {"F1", "\x1b[11~"}, {"F1", "\x1b[[A"},
    {"F2", "\x1bOQ"},   {"F3", "\x1bOR"},    {"F4", "\x1bOS"},   {"F4", "\x1b[14~"},
    {"F5", "\x1b[15~"}, {"F5", "\x1b[[E"},   {"F6", "\x1b[17~"}, {"F7", "\x1b[18~"},
    {"F8", "\x1b[19~"}};

// LIVE-7.03, LIVE-7.11
TEST(TerminalBytes, ReachEveryKeyByKeyboard) {
  for (const HandboxKey& key : AllHandboxKeys()) {
    for (const std::string_view typed : {key.typed, key.also}) {
      if (typed.empty()) continue;
      const auto [begin, end] = kSent.equal_range(typed);
      if (begin == end) {
        ASSERT_EQ(typed.size(), 1U) << typed;
        EXPECT_EQ(Of(typed), key.name);
      }
      for (auto sent = begin; sent != end; ++sent) {
        EXPECT_EQ(Of(sent->second), key.name) << typed;
        EXPECT_EQ(ByteByByte(sent->second), key.name) << typed;
      }
    }
  }
}

std::string Mouse(int button, int row, int column, char last) {
  return "\x1b[<" + std::to_string(button) + ";" + std::to_string(column + 1) + ";" +
         std::to_string(row + 1) + last;
}

// LIVE-7.11
TEST(TerminalBytes, ReachEveryKeyByMouse) {
  for (const HandboxKey& key : AllHandboxKeys()) {
    for (const int column : {key.cell * kHandboxCell, (key.cell + key.cells) * kHandboxCell - 1}) {
      const std::string click = Mouse(0, key.row, column, 'M') + Mouse(0, key.row, column, 'm');
      const std::string told = "/down:" + std::string(key.name) + " /up";
      EXPECT_EQ(Of(click), told);
      EXPECT_EQ(ByteByByte(click), told);
    }
  }
}

TEST(TerminalBytes, KnowOneButtonOfTheMouse) {
  const HandboxKey& start = *HandboxKeyTyped("s");
  const int column = start.cell * kHandboxCell;
  for (const int button : {1, 2, 32, 35, 64, 65, 4, 16})  // others, motion, wheel, with Shift, Ctrl
    EXPECT_EQ(Of(Mouse(button, start.row, column, 'M')), "") << button;
  EXPECT_EQ(Of(Mouse(0, 0, 0, 'M')), "");  // no button is there
  EXPECT_EQ(Of(Mouse(3, 0, 0, 'm')), "/up");
  EXPECT_EQ(Of("\x1b[<0;1M\x1b[<;;M\x1b[<0;1;1;1M\x1b[<0;-1;1M\x1b[<0;99999999999999999999;1M"),
            "");
}

TEST(TerminalBytes, KnowAMouseAsFarAsTerminalsAreWide) {
  EXPECT_EQ(Of("\x1b[<0;10000;10000m"), "/up");
  EXPECT_EQ(Of("\x1b[<0;10001;1m\x1b[<0;1;10001m\x1b[<10001;1;1m"), "");
  EXPECT_EQ(Of("\x1b[<0;1;1m\x1b[<0;0;0m"), "/up /up");
  // 32 characters are read of it; a longer one is none of those known.
  const HandboxKey& start = *HandboxKeyTyped("s");
  const std::string column = ";" + std::to_string(start.cell * kHandboxCell + 1) + ";";
  const std::string row = std::to_string(start.row + 1);
  const auto click = [&](std::size_t length) {
    const std::size_t zeros = length - 2 - column.size() - row.size();
    return Of("\x1b[<0" + column + std::string(zeros, '0') + row + "M");
  };
  EXPECT_EQ(click(32), "/down:START");
  EXPECT_EQ(click(33), "");
}

TEST(TerminalBytes, TellAnswersFocusAndQuitting) {
  EXPECT_EQ(Of("\x1b[0n"), "/answers");
  EXPECT_EQ(Of("\x1b[I\x1b[O"), "/left");
  EXPECT_EQ(Of("q"), "/quit");
  EXPECT_EQ(Of("\x03"), "/quit");
  EXPECT_EQ(Of("x0\x1b[0ny"), "X+ 0 /answers Y+");
}

// No part of what is not known is a key: not the A of a cursor key with Ctrl, not the s of Alt-s.
TEST(TerminalBytes, PassOverWhatTheyDoNotKnow) {
  for (const std::string_view bytes :
       {"\x1b[1;5A", "\x1b[1;2P", "\x1bs", "\x1bOz", "\x1b[[x", "\x1b[99~", "\x1b[?62;1;4c",
        "\x1b]11;rgb:0/0/0\x07", "\x1b]52;c;sss\x1b\\", "\x1bPsss\x1b\\", "\xc3\xa4", "\x1b[M !!",
        "\x1b[12345678901234567890123456789012345678901234567890A"})
    EXPECT_EQ(Of(std::string(bytes) + "x"), "X+") << bytes.substr(1);
  EXPECT_EQ(Of("\x1b[1\x1b[Hx"), "HOME X+");  // one was cut off by the next
  EXPECT_EQ(Of("\x1b[1\nx"), "X+");
  EXPECT_EQ(Of("\x1b[ Ax"), "X+");     // the first byte that may stand in one
  EXPECT_EQ(Of("\x1b[1\x1fx"), "X+");  // the last one that may not
  EXPECT_EQ(Of("\x1b[@x"), "X+");      // the first one that ends one
}

// A text that somebody pastes by mistake must not start a machine.
TEST(TerminalBytes, DoNotTypeWhatIsPasted) {
  const std::string pasted = "\x1b[200~start xX\x1b[A\x1b[201s\x1b[201~";
  EXPECT_EQ(Of(pasted + "x"), "X+");
  EXPECT_EQ(ByteByByte(pasted + "x"), "X+");
  EXPECT_EQ(Of("\x1b[200~ss\x03x"), "/quit X+");
  TerminalBytes reader;
  EXPECT_EQ(EventsText(reader.Read("\x1b[200~ss")), "");
  reader.GiveUp();  // its end was lost
  EXPECT_EQ(EventsText(reader.Read("s")), "START");
}

TEST(TerminalBytes, GiveUpWhatDoesNotGoOn) {
  TerminalBytes reader;
  EXPECT_EQ(EventsText(reader.Read("\x1b")), "");
  EXPECT_TRUE(reader.begun());
  reader.GiveUp();
  EXPECT_FALSE(reader.begun());
  EXPECT_EQ(EventsText(reader.Read("x")), "X+");
}

// Whatever comes: nothing crashes, Ctrl-C is heard, and in one piece it is the same as in bytes.
TEST(TerminalBytes, SurviveAnything) {
  constexpr std::string_view kLikely = "\x1b[<;0123456789MmO~Anx ]P\x07\\sR";
  std::mt19937 random(711);
  for (int round = 0; round < 2000; ++round) {
    std::string bytes;
    for (auto length = random() % 60; length > 0; --length) {
      const bool any = random() % 4 == 0;
      bytes += any ? static_cast<char>(random() % 256) : kLikely[random() % kLikely.size()];
    }
    bytes += '\x03';
    const std::string told = Of(bytes);
    EXPECT_TRUE(told.ends_with("/quit"));
    EXPECT_EQ(told, ByteByByte(bytes));
  }
}

}  // namespace
}  // namespace rmlcell::cli
