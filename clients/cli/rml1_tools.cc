#include "clients/cli/rml1_tools.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/tool_answer.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/from_gcode.h"
#include "engine/rml1/offline/rewrite.h"
#include "engine/rml1/offline/tile.h"
#include "engine/rml1/offline/to_gcode.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/spooled_bytes.h"

namespace rmlcell::cli {
namespace {

constexpr std::string_view kFamily = "rml1";

struct MillProgram {
  machine::Bytes bytes;
  machine::Parameters parameters;
};

Result<machine::Parameters> MillParameters(const MillToolOptions& options) {
  const Result<bridge::MachineFile> machine = ReadMachine(options.machine);
  if (!machine) return machine.error();
  if (!machine->family.empty() && machine->family != kFamily) {
    return Error{ErrorCode::kCellUsage,
                 options.machine.file + " is a machine of the family " + machine->family +
                     "; these tools are for mills (rml1)",
                 {}};
  }
  return machine::MakeParameters(*families::FindFamily(kFamily), machine->profile,
                                 machine->parameters);
}

// A stream by any name; a program of another family is refused.
Result<MillProgram> ReadStream(const MillToolOptions& options) {
  const machine::MachineFamily* family = families::FamilyOfFileName(options.file);
  if (family != nullptr && family->info().id != kFamily) {
    return InvalidArgument(options.file + " is a program for " + std::string(family->info().title) +
                           ": these tools are for streams of mills");
  }
  Result<machine::Parameters> parameters = MillParameters(options);
  if (!parameters) return parameters.error();
  Result<machine::Bytes> bytes = bridge::ReadProgram(options.file, kFileBytesMax);
  if (!bytes) return bytes.error();
  if ((*bytes)->empty()) return Error{ErrorCode::kCellEmptyProgram, options.file, {}};
  return MillProgram{*std::move(bytes), *std::move(parameters)};
}

// By default FILE with another ending; null: standard output.
std::string OutputOr(const MillToolOptions& options, const char* extension) {
  if (!options.output.empty()) return options.output;
  if (extension == nullptr) return "-";
  return std::filesystem::path(options.file).replace_extension(extension).string();
}

// An error in the file; one about what was asked for is a wrong use.
int FailedAt(const Error& error, const std::string& file, ToolAnswer& answer) {
  if (error.code == ErrorCode::kCellInvalidArgument || error.code == ErrorCode::kCellParameterRange)
    return Refuse(error);
  Diagnostic finding{.code = error.code,
                     .severity = Lookup(error.code).severity,
                     .detail = error.detail,
                     .file = file,
                     .where = error.where.value_or(SourceSpan{})};
  answer.Found({std::move(finding)}, 0, {});
  return answer.Failed();
}

void Found(std::vector<Diagnostic>& findings, std::uint64_t dropped, const std::string& file,
           std::string_view text, ToolAnswer& answer) {
  for (Diagnostic& finding : findings) finding.file = file;
  answer.Found(findings, dropped, text);
}

std::string Padded(std::string text, std::size_t width, bool left) {
  if (text.size() >= width) return text;
  const std::string blanks(width - text.size(), ' ');
  return left ? blanks + text : text + blanks;
}

void PrintPhrase(const rml1::ExplainedPhrase& phrase, const std::string& file, bool colour) {
  std::string line = Padded(std::to_string(phrase.offset), 9, true) + ' ' +
                     Padded(phrase.command > 0 ? std::to_string(phrase.command) : "-", 8, true) +
                     "  " + Padded(Visible(phrase.text), 24, false) + "  " + phrase.words;
  Print(line);
  for (const Diagnostic& finding : phrase.findings) {
    Diagnostic named = finding;
    named.file = file;
    const bool advice = named.severity == Severity::kAdvice;
    Print(Paint("                    " + FormatDiagnostic(named, {}),
                advice ? Colour::kYellow : Colour::kRed, colour));
  }
}

void PrintPhraseJson(const rml1::ExplainedPhrase& phrase) {
  nlohmann::ordered_json line;
  line["offset"] = phrase.offset;
  line["command"] = phrase.command;
  line["name"] = phrase.name;
  line["text"] = bridge::Utf8(phrase.text);
  line["words"] = phrase.words;
  nlohmann::ordered_json findings = nlohmann::ordered_json::array();
  for (const Diagnostic& finding : phrase.findings) {
    findings.push_back({{"code", CodeText(finding.code)},
                        {"detail", bridge::Utf8(finding.detail)},
                        {"line", finding.where.line},
                        {"column", finding.where.column}});
  }
  line["findings"] = std::move(findings);
  Print(line.dump());
}

}  // namespace

int ExplainStream(const MillToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  const bool colour = ColourOnOutput();
  if (!options.json) Print("     byte  command  text                      what it does");
  std::int64_t released = 0;
  const Status told =
      rml1::Explain(*program->bytes, program->parameters, [&](const rml1::ExplainedPhrase& phrase) {
        if (phrase.offset - released > static_cast<std::int64_t>(machine::kReleaseEvery)) {
          program->bytes.Release();
          released = phrase.offset;
        }
        if (options.json) {
          PrintPhraseJson(phrase);
        } else {
          PrintPhrase(phrase, options.file, colour);
        }
        return std::ferror(stdout) == 0;
      });
  return told ? int{kGood} : Refuse(told.error());
}

int StreamToGcode(const MillToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  Result<rml1::GcodeText> made = rml1::ToGcode(*program->bytes, program->parameters);
  ToolAnswer answer(options.file, options.json);
  if (!made) return FailedAt(made.error(), options.file, answer);
  Found(made->findings, made->findings_dropped, options.file, *program->bytes, answer);
  return answer.Deliver(made->text, OutputOr(options, ".nc"),
                        Bytes(static_cast<std::int64_t>(made->text.size())) + " of G-code");
}

int StreamFromGcode(const FromGcodeToolOptions& options) {
  const Result<machine::Parameters> parameters = MillParameters(options);
  if (!parameters) return Refuse(parameters.error());
  const Result<std::string> text = bridge::ReadFile(options.file, kFileBytesMax);
  if (!text) return Refuse(text.error());
  if (text->empty()) return Refuse({ErrorCode::kCellEmptyProgram, options.file, {}});
  Result<rml1::StreamOfGcode> made = rml1::FromGcode(
      *text, *parameters, {.tolerance_mm = options.tolerance_mm, .bytes_max = kFileBytesMax});
  if (!made) return Refuse(made.error());
  ToolAnswer answer(options.file, options.json);
  Found(made->findings, made->findings_dropped, options.file, *text, answer);
  if (!made->ok) return answer.Failed();
  return answer.Deliver(made->stream, OutputOr(options, ".rml"),
                        "stream of " + Bytes(static_cast<std::int64_t>(made->stream.size())));
}

int MoveMillStream(const MoveToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  std::array<double, 3> by_mm{};
  std::ranges::copy(options.by_mm, by_mm.begin());
  Result<rml1::RewrittenStream> made =
      rml1::MoveStream(*program->bytes, program->parameters, by_mm);
  ToolAnswer answer(options.file, options.json);
  if (!made) return FailedAt(made.error(), options.file, answer);
  Found(made->findings, 0, options.file, *program->bytes, answer);
  const auto& moved = made->moved_mm;
  return answer.Deliver(made->stream, OutputOr(options, nullptr),
                        "moved by " + Fixed(moved[0], 3) + "," + Fixed(moved[1], 3) + "," +
                            Fixed(moved[2], 3) + " mm");
}

int ScaleMillStream(const StepsToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  const Result<rml1::RewrittenStream> made =
      rml1::ScaleStream(*program->bytes, program->parameters, options.from, options.to);
  ToolAnswer answer(options.file, options.json);
  if (!made) return FailedAt(made.error(), options.file, answer);
  return answer.Deliver(made->stream, OutputOr(options, nullptr),
                        TrimmedText(options.to, 3) + " units in a mm");
}

int TileMillStream(const TileToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  const Result<rml1::TiledStream> made = rml1::TileStream(*program->bytes, program->parameters,
                                                          {.columns = options.columns,
                                                           .rows = options.rows,
                                                           .gap_mm = options.gap_mm,
                                                           .bytes_max = kFileBytesMax});
  ToolAnswer answer(options.file, options.json);
  if (!made) return FailedAt(made.error(), options.file, answer);
  return answer.Deliver(made->stream, OutputOr(options, nullptr),
                        std::to_string(options.columns * options.rows) + " copies, every " +
                            Fixed(made->pitch_x_mm, 3) + " mm in X and " +
                            Fixed(made->pitch_y_mm, 3) + " mm in Y");
}

int StreamFromPng(const PngToolOptions& options) {
  const Result<machine::Parameters> parameters = MillParameters(options);
  if (!parameters) return Refuse(parameters.error());
  const Result<std::string> bytes = bridge::ReadFile(options.file, kFileBytesMax);
  if (!bytes) return Refuse(bytes.error());
  ToolAnswer answer(options.file, options.json);
  const Result<rml1::PngBitmap> picture = rml1::ReadPng(*bytes, options.invert);
  if (!picture) return FailedAt(picture.error(), options.file, answer);
  rml1::BoardOptions board = options.board;
  const Result<double> pixel_mm = rml1::PixelSizeOf(*picture, options.dpi);
  if (!pixel_mm) return FailedAt(pixel_mm.error(), options.file, answer);
  board.pixel_mm = *pixel_mm;
  if (!options.at_mm.empty()) {
    board.at_x_mm = options.at_mm[0];
    board.at_y_mm = options.at_mm[1];
  }
  Result<rml1::BoardStream> made = rml1::StreamOfBoard(picture->bitmap, *parameters, board);
  if (!made) return FailedAt(made.error(), options.file, answer);
  Found(made->findings, 0, options.file, {}, answer);
  return answer.Deliver(made->stream, OutputOr(options, ".rml"),
                        std::to_string(made->loops) + " lines, picture of " +
                            Fixed(made->width_mm, 2) + " by " + Fixed(made->height_mm, 2) + " mm");
}

}  // namespace rmlcell::cli
