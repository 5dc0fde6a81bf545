#include "clients/cli/text_tools.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/tool_answer.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/header_date.h"

namespace rmlcell::cli {
namespace {

using machine::FileForm;

std::string WithExtension(const std::string& file, std::string_view extension) {
  return std::filesystem::path(file).replace_extension(extension).string();
}

machine::FileNames Names(const std::string& input, const std::string& output) {
  const auto name = [](const std::string& path) {
    return std::filesystem::path(path).filename().string();
  };
  return {.input = name(input),
          .output = output == "-" ? name(input) : name(output),
          .date = bridge::HeaderDate()};
}

std::string OrStandardOutput(const std::string& output) { return output.empty() ? "-" : output; }

Error NoBytesInJson() {
  return {ErrorCode::kCellUsage, "--json says what was written: give a file for the bytes", {}};
}

struct Source {
  const machine::MachineFamily* family = nullptr;
  std::string text;
  bool inch = false;

  const machine::Tools& tools() const { return *family->tools(); }
};

// The source of a file: an object is decompiled.
Result<Source> ReadSource(const std::string& file) {
  const auto family = families::FamilyWithTools(file);
  if (!family) return family.error();
  Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return bytes.error();
  const FileForm form = (*family)->tools()->FormOf(file, *bytes);
  if (form != FileForm::kObject) {
    return Source{*family, *std::move(bytes), form == FileForm::kInchSource};
  }
  Result<machine::RecoveredSource> source = (*family)->tools()->Decompile(*bytes, std::nullopt);
  if (!source) return source.error();
  return Source{*family, std::move(source->text), false};
}

// The object of a file; its findings go into the answer. Nothing when it has errors.
std::optional<machine::CompiledProgram> CompileFile(const std::string& file, const Source& source,
                                                    machine::CompileOptions options,
                                                    ToolAnswer& answer) {
  options.inch = source.inch;
  machine::CompiledProgram compiled =
      source.tools().Compile({.name = file, .bytes = source.text},
                             machine::Parameters(source.family->parameters()), options);
  answer.Found(compiled.diagnostics, compiled.diagnostics_dropped, source.text);
  if (!compiled.ok) return std::nullopt;
  return compiled;
}

}  // namespace

int Compile(const ToolOptions& options, bool map) {
  const std::string& file = options.file;
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  if (source->text.empty()) return Refuse({ErrorCode::kCellEmptyProgram, file, {}});
  const machine::FileExtensions& extensions = source->tools().extensions();
  const std::string target =
      options.output.empty() ? WithExtension(file, extensions.object) : options.output;
  if (options.json && target == "-") return Refuse(NoBytesInJson());
  ToolAnswer answer(file, options.json);
  const auto compiled = CompileFile(file, *source, {.source_map = map}, answer);
  if (!compiled) return answer.Failed();
  if (map && target == "-")
    return Refuse({ErrorCode::kCellUsage, "--map: the object goes into no file", {}});
  if (map) {
    const std::string file_of_map = WithExtension(target, extensions.source_map);
    if (const Status written = WriteWholeFile(file_of_map, compiled->source_map); !written)
      return Refuse(written.error());
  }
  return answer.Deliver(compiled->object, target,
                        "object of " + std::to_string(compiled->object.size()) + " bytes, " +
                            std::to_string(compiled->steps) + " steps");
}

int Decompile(const ToolOptions& options) {
  const std::string& file = options.file;
  const auto family = families::FamilyWithTools(file);
  if (!family) return Refuse(family.error());
  const machine::Tools& tools = *(*family)->tools();
  const Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return Refuse(bytes.error());
  // A map that is not there, cannot be read, or is of another object is passed over.
  const Result<std::string> map =
      bridge::ReadFile(WithExtension(file, tools.extensions().source_map), kFileBytesMax);
  const Result<machine::RecoveredSource> source =
      tools.Decompile(*bytes, map ? std::optional<std::string_view>(*map) : std::nullopt);
  if (!source) return Refuse(source.error());
  return ToolAnswer(file, options.json)
      .Deliver(source->text, OrStandardOutput(options.output), "source of " + file);
}

int Link(const LinkOptions& options) {
  const auto family = families::FamilyWithTools(options.files.front());
  if (!family) return Refuse(family.error());
  const machine::Tools& tools = *(*family)->tools();
  const Result<LoadedFiles> loaded =
      LoadFiles(options.files, options.slots, options.main_slot, std::string((*family)->info().id),
                EmptyInFolders::kTaken);
  if (!loaded) return Refuse(loaded.error());
  if (options.json && options.output == "-") return Refuse(NoBytesInJson());
  ToolAnswer answer(options.files.front(), options.json);
  // Only what is called is compiled (OPT-9.02); the folder may hold programs that are not finished.
  std::map<int, std::string> objects;
  bool good = true;
  const auto lookup = [&](int slot) -> std::optional<std::string_view> {
    if (const auto made = objects.find(slot); made != objects.end()) return made->second;
    const auto program =
        std::ranges::find(loaded->programs, slot, &simulation::MemoryProgram::slot);
    if (program == loaded->programs.end()) return std::nullopt;
    if (program->bytes->empty()) {
      constexpr ErrorCode kEmpty = ErrorCode::kCellEmptyProgram;
      answer.Found(
          {{.code = kEmpty,
            .severity = Lookup(kEmpty).severity,
            .detail = "program " + std::to_string(slot) + " is called, and its file is empty",
            .rule = {},
            .file = program->file_name,
            .where = {},
            .fixes = {}}},
          {}, {});
      good = false;
      return std::nullopt;
    }
    const FileForm form = tools.FormOf(program->file_name, *program->bytes);
    if (form == FileForm::kObject) return objects[slot] = std::string(*program->bytes);
    const auto compiled = CompileFile(
        program->file_name, {*family, std::string(*program->bytes), form == FileForm::kInchSource},
        {.advice = false}, answer);
    if (!compiled) {
      good = false;
      return std::nullopt;
    }
    return objects[slot] = compiled->object;
  };
  const Result<machine::LinkedProgram> linked =
      tools.Link(loaded->main_slot, lookup, machine::Parameters((*family)->parameters()));
  if (!good) return answer.Failed();  // said already
  if (!linked) return answer.Failed(linked.error());
  std::string what = "executable of program " + std::to_string(loaded->main_slot);
  for (std::size_t i = 0; i < linked->functions.size(); ++i) {
    what += (i == 0 ? " with FUNCTION " : ", ") + std::to_string(linked->functions[i]);
  }
  what += "; store it in slot " + std::to_string(loaded->main_slot + kExecutableOffset);
  std::string output = options.output;
  if (output.empty()) {
    const auto main =
        std::ranges::find(loaded->programs, loaded->main_slot, &simulation::MemoryProgram::slot);
    output = WithExtension(main->file_name, tools.extensions().executable);
  }
  return answer.Deliver(linked->executable, output, what);
}

namespace {

// The exit code; an error: of the file, nothing was done to it.
Result<int> FormatFile(const std::string& file, const FormatOptions& options, ToolAnswer& answer) {
  const Result<std::string> text = bridge::ReadFile(file, kFileBytesMax);
  if (!text) return text.error();
  const auto family = families::FamilyWithTools(file);
  if (!family) return family.error();
  const machine::Tools& tools = *(*family)->tools();
  if (tools.FormOf(file, *text) == FileForm::kObject) {
    return Error{
        ErrorCode::kCellBadText, file + " is an object; rmlcell decompile gives its source", {}};
  }
  const machine::FormattedText formatted = tools.Format({.name = file, .bytes = *text});
  // It stays as it is where it cannot be read; say why.
  const bool bad = !formatted.readable;
  if (bad) answer.Found(formatted.diagnostics, formatted.diagnostics_dropped, *text);
  if (formatted.changed && !options.check_only) {
    if (const Status written = WriteWholeFile(file, formatted.text); !written)
      return written.error();
  }
  // With --check a list of names, for scripts.
  const std::string what = !formatted.changed   ? ""
                           : options.check_only ? file
                                                : file + ": formatted";
  const bool fails = bad || (formatted.changed && options.check_only);
  return answer.Say(what, fails ? kProgramErrors : kGood);
}

}  // namespace

int Format(const FormatOptions& options) {
  int exit_code = kGood;
  for (const std::string& file : options.files) {
    ToolAnswer answer(file, options.json);
    const Result<int> formatted = FormatFile(file, options, answer);
    if (!formatted && options.files.size() == 1) return Refuse(formatted.error());
    // A file that is not there keeps nobody from the others.
    exit_code = std::max(exit_code, formatted ? *formatted : answer.Failed(formatted.error()));
  }
  return exit_code;
}

int Convert(const ConvertOptions& options) {
  const std::vector<std::string>& arguments = options.arguments;
  const auto family = families::FamilyWithTools(arguments.empty() ? "" : arguments.front());
  if (!family) return Refuse(family.error());
  const machine::Tools& tools = *(*family)->tools();
  const auto request = tools.ReadConvertArguments(arguments);
  if (!request) return Refuse(request.error());
  if (!*request) {
    Print(
        "convert FILE.S            millimetres and radians to inches and degrees: FILE.SI\n"
        "convert FILE.SI           inches and degrees to millimetres and radians: FILE.S\n"
        "convert FILE [OUT] /i     any other name, to inches; /m to millimetres");
    return kUsage;
  }
  machine::ConvertRequest wanted = **request;
  if (!options.output.empty()) wanted.output = options.output;
  const Result<std::string> text = bridge::ReadFile(wanted.input, kFileBytesMax);
  if (!text) return Refuse({tools.codes().convert_input, text.error().detail, {}});
  if (tools.FormOf(wanted.input, *text) == FileForm::kObject) {
    return Refuse({ErrorCode::kCellBadText,
                   wanted.input + " is an object; rmlcell decompile gives its source",
                   {}});
  }
  const machine::RewrittenText converted =
      tools.Convert(*text, wanted.direction, Names(wanted.input, wanted.output));
  ToolAnswer answer(wanted.input, options.json);
  answer.Found(converted.diagnostics, converted.diagnostics_dropped, *text);
  const int exit_code = HasErrors(converted.diagnostics) ? kProgramErrors : kGood;
  const bool to_output = wanted.output == "-";
  if (to_output && !options.json) {
    PrintRaw(converted.text);
    return exit_code;
  }
  if (!to_output) {
    if (const Status written = WriteWholeFile(wanted.output, converted.text); !written)
      return Refuse({tools.codes().convert_output, written.error().detail, {}});
  }
  return answer.Written(converted.text, wanted.output,
                        wanted.direction == machine::Direction::kToInch ? "inches and degrees"
                                                                        : "millimetres and radians",
                        exit_code);
}

int Compensate(const ToolOptions& options) {
  const std::string& file = options.file;
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  const machine::Tools& tools = source->tools();
  const std::string target =
      options.output.empty() ? WithExtension(file, tools.extensions().compensated) : options.output;
  const machine::RewrittenText made =
      tools.Compensate(source->text, Names(file, target), source->inch);
  ToolAnswer answer(file, options.json);
  answer.Found(made.diagnostics, made.diagnostics_dropped, source->text);
  return made.ok ? answer.Deliver(made.text, target, "compensated") : answer.Failed();
}

namespace {

int Rewrite(const ToolOptions& options,
            machine::RewrittenText (machine::Tools::*rewrite)(std::string_view,
                                                              const machine::Displacement&) const,
            const machine::Displacement& by) {
  const std::string& file = options.file;
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  if (source->inch) return Refuse({source->tools().codes().source_is_inch, file, {}});
  machine::RewrittenText made = (source->tools().*rewrite)(source->text, by);
  for (Diagnostic& finding : made.diagnostics) finding.file = file;
  made.diagnostics_dropped.ForEachPlace([&file](Diagnostic& place) { place.file = file; });
  ToolAnswer answer(file, options.json);
  answer.Found(made.diagnostics, made.diagnostics_dropped, source->text);
  return made.ok
             ? answer.Deliver(made.text, OrStandardOutput(options.output), "rewritten from " + file)
             : answer.Failed();
}

}  // namespace

int Transform(const TransformOptions& options) {
  if (!options.shift.empty() && !(options.move.empty() && options.turn.empty())) {
    return Refuse(
        {ErrorCode::kCellUsage,
         "--shift changes VR[86] to VR[91], --move and --turn the moves: give one or the other",
         {}});
  }
  if (!options.shift.empty()) {
    std::array<double, 6> values{};
    std::ranges::copy(options.shift, values.begin());
    return Rewrite(options, &machine::Tools::Shift,
                   {.move_mm = {values[0], values[1], values[2]},
                    .turn_rad = {values[3], values[4], values[5]}});
  }
  if (options.move.empty() && options.turn.empty()) {
    return Refuse({ErrorCode::kCellUsage, "nothing to do: give --move, --turn or --shift", {}});
  }
  machine::Displacement by;
  std::ranges::copy(options.move, by.move_mm.begin());
  std::ranges::copy(options.turn, by.turn_rad.begin());
  return Rewrite(options, &machine::Tools::Transform, by);
}

int List(const ToolOptions& options) {
  const Result<Source> source = ReadSource(options.file);
  if (!source) return Refuse(source.error());
  ToolAnswer answer(options.file, options.json);
  const auto compiled =
      CompileFile(options.file, {source->family, source->text, false}, {.advice = false}, answer);
  if (!compiled) return answer.Failed();
  const Result<std::string> listing = source->tools().List(compiled->object);
  if (!listing) return answer.Failed(listing.error());
  return answer.Deliver(*listing, OrStandardOutput(options.output), "list of " + options.file);
}

}  // namespace rmlcell::cli
