// A device that reads spans does what one does that is given the same bytes one by one, wherever
// the stream is cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "engine/rml1/device.h"
#include "engine/rml1/digit_word.h"
#include "tests/engine/rml1/random_stream.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// Writes down all that a device tells and does.
class Witness final : public DeviceListener {
 public:
  explicit Witness(const Profile& profile) : device_(profile) { text_ << std::hexfloat; }

  void ByteByByte(std::string_view stream) {
    for (std::size_t at = 0; at < stream.size(); ++at) {
      device_.Receive(static_cast<unsigned char>(stream[at]), static_cast<std::int64_t>(at), *this);
      Work();
    }
  }

  // `most`: bytes of a span.
  void BySpans(std::string_view stream, std::size_t most, std::mt19937_64& dice) {
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t length = 1 + dice() % most;
      const std::uint64_t commands = dice() % 2 == 0 ? 1 : Device::kAnyCommands;
      const Device::Taken taken =
          device_.Read(stream.substr(at, length), static_cast<std::int64_t>(at), commands, *this);
      EXPECT_LE(taken.bytes, length);
      EXPECT_TRUE(!taken.next || taken.bytes < length);
      at += taken.bytes;
      if (dice() % 16 == 0) device_ = Device(device_);  // a copy goes on as the original would
      TakeActions();
      Work();
    }
  }

  // With what it is at the end.
  std::string Text() {
    device_.EndOfData();
    const Registers& r = device_.registers();
    const Point& at = device_.carriage().logical();
    text_ << "end " << at.x << ' ' << at.y << ' ' << at.z << ' ' << at.a << ' ' << r.absolute
          << r.tool_down << r.mode_given << r.heights_given << r.x_given << r.y_given << ' '
          << r.act << ' ' << r.place_given_by << ' ' << r.xy_speed << ' ' << r.z_speed << ' '
          << r.z0 << ' ' << r.z1 << ' ' << r.z2 << ' ' << r.rpm << ' ' << r.dwell_ms << '\n'
          << device_.commands_done() << ' ' << device_.speeds_limited() << ' '
          << device_.positions_refused() << ' ' << device_.foreign_percent() << ' '
          << device_.pending() << ' ' << (device_.pending() ? device_.pending_offset() : 0) << ' '
          << device_.waiting() << '\n';
    const Programmed& p = device_.programmed();
    text_ << p.commands() << ' ' << p.other() << ' ' << p.cut_length() << ' ' << p.travel_length()
          << ' ' << p.x().low << ' ' << p.y().high << ' ' << p.z().low << ' ' << p.z_grain() << ' '
          << p.lowest_lift() << '\n';
    for (int op = 0; op < kOpCount; ++op) text_ << p.count(static_cast<Op>(op)) << ' ';
    return text_.str();
  }

  void OnCommand(const CommandPlace& command) override { Put("command", command); }
  void OnFinding(const Finding& finding) override { Put("finding", finding); }
  void OnCounted(const Finding& finding) override { Put("counted", finding); }
  void OnLost(const Carriage::LostLine& line) override {
    text_ << "lost " << line.from.x << ' ' << line.to.x << ' ' << line.to.z << '\n';
  }
  void OnAbort(std::int64_t offset) override { text_ << "abort " << offset << '\n'; }

 private:
  void Work() {
    while (device_.Step(*this)) TakeActions();
  }
  void TakeActions() {
    for (; !device_.actions().empty(); device_.actions().Pop()) {
      const Action& action = device_.actions().front();
      text_ << "action " << static_cast<int>(action.kind) << ' ' << action.to.x << ' '
            << action.to.y << ' ' << action.to.z << ' ' << action.to.a << ' ' << action.speed_mm_s
            << ' ' << action.rapid << static_cast<int>(action.use) << static_cast<int>(action.chain)
            << action.waits << action.outside << ' ' << action.rpm << ' ' << action.dwell_ms << ' '
            << device_.spindle_turns() << ' ' << device_.command().number << '\n';
    }
  }
  void Put(std::string_view what, const CommandPlace& place) {
    text_ << what << ' ' << place.number << ' ' << place.offset << ' ' << static_cast<int>(place.op)
          << '\n';
  }
  void Put(std::string_view what, const Finding& finding) {
    text_ << what << ' ' << static_cast<int>(finding.kind) << ' ' << finding.offset << ' '
          << finding.length << ' ' << finding.step << ' ' << static_cast<int>(finding.byte) << ' '
          << static_cast<int>(finding.op) << ' ' << finding.value << '\n';
  }

  Device device_;
  std::ostringstream text_;
};

TEST(SpanReading, IsReadingByteByByte) {
  constexpr int kStreams = 3000;
  for (int n = 0; n < kStreams; ++n) {
    std::mt19937_64 dice(static_cast<std::uint64_t>(n));
    const Profile profile = MakeProfile(RandomMachine(dice)).value();
    const std::string stream = RandomStream(dice, dice() % 120);
    Witness bytes(profile);
    bytes.ByteByByte(stream);
    const std::string expected = bytes.Text();
    for (const std::size_t most :
         {std::size_t{1}, std::size_t{3}, std::size_t{20}, stream.size() + 1}) {
      Witness spans(profile);
      spans.BySpans(stream, most, dice);
      ASSERT_EQ(spans.Text(), expected) << "stream " << n << ", spans of " << most << ":\n"
                                        << stream;
    }
  }
}

// Of eight bytes the digits in front count, whatever stands behind them.
TEST(DigitWord, IsTheNumberThatTheBytesBeginWith) {
  EXPECT_EQ(DigitWord("1234567;").count(), 7U);
  EXPECT_EQ(DigitWord("12345678").count(), 7U);  // more than six
  EXPECT_EQ(DigitWord(",1234567").count(), 0U);
  EXPECT_EQ(DigitWord("9/999999").count(), 1U);  // the byte below 0, that above 9, and the highest
  EXPECT_EQ(DigitWord("9:999999").count(), 1U);
  EXPECT_EQ(DigitWord("9\xff"
                      "999999")
                .count(),
            1U);
  EXPECT_EQ(DigitWord("0,999999").value(1), 0);
  EXPECT_EQ(DigitWord("90;99999").value(2), 90);
  EXPECT_EQ(DigitWord("007 9999").value(3), 7);
  EXPECT_EQ(DigitWord("1234-999").value(4), 1234);
  EXPECT_EQ(DigitWord("99999\n99").value(5), 99999);
  EXPECT_EQ(DigitWord("102030;9").value(6), 102030);
  EXPECT_EQ(DigitWord("1020304;").value(7), 1020304);
}

// A statement that is spoilt takes back what it alone has changed, and no more: extents, lengths
// and the mode are those of the statements before it.
TEST(SpanReading, ASpoiltStatementTakesBackWhatItChanged) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Device device(profile);
  DeviceListener nobody;
  const auto read = [&](std::string_view text) {
    while (!text.empty()) {
      text.remove_prefix(device.Read(text, 0, Device::kAnyCommands, nobody).bytes);
      while (!device.actions().empty()) device.actions().Pop();
    }
  };
  read("IN;PA;PD300,400;\nPD300,1400;\nPD500,1400;\nPR9000,0 QQ;\nPD0,1400;\nIN");
  const Programmed& p = device.programmed();
  EXPECT_EQ(p.x().high, 500.0);  // of the statement before, which changed nothing else
  EXPECT_EQ(p.y().high, 1400.0);
  EXPECT_EQ(p.cut_length(), 500.0 + 1000.0 + 200.0 + 500.0);  // absolute again, from there
  EXPECT_EQ(p.other(), 1U);
  EXPECT_EQ(p.count(Op::kPR), 0U);
  EXPECT_EQ(p.count(Op::kPD), 4U);
}

// A line to a face, along it and away again is the line of its ends, as one clear of all faces is.
TEST(SpanReading, LinesToAFaceAndFromItArePlain) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Device device(profile);
  DeviceListener nobody;
  std::vector<double> ends;
  const auto read = [&](std::string_view text) {
    while (!text.empty()) {
      text.remove_prefix(device.Read(text, 0, Device::kAnyCommands, nobody).bytes);
      for (; !device.actions().empty(); device.actions().Pop()) {
        const Action& action = device.actions().front();
        if (action.kind == Action::Kind::kMotion) ends.push_back(action.to.x);
      }
    }
  };
  const auto face = static_cast<int>(profile.x.high - profile.origin_x);
  const std::string out = std::to_string(face);
  read("^IN;Z100,100,-10;\nZ" + out + ",100,-10;\nZ" + out + ",200,-10;\nZ100,200,-10;\n");
  const double inside = 100.0 + profile.origin_x;
  ASSERT_GE(ends.size(), 4U);
  const std::vector<double> last(ends.end() - 4, ends.end());
  EXPECT_EQ(last, (std::vector<double>{inside, profile.x.high, profile.x.high, inside}));
  EXPECT_EQ(device.carriage().clipped_sets(), 0U);
}

// Where nothing is read, nothing was looked at that is to be looked at again.
TEST(SpanReading, OfNothingNoByteHasBeenLookedAt) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Device device(profile);
  DeviceListener nobody;
  const Device::Taken empty = device.Read("", 0, Device::kAnyCommands, nobody);
  EXPECT_EQ(empty.bytes, 0U);
  EXPECT_FALSE(empty.next);
  const Device::Taken none_wanted = device.Read("IN;", 0, 0, nobody);
  EXPECT_EQ(none_wanted.bytes, 0U);
  EXPECT_FALSE(none_wanted.next);
}

// Numbers that stand whole are read as byte by byte, or not at all.
void ExpectReadAsByteByByte(const std::string& text) {
  NumberReader reader;
  reader.Begin(static_cast<unsigned char>(text[0]));
  std::size_t length = 1;
  while (reader.Take(static_cast<unsigned char>(text[length]))) ++length;
  const Number expected = reader.value();
  Number number;
  const char* const end = text.data() + text.size();
  const char* const behind = NumberReader::ReadWhole(text.data(), end, number);
  if (behind == nullptr) return;
  ASSERT_EQ(behind, text.data() + length) << text;
  ASSERT_TRUE(reader.has_digit()) << text;
  ASSERT_EQ(number.single, expected.single) << text;
  ASSERT_EQ(std::signbit(number.single), std::signbit(expected.single)) << text;
  ASSERT_EQ(number.decimal, expected.decimal) << text;
  ASSERT_EQ(number.magnitude, expected.magnitude) << text;
  ASSERT_EQ(number.negative, expected.negative) << text;
  ASSERT_EQ(number.fraction, expected.fraction) << text;
  ASSERT_EQ(NumberReader::ReadWhole(text.data(), behind, number), nullptr) << text;  // cut off
}
TEST(SpanReading, ReadsWholeNumbersAsByteByByte) {
  for (const char* text : {"999999999.5;", "1000000000.5;", "9999999999.5;", "000000000000001.5;",
                           "0000000000000001.5;", "1.00000000000005;", "1.000000000000005;",
                           "123456789.123456;", "-0.000000000000001;"})
    ExpectReadAsByteByByte(text);
  std::mt19937_64 dice(1);
  for (int n = 0; n < 200'000; ++n) {
    std::string text(dice() % 3 == 0 ? (dice() % 2 == 0 ? "-" : "+") : "");
    for (std::uint64_t k = dice() % 9; k > 0; --k) text += static_cast<char>('0' + dice() % 10);
    if (dice() % 2 == 0) text += '.';
    for (std::uint64_t k = dice() % 9; k > 0; --k) text += static_cast<char>('0' + dice() % 10);
    text += ';';
    if (!NumberReader::CanBegin(static_cast<unsigned char>(text[0]))) continue;
    ASSERT_NO_FATAL_FAILURE(ExpectReadAsByteByByte(text));
  }
}

}  // namespace
}  // namespace rmlcell::rml1
