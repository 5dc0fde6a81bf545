#include "tests/fuzz/rml1_tools_input.h"

#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/stream_diff.h"
#include "engine/rml1/offline/stream_walk.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/offline/made_text.h"

namespace rmlcell::rml1 {
namespace {

constexpr std::size_t kLong = 4096;  // longer inputs find nothing that short ones do not

machine::Parameters MachineOf(unsigned char which) {
  machine::Parameters parameters(ParameterTable());
  const auto profiles = MachineProfiles();
  RMLCELL_CHECK(parameters.Apply(profiles[which % profiles.size()]).ok());
  return parameters;
}

class Silent final : public PhraseListener {
 public:
  bool OnPhrase(const Phrase&) override { return true; }
};

std::uint64_t ErrorsOf(std::string_view stream, const machine::Parameters& parameters) {
  const Profile profile = MakeProfile(parameters).value();
  Silent silent;
  StreamWalk walk(profile, silent);
  walk.Run(stream);
  return walk.device().command_errors().total() + walk.device().link_errors().total();
}

std::string TryExplain(std::string_view stream, const machine::Parameters& parameters) {
  std::string wrong;
  std::int64_t last = 0;
  std::uint64_t command = 0;
  const Status told = Explain(stream, parameters, [&](const ExplainedPhrase& phrase) {
    if (phrase.offset < 0 || phrase.offset > static_cast<std::int64_t>(stream.size()))
      wrong = "a phrase outside of the stream";
    if (phrase.words.empty()) wrong = "a phrase without words";
    if (phrase.text.size() > kShownBytes) wrong = "a phrase of too much text";
    if (phrase.command != 0 && phrase.command < command) wrong = "commands that go back";
    if (phrase.command != 0) command = phrase.command;
    last = phrase.offset;
    return wrong.empty();
  });
  if (!told && !stream.empty()) return "a stream that cannot be told";
  return wrong;
}

}  // namespace

std::string TryWalk(std::string_view bytes) {
  if (bytes.empty()) return {};
  const machine::Parameters parameters = MachineOf(static_cast<unsigned char>(bytes.front()));
  const std::string_view stream = bytes.substr(1, kLong);
  if (std::string wrong = TryExplain(stream, parameters); !wrong.empty()) return wrong;
  if (stream.empty()) return {};
  const std::uint64_t errors = ErrorsOf(stream, parameters);
  // A number becomes another number: what was no error before is none behind it.
  if (const auto moved = MoveStream(stream, parameters, {1.5, -2.0, 0.0});
      moved && errors == 0 && ErrorsOf(moved->stream, parameters) != 0)
    return "a moved stream with errors";
  if (const auto scaled = ScaleStream(stream, parameters, 40, 40);
      scaled && errors == 0 && ErrorsOf(scaled->stream, parameters) != 0)
    return "a scaled stream with errors";
  if (const auto tiled = TileStream(stream, parameters, {.columns = 2, .rows = 2});
      tiled && errors == 0 && ErrorsOf(tiled->stream, parameters) != 0)
    return "copies with errors";
  if (const auto diff = CompareStreams({.object = stream}, {.object = stream}, parameters);
      diff && !diff->equal())
    return "a stream that differs from itself";
  const auto gcode = ToGcode(stream, parameters);
  if (!gcode) return {};
  const auto again = FromGcode(gcode->text, parameters);
  if (!again || !again->ok) return "G-code of ours that is not read";
  return ErrorsOf(again->stream, parameters) == 0 ? "" : "a stream of our G-code with errors";
}

std::string TryGcode(std::string_view bytes) {
  if (bytes.empty()) return {};
  const machine::Parameters parameters = MachineOf(static_cast<unsigned char>(bytes.front()));
  const auto made = FromGcode(bytes.substr(1, kLong), parameters, {.bytes_max = 1 << 20});
  if (!made) return bytes.size() > 1 ? "a program that is refused as a whole" : "";
  if (!made->ok) return made->findings.empty() ? "refused without a word" : "";
  return ErrorsOf(made->stream, parameters) == 0 ? "" : "a stream with errors";
}

std::string TryPng(std::string_view bytes) {
  constexpr std::size_t kPixels = 1 << 14;
  const auto read = ReadPng(bytes, false, kPixels);
  if (!read) return {};
  const Bitmap& bitmap = read->bitmap;
  if (bitmap.copper.size() != bitmap.width * bitmap.height || bitmap.copper.size() > kPixels)
    return "pixels that are not there";
  const machine::Parameters parameters = MachineOf(5);
  const auto made =
      StreamOfBoard(bitmap, parameters, {.pixel_mm = 0.2, .passes = 2, .at_x_mm = 5, .at_y_mm = 5});
  if (!made) return {};
  return ErrorsOf(made->stream, parameters) == 0 ? "" : "a stream with errors";
}

}  // namespace rmlcell::rml1
