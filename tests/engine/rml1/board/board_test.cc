#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>

#include "engine/rml1/board/contours.h"
#include "engine/rml1/board/joined_traces.h"
#include "engine/rml1/board/nearest_order.h"
#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/board/simplify.h"
#include "engine/rml1/offline/stream_walk.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// Lines of '#' for copper, the uppermost first.
Bitmap Picture(const std::vector<std::string>& lines) {
  Bitmap bitmap{.width = lines.front().size(), .height = lines.size()};
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    for (const char c : *line) bitmap.copper.push_back(c == '#' ? 1 : 0);
  }
  return bitmap;
}

Bitmap RandomTraces(std::mt19937& random, std::size_t width, std::size_t height, int traces) {
  Bitmap bitmap{.width = width, .height = height};
  bitmap.copper.resize(width * height);
  const auto within = [&](std::size_t below) { return static_cast<std::size_t>(random() % below); };
  for (int i = 0; i < traces; ++i) {
    const std::size_t x = within(width), y = within(height);
    const std::size_t w = 2 + within(width / 3), h = 2 + within(6);
    const bool upright = random() % 2 == 0;
    for (std::size_t a = 0; a < (upright ? h : w) && x + a < width; ++a) {
      for (std::size_t b = 0; b < (upright ? w : h) && y + b < height; ++b)
        bitmap.copper[(y + b) * width + x + a] = 1;
    }
  }
  return bitmap;
}

// Every pixel against every other one.
TEST(DistanceField, IsTheDistanceToTheNearestCopper) {
  std::mt19937 random(3);  // NOLINT: the same pictures in every run
  for (int i = 0; i < 20; ++i) {
    const Bitmap bitmap = RandomTraces(random, 31, 23, 1 + i % 4);
    const std::size_t margin = static_cast<std::size_t>(i % 3);
    const DistanceField field = DistanceToCopper(bitmap, margin);
    ASSERT_EQ(field.width, 31 + 2 * margin);
    for (std::size_t y = 0; y < field.height; ++y) {
      for (std::size_t x = 0; x < field.width; ++x) {
        double least = HUGE_VAL;
        for (std::size_t v = 0; v < bitmap.height; ++v) {
          for (std::size_t u = 0; u < bitmap.width; ++u) {
            if (!bitmap.at(u, v)) continue;
            least = std::min(least,
                             std::hypot(static_cast<double>(u + margin) - static_cast<double>(x),
                                        static_cast<double>(v + margin) - static_cast<double>(y)));
          }
        }
        ASSERT_NEAR(field.at(x, y), least, 1e-4) << x << ' ' << y;
      }
    }
  }
  EXPECT_GE(DistanceToCopper(Picture({"..", ".."}), 1).at(0, 0), kVeryFar);
}

// Around one pixel, at one pixel's distance: a diamond through its four neighbours.
TEST(Contours, GoAroundWhatIsBelowCounterclockwise) {
  const DistanceField one = DistanceToCopper(Picture({"...", ".#.", "..."}), 2);
  const std::vector<Loop> loops = ContoursAt(one, 1.0);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_NEAR(SignedArea(loops[0]), 2.0, 1e-6);
  for (const PlanePoint& p : loops[0]) EXPECT_NEAR(std::hypot(p.x - 3, p.y - 3), 1.0, 1e-6);
  // A ring has an outer line and, clockwise, one around its hole.
  const DistanceField ring = DistanceToCopper(
      Picture({"#######", "#.....#", "#.....#", "#.....#", "#.....#", "#.....#", "#######"}), 3);
  const std::vector<Loop> both = ContoursAt(ring, 1.5);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(std::ranges::count_if(both, [](const Loop& l) { return SignedArea(l) > 0; }), 1);
  // Two pixels corner to corner: apart below half a diagonal, one above.
  const DistanceField two = DistanceToCopper(Picture({"#.", ".#"}), 3);
  EXPECT_EQ(ContoursAt(two, 0.4).size(), 2U);
  EXPECT_EQ(ContoursAt(two, 0.8).size(), 1U);
}

TEST(Simplified, KeepsWithinTheTolerance) {
  Loop circle;
  for (int i = 0; i < 20'000; ++i)
    circle.push_back({100 * std::cos(i * M_PI / 10'000), 100 * std::sin(i * M_PI / 10'000)});
  const Loop simple = Simplified(circle, 0.1);
  EXPECT_EQ(simple.front(), circle.front());
  // A chord of an angle a is 100 (1 - cos(a / 2)) off: 0.1 at 5.1 degrees, so 70 chords at least.
  EXPECT_GE(simple.size(), 70U);
  EXPECT_LT(simple.size(), 200U);
  for (const PlanePoint& p : circle) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < simple.size(); ++i) {
      const PlanePoint &a = simple[i], &b = simple[(i + 1) % simple.size()];
      const double dx = b.x - a.x, dy = b.y - a.y;
      const double t =
          std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
      least = std::min(least, std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy));
    }
    ASSERT_LE(least, 0.1 + 1e-9);
  }
  EXPECT_EQ(Simplified({{0, 0}, {1, 0}, {1, 1}}, 9).size(), 3U);
}

TEST(NearestOrder, TakesTheNearestEachTime) {
  std::mt19937 random(5);  // NOLINT: the same places in every run
  std::vector<PlanePoint> places;
  for (int i = 0; i < 300; ++i)
    places.push_back({static_cast<double>(random() % 1000), static_cast<double>(random() % 100)});
  const std::vector<std::size_t> order = NearestOrder(places, {-500, 20});
  ASSERT_EQ(order.size(), places.size());
  std::set<std::size_t> left;
  for (std::size_t i = 0; i < places.size(); ++i) left.insert(i);
  PlanePoint at{-500, 20};
  for (const std::size_t next : order) {
    double least = HUGE_VAL;
    for (const std::size_t i : left)
      least = std::min(least, std::hypot(places[i].x - at.x, places[i].y - at.y));
    EXPECT_NEAR(std::hypot(places[next].x - at.x, places[next].y - at.y), least, 1e-9);
    EXPECT_EQ(left.erase(next), 1U);
    at = places[next];
  }
  EXPECT_TRUE(NearestOrder({}, {}).empty());
}

struct Way {
  PlanePoint from;
  PlanePoint to;
};
// Ways in the work, mm from the XY origin, and whether the program began and ended as it should.
class Milled final : public PhraseListener {
 public:
  explicit Milled(const Profile& profile) : profile_(profile) {}
  bool OnPhrase(const Phrase& phrase) override {
    Point at = phrase.physical_before;
    for (const Action& action : phrase.actions) {
      if (action.kind == Action::Kind::kSpindleStart) turns = true;
      if (action.kind == Action::Kind::kSpindleStop) turns = false;
      if (action.kind != Action::Kind::kMotion) continue;
      if (std::min(at.z, action.to.z) < phrase.before->z0) {
        EXPECT_TRUE(turns);
        ways.push_back({Mm(at), Mm(action.to)});
        depth = std::max(depth, (phrase.before->z0 - action.to.z) / profile_.units_per_mm);
      }
      at = action.to;
    }
    return true;
  }
  std::vector<Way> ways;
  bool turns = false;
  double depth = 0.0;

 private:
  PlanePoint Mm(const Point& p) const {
    return {(p.x - profile_.origin_x) / profile_.units_per_mm,
            (p.y - profile_.origin_y) / profile_.units_per_mm};
  }
  const Profile& profile_;
};

double DistanceTo(const std::vector<Way>& ways, const PlanePoint& p) {
  double least = HUGE_VAL;
  for (const Way& way : ways) {
    const double dx = way.to.x - way.from.x, dy = way.to.y - way.from.y;
    const double square = dx * dx + dy * dy;
    const double t =
        square > 0
            ? std::clamp(((p.x - way.from.x) * dx + (p.y - way.from.y) * dy) / square, 0.0, 1.0)
            : 0.0;
    least = std::min(least, std::hypot(p.x - way.from.x - t * dx, p.y - way.from.y - t * dy));
  }
  return least;
}

machine::Parameters Centred(std::string_view profile) {
  machine::Parameters parameters = ParametersOf(profile);
  EXPECT_TRUE(parameters.Set("ORIGIN_X", std::string_view("50")));
  EXPECT_TRUE(parameters.Set("ORIGIN_Y", std::string_view("50")));
  return parameters;
}

// No corner of a pixel of copper comes closer to the path than the radius of the tool, and what
// lies right around the copper is milled, wherever the tool has room.
TEST(StreamOfBoard, MillsTheGapAndNoCopper) {
  std::mt19937 random(9);  // NOLINT: the same boards in every run
  for (const char* profile_id : {"srm-20", "mdx-20"}) {
    const machine::Parameters parameters = Centred(profile_id);
    const Profile profile = MakeProfile(parameters).value();
    for (int i = 0; i < 6; ++i) {
      const Bitmap bitmap = RandomTraces(random, 90, 60, 2 + i);
      const BoardOptions options{.pixel_mm = 0.1, .tool_mm = 0.8, .depth_mm = 0.2};
      const auto made = StreamOfBoard(bitmap, parameters, options);
      ASSERT_TRUE(made) << made.error().detail;
      Milled milled(profile);
      StreamWalk walk(profile, milled);
      walk.Run(made->stream);
      EXPECT_EQ(walk.device().command_errors().total(), 0U);
      EXPECT_EQ(walk.device().carriage().clipped_sets(), 0U);
      EXPECT_FALSE(milled.turns);
      EXPECT_NEAR(milled.depth, 0.2, 1e-9);
      EXPECT_GT(walk.device().carriage().physical().z, profile.z0);
      const DistanceField field = DistanceToCopper(bitmap, 0);
      int looked_at = 0;
      // Of a line: the radius, at most half a pixel's diagonal, the tolerance, the interpolation
      // and the rounding to units further out.
      const double furthest = 0.4 + 0.1 * (0.71 + 0.2) + 0.005 * 2 + 1.42 / profile.units_per_mm;
      for (std::size_t y = 0; y < bitmap.height; ++y) {
        for (std::size_t x = 0; x < bitmap.width; ++x) {
          const double left = static_cast<double>(x) * 0.1, low = static_cast<double>(y) * 0.1;
          if (bitmap.at(x, y)) {
            for (const PlanePoint corner :
                 {PlanePoint{left, low}, PlanePoint{left + 0.1, low}, PlanePoint{left, low + 0.1},
                  PlanePoint{left + 0.1, low + 0.1}})
              ASSERT_GE(DistanceTo(milled.ways, corner), 0.4 - 1e-9) << x << ' ' << y;
            continue;
          }
          // Where the middle of the tool has just room, a line runs by.
          const double from_copper = field.at(x, y) * 0.1;
          if (from_copper < furthest || from_copper >= furthest + 0.1) continue;
          ++looked_at;
          ASSERT_LE(DistanceTo(milled.ways, {left + 0.05, low + 0.05}), 0.2) << x << ' ' << y;
        }
      }
      EXPECT_GT(looked_at, 20);
    }
  }
}

TEST(StreamOfBoard, PassesLieSideBySide) {
  const Bitmap pad = Picture(std::vector<std::string>(20, std::string(20, '#') + '.'));
  const auto parameters = Centred("srm-20");
  const Profile profile = MakeProfile(parameters).value();
  const auto made = StreamOfBoard(pad, parameters,
                                  {.pixel_mm = 0.1, .tool_mm = 1.0, .passes = 3, .overlap = 0.25});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->loops, 3U);
  Milled milled(profile);
  StreamWalk(profile, milled).Run(made->stream);
  std::set<int> lefts;  // of upright lines left of the pad, 0.01 mm
  for (const Way& way : milled.ways) {
    if (std::abs(way.to.y - way.from.y) > 1.0 && way.to.x < 0 && way.to.x == way.from.x)
      lefts.insert(static_cast<int>(std::lround(way.to.x * 100)));
  }
  // From the edge of the pad, which is at X 0: the radius, the tolerance, half a unit of the
  // machine across its corner, and of a pixel 0.2 and what its corner is from its middle more than
  // its edge.
  const double first = 0.5 + 0.005 + 0.01 * M_SQRT1_2 + 0.1 * (0.2 + M_SQRT1_2 - 0.5);
  std::set<int> wanted;
  for (const int pass : {0, 1, 2})  // 1 mm * (1 - 0.25) apart
    wanted.insert(static_cast<int>(std::lround(-100 * (first + pass * 0.75))));
  EXPECT_EQ(lefts, wanted);
}

// A line is two pixels from the middle of the copper at least, however thin the tool: between them
// distances bend too much.
TEST(StreamOfBoard, AThinToolKeepsTwoPixelsAway) {
  const Bitmap pad = Picture(std::vector<std::string>(20, std::string(20, '#') + '.'));
  const auto parameters = Centred("srm-20");
  const Profile profile = MakeProfile(parameters).value();
  const auto made = StreamOfBoard(pad, parameters, {.pixel_mm = 0.1, .tool_mm = 0.01});
  ASSERT_TRUE(made) << made.error().detail;
  Milled milled(profile);
  StreamWalk(profile, milled).Run(made->stream);
  double least = 0.0;
  for (const Way& way : milled.ways) least = std::min(least, way.to.x);
  EXPECT_NEAR(least, -0.15, 1e-9);
}

// Holes are cut before the board comes loose, and in steps of the depth.
TEST(StreamOfBoard, OutlinesCutHolesFirst) {
  std::vector<std::string> board(40, std::string(40, '#'));
  for (int y = 10; y < 30; ++y) board[static_cast<std::size_t>(y)].replace(10, 20, 20, '.');
  const auto parameters = Centred("srm-20");
  const Profile profile = MakeProfile(parameters).value();
  const auto made = StreamOfBoard(Picture(board), parameters,
                                  {.pixel_mm = 0.2,
                                   .tool_mm = 1.0,
                                   .depth_mm = 1.7,
                                   .step_mm = 0.6,
                                   .passes = 4,
                                   .outline = true});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->loops, 2U);
  Milled milled(profile);
  StreamWalk(profile, milled).Run(made->stream);
  EXPECT_NEAR(milled.depth, 1.7, 1e-9);
  EXPECT_GT(milled.ways.front().to.x, 1.0);
  EXPECT_LT(std::min(milled.ways.back().to.x, milled.ways.back().to.y), 8.0);
  for (const char* depth : {",-60;", ",-120;", ",-170;"})
    EXPECT_NE(made->stream.find(depth), std::string::npos) << depth;
}

TEST(StreamOfBoard, SaysWhichTracesStayJoined) {
  const Bitmap close = Picture({"####..####", "####..####", "####..####", "####..####"});
  const auto made = StreamOfBoard(close, Centred("srm-20"), {.pixel_mm = 0.1, .tool_mm = 0.4});
  ASSERT_TRUE(made);
  ASSERT_EQ(made->findings.size(), 1U);
  EXPECT_EQ(made->findings[0].code, ErrorCode::kRml1GapTooNarrow);
  EXPECT_EQ(made->findings[0].detail, "of 2 traces 2 stay joined with a neighbour");
  EXPECT_EQ(ArgumentsText(made->findings[0].detail), "traces=2 joined=2");
  EXPECT_EQ(made->joined, 2U);
}

// Two traces 0.2 mm apart and a third one 2 mm away: a tool of 0.4 mm parts the third alone. And
// two such pairs: all four stay joined, in two groups.
TEST(StreamOfBoard, CountsTracesAndNotGroups) {
  const auto detail = [](const std::vector<std::string>& rows) {
    const auto made =
        StreamOfBoard(Picture(rows), Centred("srm-20"), {.pixel_mm = 0.1, .tool_mm = 0.4});
    EXPECT_TRUE(made);
    return made && !made->findings.empty() ? made->findings[0].detail : Detail();
  };
  const std::string far(20, '.');
  EXPECT_EQ(detail({"##..##" + far + "##", "##..##" + far + "##"}),
            "of 3 traces 2 stay joined with a neighbour");
  EXPECT_EQ(detail({"##..##" + far + "##..##", "##..##" + far + "##..##"}),
            "of 4 traces 4 stay joined with a neighbour");
  EXPECT_EQ(detail({"##" + far + "##"}), "");
  EXPECT_EQ(detail({"##..", "##..", "..##", "..##"}), "of 2 traces 2 stay joined with a neighbour");
  // A ring around a dot: 0.2 mm on all sides are too narrow, though the ring itself is one line.
  EXPECT_EQ(detail({"#######", "#.....#", "#.....#", "#..#..#", "#.....#", "#.....#", "#######"}),
            "of 2 traces 2 stay joined with a neighbour");
}

// As lines go around them: pixels that have a corner in common are two traces, or one where the
// middle between them is below the level. Values around it 0, 2 and 2, 0: the middle is 1.
TEST(JoinedTraces, AtACorner) {
  const DistanceField rising{4, 4, {9, 9, 9, 9, 9, 0, 2, 9, 9, 2, 0, 9, 9, 9, 9, 9}};
  const DistanceField falling{4, 4, {9, 9, 9, 9, 9, 2, 0, 9, 9, 0, 2, 9, 9, 9, 9, 9}};
  for (const DistanceField& field : {rising, falling}) {
    for (const double level : {0.9, 1.0}) {
      const JoinedTraces apart = CountJoined(field, 0.5, level);
      EXPECT_EQ(apart.traces, 2U);
      EXPECT_EQ(apart.joined, 0U);
      EXPECT_EQ(ContoursAt(field, level).size(), 2U);
    }
    EXPECT_EQ(CountJoined(field, 0.5, 1.1).joined, 2U);
    EXPECT_EQ(ContoursAt(field, 1.1).size(), 1U);
  }
}

// A trace may end with the last pixel of all.
TEST(JoinedTraces, InTheLastCorner) {
  const JoinedTraces counted = CountJoined({2, 2, {9, 9, 9, 0}}, 0.5, 1.0);
  EXPECT_EQ(counted.traces, 1U);
  EXPECT_EQ(counted.joined, 0U);
}

TEST(StreamOfBoard, SpeedsAndTheEnds) {
  const auto made = StreamOfBoard(Picture({"##.", "##."}), Centred("srm-20"),
                                  {.pixel_mm = 0.5, .tool_mm = 1.0, .feed_mm_s = 99, .rpm = 9000});
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->stream.starts_with("DF;\n!MC0;\n!RC7000;\n!MC1;\n")) << made->stream;
  EXPECT_TRUE(made->stream.ends_with("!MC0;\n"));
  ASSERT_EQ(made->findings.size(), 2U);
  EXPECT_EQ(made->findings[0].detail, "9000 rpm becomes 7000");
  EXPECT_EQ(made->findings[1].detail, "99 mm/s becomes 30 mm/s");
  for (const Diagnostic& finding : made->findings)
    EXPECT_EQ(CodeText(finding.code), "RML1-E8106") << finding.detail;
}

TEST(StreamOfBoard, Refuses) {
  const auto code = [](const Bitmap& bitmap, const BoardOptions& options) {
    const auto made = StreamOfBoard(bitmap, ParametersOf("srm-20"), options);
    return made ? ErrorCode::kCellUsage : made.error().code;
  };
  const Bitmap pad = Picture({"...", ".#.", "..."});
  machine::Parameters wrong = ParametersOf("srm-20");
  ASSERT_TRUE(wrong.Set("X_MIN", 300.0));
  EXPECT_EQ(StreamOfBoard(pad, wrong, {.pixel_mm = 0.1}).error().code,
            ErrorCode::kCellParameterRange);
  EXPECT_EQ(code(Picture({"..", ".."}), {.pixel_mm = 0.1}), ErrorCode::kRml1NothingToMill);
  EXPECT_EQ(code(pad, {}), ErrorCode::kCellInvalidArgument);  // no size of a pixel
  EXPECT_EQ(code(pad, {.pixel_mm = 0.1, .tool_mm = 0}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(pad, {.pixel_mm = 0.1, .depth_mm = -1}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(pad, {.pixel_mm = 0.1, .passes = 0}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(pad, {.pixel_mm = NAN}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(pad, {.pixel_mm = 0.1}), ErrorCode::kCellUsage);  // nothing to say
  // Of copper alone there is nothing to part; a board may be as large as its picture.
  const Bitmap white = Picture({"##", "##"});
  EXPECT_EQ(code(white, {.pixel_mm = 0.1}), ErrorCode::kRml1NothingToMill);
  EXPECT_EQ(code(white, {.pixel_mm = 0.1, .outline = true}), ErrorCode::kCellUsage);
  // Around it the line, 25.0121 mm + 0.907 pixels away, and two pixels more: 250,124 on each side.
  EXPECT_EQ(
      StreamOfBoard(pad, ParametersOf("srm-20"), {.pixel_mm = 1e-4, .tool_mm = 50}).error().detail,
      "250251063001 pixels with room for the tool around it");
  // 120 million: twice as many as a picture may have are taken, no more.
  EXPECT_EQ(code(pad, {.pixel_mm = 0.00457, .tool_mm = 50}), ErrorCode::kRml1PictureTooLarge);
}

std::string PngOf(std::uint32_t width, std::uint32_t height,
                  const std::vector<std::uint8_t>& rgba) {
  png_image image{
      .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGBA};
  png_alloc_size_t size = 0;
  EXPECT_NE(png_image_write_get_memory_size(image, size, 0, rgba.data(), 0, nullptr), 0);
  std::string bytes(size, '\0');
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, rgba.data(), 0, nullptr), 0);
  bytes.resize(size);
  return bytes;
}

// The chunk pHYs behind IHDR (8 + 25 bytes): 39370 pixels a metre are 1000 an inch. The reader
// that is tested looks at no checksum, libpng passes over a chunk whose checksum is wrong.
std::string WithResolution(std::string png, std::string_view x, std::string_view y) {
  std::string chunk("\0\0\0\x09pHYs", 8);
  chunk += std::string(x) + std::string(y) + "\x01" + std::string(4, '\0');
  return png.insert(33, chunk);
}

TEST(ReadPng, LightIsCopperAndTheLastRowIsTheLowest) {
  const std::vector<std::uint8_t> white = {255, 255, 255, 255}, black = {0, 0, 0, 255},
                                  clear = {255, 255, 255, 0};
  std::vector<std::uint8_t> pixels;
  for (const auto& pixel : {white, black, clear, black, white, black})
    pixels.insert(pixels.end(), pixel.begin(), pixel.end());
  const std::string png = PngOf(3, 2, pixels);
  const auto read = ReadPng(png, false);
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(read->bitmap.width, 3U);
  EXPECT_EQ(read->bitmap.copper, (std::vector<std::uint8_t>{0, 1, 0, 1, 0, 0}));
  EXPECT_FALSE(read->pixel_mm);
  EXPECT_EQ(ReadPng(png, true)->bitmap.copper, (std::vector<std::uint8_t>{1, 0, 1, 0, 1, 1}));
  const std::string dpi("\0\0\x99\xCA", 4);
  const auto sized = ReadPng(WithResolution(png, dpi, dpi), false);
  ASSERT_TRUE(sized) << sized.error().detail;
  EXPECT_NEAR(sized->pixel_mm.value(), 0.0254, 1e-5);
  const auto uneven = ReadPng(WithResolution(png, dpi, "\1\1\1\1"), false);
  ASSERT_FALSE(uneven);
  EXPECT_EQ(uneven.error().code, ErrorCode::kRml1BadPicture);
}

TEST(ReadPng, Refuses) {
  const std::string png = PngOf(4, 4, std::vector<std::uint8_t>(64, 255));
  EXPECT_EQ(ReadPng("", false).error().code, ErrorCode::kRml1BadPicture);
  EXPECT_EQ(ReadPng("GIF89a", false).error().code, ErrorCode::kRml1BadPicture);
  EXPECT_EQ(ReadPng(png.substr(0, png.size() / 2), false).error().code, ErrorCode::kRml1BadPicture);
  EXPECT_EQ(ReadPng(png, false, 15).error().code, ErrorCode::kRml1PictureTooLarge);
  EXPECT_TRUE(ReadPng(png, false, 16));
}

// Two boards of 3.6 mm, 4 mm apart, the right one with a hole: behind the hole the edge of its own
// board is nearer than that of the left one, which stands at the origin and comes last.
TEST(StreamOfBoard, EdgesBeginNearTheLastHole) {
  const std::string left = std::string(18, '#') + std::string(20, '.');
  std::vector<std::string> rows(20, left + std::string(18, '#'));
  for (std::size_t y = 5; y < 15; ++y)
    rows[y] = left + std::string(4, '#') + std::string(10, '.') + std::string(4, '#');
  const auto parameters = Centred("srm-20");
  const Profile profile = MakeProfile(parameters).value();
  const auto made =
      StreamOfBoard(Picture(rows), parameters, {.pixel_mm = 0.2, .tool_mm = 0.4, .outline = true});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->loops, 3U);
  Milled milled(profile);
  StreamWalk(profile, milled).Run(made->stream);
  EXPECT_GT(milled.ways.front().to.x, 7.6);
  EXPECT_LT(milled.ways.back().to.x, 5.0);
}

}  // namespace
}  // namespace rmlcell::rml1
