#include "clients/cli/rml1_tools.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/tool_answer.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/from_gcode.h"
#include "engine/rml1/offline/phrase_words.h"
#include "engine/rml1/offline/rewrite.h"
#include "engine/rml1/offline/tile.h"
#include "engine/rml1/offline/to_gcode.h"
#include "engine/rml1/offline/work_check.h"
#include "engine/simulation/run/rehearsal.h"
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
  const Result<const machine::MachineFamily*> family = FamilyFor(std::string(kFamily), {});
  if (!family) return family.error();
  std::map<std::string, std::string> parameters = machine->parameters;
  if (const Status placed = PlaceWork(options.machine, **family, parameters); !placed)
    return placed.error();
  return machine::MakeParameters(**family, machine->profile, parameters);
}

// Behind what was made: that nobody said for which machine must not be overlooked.
std::string MachineNote(const MillToolOptions& options) {
  if (!options.machine.profile.empty() || !options.machine.file.empty()) return {};
  const std::string_view standard = families::FindFamily(kFamily)->info().default_profile;
  return ", for the " + std::string(standard) + ": no profile was named";
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
  if (error.code == ErrorCode::kCellInvalidArgument) return Refuse(error);
  Diagnostic finding{.code = error.code,
                     .severity = Lookup(error.code).severity,
                     .detail = error.detail,
                     .file = file,
                     .where = error.where.value_or(SourceSpan{})};
  answer.Found({std::move(finding)}, {}, {});
  return answer.Failed();
}

// What a tool makes, until it is whole: in little memory, however long.
class Product {
 public:
  rml1::ByteSink sink() {
    return [this](std::string_view part) { bytes_.append(part); };
  }
  machine::Bytes Finish() { return bytes_.Finish(); }

 private:
  bridge::SpooledBytes bytes_;
};

std::string SizeText(const machine::Bytes& bytes) {
  return Bytes(static_cast<std::int64_t>(bytes->size()));
}

void AsFound(Error&) {}
// Of a stream whose lines are those of the file, with other numbers in them.
void LineAlone(Error& error) {
  if (error.where) error.where = SourceSpan{.line = error.where->line, .column = 1, .length = 1};
}

// The one rule for all that is written: the machine does all of the work. `in_its_terms` tells what
// is wrong with it in those of the file. True: it does, or it is forced.
bool MayBeWritten(const machine::Bytes& work, const machine::Parameters& parameters,
                  const MillToolOptions& options, ToolAnswer& answer,
                  const std::function<void(Error&)>& in_its_terms = AsFound) {
  Result<std::optional<Error>> checked = rml1::CheckWork(work, parameters);
  if (checked && !*checked) return true;
  Error error = checked ? **std::move(checked) : checked.error();
  in_its_terms(error);
  Diagnostic finding{.code = error.code,
                     .severity = options.force ? Severity::kWarning : Lookup(error.code).severity,
                     .detail = error.detail,
                     .file = options.file,
                     .where = error.where.value_or(SourceSpan{})};
  answer.Found({std::move(finding)}, {}, {});
  return options.force;
}

// "150x100"
std::optional<std::array<double, 2>> FieldOf(const std::string& text) {
  const std::size_t by = text.find('x');
  if (by == std::string::npos) return std::nullopt;
  const auto width = ParseDouble(text.substr(0, by));
  const auto height = ParseDouble(text.substr(by + 1));
  if (!width || !height) return std::nullopt;
  return std::array{*width, *height};
}

void Found(std::vector<Diagnostic>& findings, UntoldFindings dropped, const std::string& file,
           std::string_view text, ToolAnswer& answer) {
  for (Diagnostic& finding : findings) finding.file = file;
  dropped.ForEachPlace([&file](Diagnostic& place) { place.file = file; });
  answer.Found(findings, dropped, text);
}

std::string Padded(std::string text, std::size_t width, bool left) {
  const std::string blanks(width - std::min(width, text.size()), ' ');
  return left ? blanks + text : text + blanks;
}

// What a check says of the whole stream: how serious each finding is.
machine::Judgement JudgementOf(const MillProgram& program, const std::string& file) {
  const machine::MachineFamily& family = *families::FindFamily(kFamily);
  simulation::CheckedProgram check{
      .family = &family,
      .machine = program.parameters.Used(),
      .translation = simulation::TranslateProgram(
          family, program.parameters,
          {.file_name = file, .bytes = program.bytes, .is_source = true}, {})};
  return simulation::JudgeCheck(check);
}

void PrintPhrase(const rml1::ExplainedPhrase& phrase, const machine::Judgement& judgement,
                 const std::string& file, bool colour) {
  std::string line = Padded(std::to_string(phrase.offset), 9, true) + ' ' +
                     Padded(phrase.command > 0 ? std::to_string(phrase.command) : "-", 8, true) +
                     "  " + Padded(Visible(phrase.text), 24, false) + "  " + phrase.words;
  Print(line);
  for (const Diagnostic& finding : phrase.findings) {
    Diagnostic named = finding;
    named.file = file;
    named.judged = machine::JudgedBy(judgement, named.code);
    const bool harmless = named.severity == Severity::kAdvice && named.judged != Judged::kBad;
    Print(Paint("                    " + FormatDiagnostic(named, {}),
                harmless ? Colour::kYellow : Colour::kRed, colour));
  }
}

void PrintPhraseJson(const rml1::ExplainedPhrase& phrase, const machine::Judgement& judgement) {
  nlohmann::ordered_json line;
  line["offset"] = phrase.offset;
  line["command"] = phrase.command;
  line["name"] = phrase.name;
  line["text"] = bridge::Utf8(phrase.text);
  line["words"] = phrase.words;
  nlohmann::ordered_json findings = nlohmann::ordered_json::array();
  for (const Diagnostic& finding : phrase.findings) {
    Diagnostic judged = finding;
    judged.judged = machine::JudgedBy(judgement, finding.code);
    findings.push_back({{"code", CodeText(finding.code)},
                        {"word", FindingWord(judged)},
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
  const machine::Judgement judgement = JudgementOf(*program, options.file);
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
          PrintPhraseJson(phrase, judgement);
        } else {
          PrintPhrase(phrase, judgement, options.file, colour);
        }
        return std::ferror(stdout) == 0;
      });
  return told ? int{kGood} : Refuse(told.error());
}

int StreamToGcode(const MillToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  ToolAnswer answer(options.file, options.json);
  if (!MayBeWritten(program->bytes, program->parameters, options, answer)) return answer.Failed();
  Product product;
  Result<rml1::ToGcodeNotes> notes =
      rml1::ToGcode(program->bytes, program->parameters, product.sink());
  if (!notes) return FailedAt(notes.error(), options.file, answer);
  Found(notes->findings, notes->findings_dropped, options.file, *program->bytes, answer);
  const machine::Bytes made = product.Finish();
  return answer.Deliver(made, OutputOr(options, ".nc"),
                        SizeText(made) + " of G-code" + MachineNote(options));
}

int StreamFromGcode(const FromGcodeToolOptions& options) {
  const Result<machine::Parameters> parameters = MillParameters(options);
  if (!parameters) return Refuse(parameters.error());
  const Result<machine::Bytes> text = bridge::ReadProgram(options.file, kFileBytesMax);
  if (!text) return Refuse(text.error());
  if ((*text)->empty()) return Refuse({ErrorCode::kCellEmptyProgram, options.file, {}});
  Product product;
  Result<rml1::FromGcodeOutcome> outcome = rml1::FromGcode(
      *text, *parameters, {.tolerance_mm = options.tolerance_mm, .bytes_max = kFileBytesMax},
      product.sink());
  if (!outcome) return Refuse(outcome.error());
  ToolAnswer answer(options.file, options.json);
  Found(outcome->findings, outcome->findings_dropped, options.file, **text, answer);
  if (!outcome->ok) return answer.Failed();
  const machine::Bytes made = product.Finish();
  // The line of the G-code in place of that of the stream.
  const auto in_gcode = [&](Error& error) { error.where = outcome->beyond_travel; };
  if (!MayBeWritten(made, *parameters, options, answer, in_gcode)) return answer.Failed();
  return answer.Deliver(made, OutputOr(options, ".rml"),
                        "stream of " + SizeText(made) + MachineNote(options));
}

int MoveMillStream(const MoveToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  std::array<double, 3> by_mm{};
  std::ranges::copy(options.by_mm, by_mm.begin());
  Product product;
  const Result<std::array<double, 3>> moved =
      rml1::MoveStream(program->bytes, program->parameters, by_mm, product.sink());
  ToolAnswer answer(options.file, options.json);
  if (!moved) return FailedAt(moved.error(), options.file, answer);
  const machine::Bytes made = product.Finish();
  if (!MayBeWritten(made, program->parameters, options, answer, LineAlone)) return answer.Failed();
  return answer.Deliver(made, OutputOr(options, nullptr),
                        "moved by " + Fixed((*moved)[0], 3) + "," + Fixed((*moved)[1], 3) + "," +
                            Fixed((*moved)[2], 3) + " mm" + MachineNote(options));
}

int ScaleMillStream(const StepsToolOptions& options) {
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  Product product;
  const Status scaled = rml1::ScaleStream(program->bytes, program->parameters, options.from,
                                          options.to, product.sink());
  ToolAnswer answer(options.file, options.json);
  if (!scaled) return FailedAt(scaled.error(), options.file, answer);
  const machine::Bytes made = product.Finish();
  std::string text = rml1::ShortNumber(options.to) + " units in a mm";
  const double units = program->parameters.Number("UNITS_PER_MM");
  if (units != options.to) {
    text += "; whether it fits is not known: name the machine that it is for, of " +
            rml1::ShortNumber(options.to) + " units, with --profile";
  } else if (!MayBeWritten(made, program->parameters, options, answer, LineAlone)) {
    return answer.Failed();
  }
  return answer.Deliver(made, OutputOr(options, nullptr), text);
}

int TileMillStream(const TileToolOptions& options) {
  rml1::TileOptions tile{.columns = options.columns,
                         .rows = options.rows,
                         .gap_mm = options.gap_mm,
                         .force = options.force,
                         .bytes_max = kFileBytesMax};
  if (!options.within.empty()) {
    tile.within_mm = FieldOf(options.within);
    if (!tile.within_mm) {
      return Refuse(InvalidArgument("'" + options.within +
                                    "' is no field: write its width and height in mm, 150x100"));
    }
  }
  const Result<MillProgram> program = ReadStream(options);
  if (!program) return Refuse(program.error());
  Product product;
  const Result<rml1::Tiling> tiling =
      rml1::TileStream(program->bytes, program->parameters, tile, product.sink());
  ToolAnswer answer(options.file, options.json);
  if (!tiling) return FailedAt(tiling.error(), options.file, answer);
  const machine::Bytes made = product.Finish();
  const auto nowhere = [](Error& error) { error.where.reset(); };
  if (!MayBeWritten(made, program->parameters, options, answer, nowhere)) return answer.Failed();
  const int copies = tiling->columns * tiling->rows;
  return answer.Deliver(
      made, OutputOr(options, nullptr),
      std::to_string(copies) + (copies == 1 ? " copy, " : " copies, ") +
          std::to_string(tiling->columns) + " in X and " + std::to_string(tiling->rows) +
          " in Y, every " + Fixed(tiling->pitch_x_mm, 3) + " mm in X and " +
          Fixed(tiling->pitch_y_mm, 3) + " mm in Y" +
          (tiling->travel_is_less ? "; more are not on the travel" : "") + MachineNote(options));
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
  board.bytes_max = kFileBytesMax;
  if (!options.at_mm.empty()) {
    board.at_x_mm = options.at_mm[0];
    board.at_y_mm = options.at_mm[1];
  }
  Product product;
  Result<rml1::BoardLines> lines =
      rml1::StreamOfBoard(picture->bitmap, *parameters, board, product.sink());
  if (!lines) return FailedAt(lines.error(), options.file, answer);
  for (Diagnostic& finding : lines->findings) {
    if (options.force && IsError(finding.severity)) finding.severity = Severity::kWarning;
  }
  Found(lines->findings, {}, options.file, {}, answer);
  if (lines->joined > 0 && !options.force) return answer.Failed();
  const machine::Bytes made = product.Finish();
  const std::string size =
      "picture of " + Fixed(lines->width_mm, 2) + " by " + Fixed(lines->height_mm, 2) + " mm";
  const auto of_picture = [&](Error& error) {
    error = rml1::InTermsOfPicture(std::move(error), *lines);
  };
  if (!MayBeWritten(made, *parameters, options, answer, of_picture)) return answer.Failed();
  return answer.Deliver(made, OutputOr(options, ".rml"),
                        std::to_string(lines->loops) +
                            (lines->loops == 1 ? " line, " : " lines, ") + size +
                            MachineNote(options));
}

}  // namespace rmlcell::cli
