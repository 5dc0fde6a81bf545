#include "clients/cli/office.h"

#include <filesystem>

#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "engine/core/number_text.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/source_map.h"
#include "engine/optimo/offline/compensate.h"
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
  const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  return {.input = name(input), .output = output == "-" ? name(input) : name(output), .date = bridge::HeaderDate()};
}

// The result of a tool: to a file with a word about it, or to standard output without.
int Deliver(const std::string& bytes, const std::string& output, const std::string& what) {
  if (output == "-") {
    PrintRaw(bytes);
    return kGood;
  }
  if (const Status written = WriteWholeFile(output, bytes); !written) return Refuse(written.error());
  Print(output + ": " + what);
  return kGood;
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

// The object of a file; its findings are printed. Nothing when it has errors.
std::optional<optimo::Compilation> CompileFile(const std::string& file, const Source& source, bool advice) {
  optimo::Compilation compiled =
      optimo::Compile(source.text, file, {.object_limit = optimo::kObjectLimitStandard, .advice = advice, .inch = source.inch});
  ComplainOf(compiled.diagnostics, compiled.diagnostics_dropped, source.text);
  if (!compiled.ok) return std::nullopt;
  return compiled;
}

}  // namespace

int Compile(const std::string& file, const std::string& output, bool map) {
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  if (source->text.empty()) return Refuse({ErrorCode::kCellEmptyProgram, file, {}});
  const auto compiled = CompileFile(file, *source, true);
  if (!compiled) return kProgramErrors;
  const std::string target = output.empty() ? WithExtension(file, ".O") : output;
  if (map && target == "-") return Refuse({ErrorCode::kCellUsage, "--map: the object goes into no file", {}});
  if (map) {
    const std::string bytes =
        optimo::EncodeSourceMap(optimo::MapSource(source->text, source->inch, compiled->object));
    if (const Status written = WriteWholeFile(WithExtension(target, kMapExtension), bytes); !written) {
      return Refuse(written.error());
    }
  }
  return Deliver(compiled->object, target,
                 "object of " + std::to_string(compiled->object.size()) + " bytes, " +
                     std::to_string(compiled->module.step_count) + " steps");
}

int Decompile(const std::string& file, const std::string& output) {
  const Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return Refuse(bytes.error());
  // A map that is not there, cannot be read, or is of another object is passed over.
  const Result<std::string> map = bridge::ReadFile(WithExtension(file, kMapExtension), kFileBytesMax);
  const Result<optimo::RecoveredSource> source =
      optimo::RecoverSource(*bytes, map ? std::optional<std::string_view>(*map) : std::nullopt);
  if (!source) return Refuse(source.error());
  return Deliver(source->text, output.empty() ? "-" : output, "source of " + file);
}

int Link(const std::vector<std::string>& files, const std::vector<std::string>& slots, int main_slot,
         const std::string& output) {
  const Result<LoadedFiles> loaded = LoadFiles(files, slots, main_slot, "optimo");
  if (!loaded) return Refuse(loaded.error());
  std::map<int, std::string> objects;
  for (const bridge::ProgramInput& program : loaded->programs) {
    if (optimo::FormOfFile(program.file_name, *program.bytes) == optimo::FileForm::kObject) {
      objects[program.slot] = *program.bytes;
      continue;
    }
    const Source source{*program.bytes,
                        optimo::FormOfFile(program.file_name, *program.bytes) == optimo::FileForm::kInchSource};
    const auto compiled = CompileFile(program.file_name, source, false);
    if (!compiled) return kProgramErrors;
    objects[program.slot] = compiled->object;
  }
  const auto lookup = [&](int slot) -> std::optional<std::string_view> {
    const auto found = objects.find(slot);
    if (found == objects.end()) return std::nullopt;
    return found->second;
  };
  const Result<optimo::Executable> linked = optimo::Link(loaded->main_slot, lookup, {});
  if (!linked) {
    Complain(bridge::ErrorText(linked.error()));
    return kProgramErrors;
  }
  std::string what = "executable of program " + std::to_string(loaded->main_slot);
  for (std::size_t i = 1; i < linked->modules.size(); ++i) {
    what += (i == 1 ? " with FUNCTION " : ", ") + std::to_string(linked->modules[i].slot);
  }
  what += "; store it in slot " + std::to_string(loaded->main_slot + kExecutableOffset);
  return Deliver(optimo::EncodeExecutable(*linked), output, what);
}

int Format(const std::vector<std::string>& files, bool check_only) {
  int exit_code = kGood;
  for (const std::string& file : files) {
    const Result<std::string> text = bridge::ReadFile(file, kFileBytesMax);
    if (!text) return Refuse(text.error());
    if (optimo::FormOfFile(file, *text) == optimo::FileForm::kObject) {
      return Refuse({ErrorCode::kCellBadText, file + " is an object; rmlcell decompile gives its source", {}});
    }
    optimo::Compilation read = optimo::Compile(*text, file, {.object_limit = 0, .advice = false});
    const bool inch = optimo::FormOfFile(file, *text) == optimo::FileForm::kInchSource;
    if (!read.ok && !inch) {
      // It stays as it is where it cannot be read; say why.
      ComplainOf(read.diagnostics, read.diagnostics_dropped, *text);
      exit_code = kProgramErrors;
    }
    const optimo::Formatting formatted = optimo::Format(*text);
    if (!formatted.changed) continue;
    if (check_only) {
      Print(file);
      exit_code = kProgramErrors;
      continue;
    }
    if (const Status written = WriteWholeFile(file, formatted.text); !written) return Refuse(written.error());
    Print(file + ": formatted");
  }
  return exit_code;
}

int Convert(const std::vector<std::string>& arguments) {
  const auto request = optimo::ReadConvertArguments(arguments);
  if (!request) return Refuse(request.error());
  if (!*request) {
    Print("convert FILE.S            millimetres and radians to inches and degrees: FILE.SI\n"
          "convert FILE.SI           inches and degrees to millimetres and radians: FILE.S\n"
          "convert FILE [OUT] /i     any other name, to inches; /m to millimetres");
    return kUsage;
  }
  const optimo::ConvertRequest& wanted = **request;
  const Result<std::string> text = bridge::ReadFile(wanted.input, kFileBytesMax);
  if (!text) return Refuse({ErrorCode::kConvertInput, wanted.input + ": " + text.error().detail, {}});
  const optimo::Conversion converted =
      optimo::Convert(*text, wanted.direction, Names(wanted.input, wanted.output));
  ComplainOf(converted.diagnostics, 0, *text);
  if (const Status written = WriteWholeFile(wanted.output, converted.text); !written) {
    return Refuse({ErrorCode::kConvertOutput, written.error().detail, {}});
  }
  Print(wanted.output + ": " +
        (wanted.direction == optimo::Direction::kToInch ? "inches and degrees" : "millimetres and radians"));
  return HasErrors(converted.diagnostics) ? kProgramErrors : kGood;
}

int Compensate(const std::string& file, const std::string& output) {
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  const std::string target = output.empty() ? WithExtension(file, ".CMP") : output;
  const optimo::Compensation made = optimo::Compensate(source->text, Names(file, target), source->inch);
  ComplainOf(made.diagnostics, 0, source->text);
  return made.ok ? Deliver(made.text, target, "compensated") : int{kProgramErrors};
}

namespace {

int Rewrite(const std::string& file, const std::string& output,
            const std::function<optimo::Rewriting(const std::string&)>& rewrite) {
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  if (source->inch) return Refuse({ErrorCode::kSourceIsInch, file, {}});
  const optimo::Rewriting made = rewrite(source->text);
  ComplainOf(made.diagnostics, 0, source->text);
  return made.ok ? Deliver(made.text, output.empty() ? "-" : output, "rewritten from " + file) : int{kProgramErrors};
}

}  // namespace

int Transform(const std::string& file, const std::array<double, 3>& move, const std::array<double, 3>& turn,
              const std::string& output) {
  const auto motion = optimo::RigidMotion::Of({move[0], move[1], move[2]}, turn[0], turn[1], turn[2]);
  return Rewrite(file, output, [&](const std::string& text) { return optimo::Transform(text, motion); });
}

int Shift(const std::string& file, const std::array<double, 6>& by, const std::string& output) {
  return Rewrite(file, output, [&](const std::string& text) { return optimo::Shift(text, by); });
}

int List(const std::string& file, const std::string& output) {
  const Result<Source> source = ReadSource(file);
  if (!source) return Refuse(source.error());
  const auto compiled = CompileFile(file, {source->text, false}, false);
  if (!compiled) return kProgramErrors;
  return Deliver(optimo::List(compiled->module), output.empty() ? "-" : output, "list of " + file);
}

}  // namespace rmlcell::cli
