#include "clients/cli/office.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/tool_answer.h"
#include "engine/core/number_text.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/source_map.h"
#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/contour_advice.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/listing.h"
#include "engine/optimo/offline/transform.h"
#include "engine/optimo/offline/translate.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/header_date.h"

namespace rmlcell::cli {
namespace {

constexpr const char* kMapExtension = ".MAP";

std::string WithExtension(const std::string& file, const char* extension) {
  return std::filesystem::path(file).replace_extension(extension).string();
}

optimo::FileNames Names(const std::string& input, const std::string& output) {
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
  std::string text;
  bool inch = false;
};

// The source of a file: an object is decompiled.
Result<Source> ReadSource(const std::string& file) {
  Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return bytes.error();
  const optimo::FileForm form = optimo::FormOfFile(file, *bytes);
  if (form != optimo::FileForm::kObject) {
    return Source{*std::move(bytes), form == optimo::FileForm::kInchSource};
  }
  Result<std::string> text = optimo::ObjectToSource(*bytes);
  if (!text) return text.error();
  return Source{*std::move(text), false};
}

// The object of a file; its findings go into the answer. Nothing when it has errors.
std::optional<optimo::Compilation> CompileFile(const std::string& file, const Source& source,
                                               bool advice, ToolAnswer& answer) {
  optimo::Compilation compiled = optimo::Compile(
      source.text, file,
      {.object_limit = optimo::kObjectLimitStandard,
       .advice = advice,
       .inch = source.inch,
       .further_advice = optimo::ContourAdvice(optimo::ContourMachine::Standard())});
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
  const std::string target = options.output.empty() ? WithExtension(file, ".O") : options.output;
  if (options.json && target == "-") return Refuse(NoBytesInJson());
  ToolAnswer answer(file, options.json);
  const auto compiled = CompileFile(file, *source, true, answer);
  if (!compiled) return answer.Failed();
  if (map && target == "-")
    return Refuse({ErrorCode::kCellUsage, "--map: the object goes into no file", {}});
  if (map) {
    const std::string bytes =
        optimo::EncodeSourceMap(optimo::MapSource(source->text, source->inch, compiled->object));
    if (const Status written = WriteWholeFile(WithExtension(target, kMapExtension), bytes);
        !written) {
      return Refuse(written.error());
    }
  }
  return answer.Deliver(compiled->object, target,
                        "object of " + std::to_string(compiled->object.size()) + " bytes, " +
                            std::to_string(compiled->module.step_count) + " steps");
}

int Decompile(const ToolOptions& options) {
  const std::string& file = options.file;
  const Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return Refuse(bytes.error());
  // A map that is not there, cannot be read, or is of another object is passed over.
  const Result<std::string> map =
      bridge::ReadFile(WithExtension(file, kMapExtension), kFileBytesMax);
  const Result<optimo::RecoveredSource> source =
      optimo::RecoverSource(*bytes, map ? std::optional<std::string_view>(*map) : std::nullopt);
  if (!source) return Refuse(source.error());
  return ToolAnswer(file, options.json)
      .Deliver(source->text, OrStandardOutput(options.output), "source of " + file);
}

int Link(const LinkOptions& options) {
  const Result<LoadedFiles> loaded =
      LoadFiles(options.files, options.slots, options.main_slot, "optimo", EmptyInFolders::kTaken);
  if (!loaded) return Refuse(loaded.error());
  if (options.json && options.output == "-") return Refuse(NoBytesInJson());
  ToolAnswer answer(options.files.front(), options.json);
  // Only what is called is compiled (OPT-9.02); the folder may hold programs that are not finished.
  std::map<int, std::string> objects;
  bool good = true;
  const auto lookup = [&](int slot) -> std::optional<std::string_view> {
    if (const auto made = objects.find(slot); made != objects.end()) return made->second;
    const auto program = std::ranges::find(loaded->programs, slot, &bridge::ProgramInput::slot);
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
          0, {});
      good = false;
      return std::nullopt;
    }
    const optimo::FileForm form = optimo::FormOfFile(program->file_name, *program->bytes);
    if (form == optimo::FileForm::kObject) return objects[slot] = *program->bytes;
    const auto compiled =
        CompileFile(program->file_name, {*program->bytes, form == optimo::FileForm::kInchSource},
                    false, answer);
    if (!compiled) {
      good = false;
      return std::nullopt;
    }
    return objects[slot] = compiled->object;
  };
  const Result<optimo::Executable> linked = optimo::Link(loaded->main_slot, lookup, {});
  if (!good) return answer.Failed();  // said already
  if (!linked) return answer.Failed(linked.error());
  std::string what = "executable of program " + std::to_string(loaded->main_slot);
  for (std::size_t i = 1; i < linked->modules.size(); ++i) {
    what += (i == 1 ? " with FUNCTION " : ", ") + std::to_string(linked->modules[i].slot);
  }
  what += "; store it in slot " + std::to_string(loaded->main_slot + kExecutableOffset);
  return answer.Deliver(optimo::EncodeExecutable(*linked), options.output, what);
}

int Format(const FormatOptions& options) {
  int exit_code = kGood;
  for (const std::string& file : options.files) {
    const Result<std::string> text = bridge::ReadFile(file, kFileBytesMax);
    if (!text) return Refuse(text.error());
    if (optimo::FormOfFile(file, *text) == optimo::FileForm::kObject) {
      return Refuse({ErrorCode::kCellBadText,
                     file + " is an object; rmlcell decompile gives its source",
                     {}});
    }
    ToolAnswer answer(file, options.json);
    optimo::Compilation read = optimo::Compile(*text, file, {.object_limit = 0, .advice = false});
    const bool inch = optimo::FormOfFile(file, *text) == optimo::FileForm::kInchSource;
    // It stays as it is where it cannot be read; say why.
    const bool bad = !read.ok && !inch;
    if (bad) answer.Found(read.diagnostics, read.diagnostics_dropped, *text);
    const optimo::Formatting formatted = optimo::Format(*text);
    if (formatted.changed && !options.check_only) {
      if (const Status written = WriteWholeFile(file, formatted.text); !written)
        return Refuse(written.error());
    }
    // With --check a list of names, for scripts.
    const std::string what = !formatted.changed   ? ""
                             : options.check_only ? file
                                                  : file + ": formatted";
    const bool fails = bad || (formatted.changed && options.check_only);
    exit_code = std::max(exit_code, answer.Say(what, fails ? kProgramErrors : kGood));
  }
  return exit_code;
}

int Convert(const std::vector<std::string>& arguments, bool json) {
  const auto request = optimo::ReadConvertArguments(arguments);
  if (!request) return Refuse(request.error());
  if (!*request) {
    Print(
        "convert FILE.S            millimetres and radians to inches and degrees: FILE.SI\n"
        "convert FILE.SI           inches and degrees to millimetres and radians: FILE.S\n"
        "convert FILE [OUT] /i     any other name, to inches; /m to millimetres");
    return kUsage;
  }
  const optimo::ConvertRequest& wanted = **request;
  const Result<std::string> text = bridge::ReadFile(wanted.input, kFileBytesMax);
  if (!text) return Refuse({ErrorCode::kConvertInput, text.error().detail, {}});
  if (optimo::FormOfFile(wanted.input, *text) == optimo::FileForm::kObject) {
    return Refuse({ErrorCode::kCellBadText,
                   wanted.input + " is an object; rmlcell decompile gives its source",
                   {}});
  }
  const optimo::Conversion converted =
      optimo::Convert(*text, wanted.direction, Names(wanted.input, wanted.output));
  ToolAnswer answer(wanted.input, json);
  answer.Found(converted.diagnostics, 0, *text);
  if (const Status written = WriteWholeFile(wanted.output, converted.text); !written) {
    return Refuse({ErrorCode::kConvertOutput, written.error().detail, {}});
  }
  return answer.Written(converted.text, wanted.output,
                        wanted.direction == optimo::Direction::kToInch ? "inches and degrees"
                                                                       : "millimetres and radians",
                        HasErrors(converted.diagnostics) ? kProgramErrors : kGood);
}

int Compensate(const ToolOptions& options) {
  const std::string& file = options.file;
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  const std::string target = options.output.empty() ? WithExtension(file, ".CMP") : options.output;
  const optimo::Compensation made =
      optimo::Compensate(source->text, Names(file, target), source->inch);
  ToolAnswer answer(file, options.json);
  answer.Found(made.diagnostics, 0, source->text);
  return made.ok ? answer.Deliver(made.text, target, "compensated") : answer.Failed();
}

namespace {

int Rewrite(const ToolOptions& options,
            const std::function<optimo::Rewriting(const std::string&)>& rewrite) {
  const std::string& file = options.file;
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  if (source->inch) return Refuse({ErrorCode::kSourceIsInch, file, {}});
  const optimo::Rewriting made = rewrite(source->text);
  ToolAnswer answer(file, options.json);
  answer.Found(made.diagnostics, 0, source->text);
  return made.ok
             ? answer.Deliver(made.text, OrStandardOutput(options.output), "rewritten from " + file)
             : answer.Failed();
}

}  // namespace

int Transform(const TransformOptions& options) {
  for (const auto& [name, values] : {std::pair("--move", &options.move),
                                     {"--turn", &options.turn},
                                     {"--shift", &options.shift}}) {
    if (std::ranges::all_of(*values, [](double value) { return std::isfinite(value); })) continue;
    return Refuse({ErrorCode::kCellUsage, std::string(name) + ": give finite numbers", {}});
  }
  if (!options.shift.empty() && !(options.move.empty() && options.turn.empty())) {
    return Refuse(
        {ErrorCode::kCellUsage,
         "--shift changes VR[86] to VR[91], --move and --turn the moves: give one or the other",
         {}});
  }
  if (!options.shift.empty()) {
    std::array<double, 6> by{};
    std::ranges::copy(options.shift, by.begin());
    return Rewrite(options, [&](const std::string& text) { return optimo::Shift(text, by); });
  }
  if (options.move.empty() && options.turn.empty()) {
    return Refuse({ErrorCode::kCellUsage, "nothing to do: give --move, --turn or --shift", {}});
  }
  std::array<double, 3> move{}, turn{};
  std::ranges::copy(options.move, move.begin());
  std::ranges::copy(options.turn, turn.begin());
  const auto motion = motion::RigidMotionOf({move[0], move[1], move[2]}, turn[0], turn[1], turn[2]);
  return Rewrite(options, [&](const std::string& text) { return optimo::Transform(text, motion); });
}

int List(const ToolOptions& options) {
  const Result<Source> source = ReadSource(options.file);
  if (!source) return Refuse(source.error());
  ToolAnswer answer(options.file, options.json);
  const auto compiled = CompileFile(options.file, {source->text, false}, false, answer);
  if (!compiled) return answer.Failed();
  return answer.Deliver(optimo::List(compiled->module), OrStandardOutput(options.output),
                        "list of " + options.file);
}

}  // namespace rmlcell::cli
