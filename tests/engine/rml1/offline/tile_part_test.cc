#include <gtest/gtest.h>

#include <string>

#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// Which bytes of a program are the part that is repeated. T1: 100 units in a mm, X to 200 mm.
namespace rmlcell::rml1 {
namespace {

constexpr TileOptions kTwoParts{.columns = 2, .gap_mm = 1.0};

Result<TiledStream> TiledPart(const std::string& stream, const TileOptions& options = kTwoParts) {
  return TileStream(stream, ParametersOf("t1"), options);
}
// What stands before the first copy ends, and what stands behind the last one.
std::string LastPartOf(const std::string& stream, std::string_view ending) {
  const std::string made = TiledPart(stream).value().stream;
  EXPECT_TRUE(made.ends_with(ending)) << made;
  return made.substr(0, made.find(";\n", made.find('\n') + 1));
}

// A lift behind the work rises and does nothing else: across or down again is the ending.
TEST(TilePart, TheLiftRisesAndNoMore) {
  const std::string work = "!PZ0,200;\nPU100,100;PD300,100,300,200;PU";
  EXPECT_EQ(LastPartOf(work + ";Z350,200,900;PU0,0;", "\n;Z350,200,900;PU0,0;"), work);
  EXPECT_EQ(LastPartOf(work + ";Z300,200,50;PU0,0;", "\n;Z300,200,50;PU0,0;"), work);
  EXPECT_EQ(LastPartOf(work + ";Z300,200,900;PU0,0;", "\n;PU0,0;"), work + ";Z300,200,900");
}

// A command belongs to the part with all of its sets, also the first one of a program. The copy is
// 400 to the right, for the way in from X 0 cuts, too, and begins as high as the first.
TEST(TilePart, ACommandIsWhole) {
  const auto made = TiledPart("Z100,100,-50,300,100,-50,300,100,500,400,100,500;PU0,0;");
  ASSERT_TRUE(made);
  EXPECT_EQ(made->stream,
            "Z100,100,-50,300,100,-50,300,100,500,400,100,500;\n"
            "PR;!ZZ0,0,1500,0,-100,0;PA;"
            "Z500,100,-50,700,100,-50,700,100,500,800,100,500;\n;PU0,0;");
}

// It begins where its first set does, from where the tool stood then: 15 mm higher than where it
// begins to travel.
TEST(TilePart, ACommandBeginsWithItsFirstSet) {
  const std::string part = "Z0,0,-1500,100,100,0,0,0,-550,200,0,0";
  const auto made = TiledPart("!MC0;PR;" + part + ";PA;PU0,0;");
  ASSERT_TRUE(made);
  EXPECT_EQ(made->stream,
            "!MC0;PR;" + part + ";\nPU;\n!ZZ0,0,1500;!ZZ0,-100,0;" + part + ";\nPU;\n;PA;PU0,0;");
}

// A fault in the phrase that ends the part is told before it, and lies behind it. Every hole stands
// at its pitch, of a gap of 1 mm: to the right, back and on, to the right.
TEST(TilePart, AFaultBehindThePartKeepsTheCopiesApart) {
  const auto made = TiledPart("PD\x1b.!PZ-3,7;!DW;", {.columns = 2, .rows = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made);
  std::size_t at = 0;
  for (const std::string way : {"100,0,0;PA;PD", "-100,100,0;PA;PD", "100,0,0;PA;PD"}) {
    at = made->stream.find("," + way, at);
    ASSERT_NE(at, std::string::npos) << way << " in " << made->stream;
    ++at;
  }
}

// As many copies as there may be, on a field that has room for more; and no more than that of a
// hole.
TEST(TilePart, NoMoreThanThousandCopies) {
  const std::string hole = "!PZ-50,200;\nPU100,100;PD;PU;PU0,0;";
  const auto many = TiledPart(hole, {.within_mm = {{150.0, 0.01}}, .gap_mm = 0.01});
  ASSERT_TRUE(many);
  EXPECT_EQ(many->columns, 1000);
  const auto few = TiledPart(hole, {.within_mm = {{9.99, 0.01}}, .gap_mm = 0.01});
  ASSERT_TRUE(few);
  EXPECT_EQ(few->columns, 1000);
  const auto fewer = TiledPart(hole, {.within_mm = {{9.98, 0.01}}, .gap_mm = 0.01});
  ASSERT_TRUE(fewer);
  EXPECT_EQ(fewer->columns, 999);
}

// Half a unit beyond the travel is beyond it.
TEST(TilePart, HalfAUnitBeyondTheTravel) {
  const auto made = TiledPart("!PZ-50,200;\nPU19000,100;PD20000.5,100;PU;PU0,0;");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kRml1WorkBeyondTravel);
  EXPECT_TRUE(TiledPart("!PZ-50,200;\nPU19000,100;PD20000,100;PU;PU0,0;", {}));
}

}  // namespace
}  // namespace rmlcell::rml1
