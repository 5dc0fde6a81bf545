#include "engine/optimo/control/optimo_tools.h"

#include <utility>

#include "engine/core/units.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/formatter.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/source_map.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/contour_advice.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/fix_program.h"
#include "engine/optimo/offline/listing.h"
#include "engine/optimo/offline/semantic_diff.h"
#include "engine/optimo/offline/transform.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

constexpr machine::FileExtensions kExtensions{.object = ".O",
                                              .executable = ".X",
                                              .listing = ".LST",
                                              .compensated = ".CMP",
                                              .source_map = ".MAP"};

constexpr machine::ToolCodes kCodes{.source_is_inch = ErrorCode::kSourceIsInch,
                                    .convert_input = ErrorCode::kConvertInput,
                                    .convert_output = ErrorCode::kConvertOutput};

class Tools final : public machine::Tools {
 public:
  const machine::FileExtensions& extensions() const override { return kExtensions; }
  const machine::ToolCodes& codes() const override { return kCodes; }

  FileForm FormOf(std::string_view name, std::string_view bytes) const override {
    return FormOfFile(name, bytes);
  }

  Status CheckIsText(std::string_view name, std::string_view bytes) const override {
    return optimo::CheckIsText(name, bytes);
  }

  machine::CompiledProgram Compile(const machine::SourceFile& file,
                                   const machine::Parameters& parameters,
                                   const machine::CompileOptions& options) const override {
    const OptimoParameters resolved = Resolve(parameters);
    Compilation compiled = optimo::Compile(
        file.bytes, file.name,
        {.object_limit = options.any_size ? 0 : static_cast<std::uint32_t>(resolved.object_limit),
         .advice = options.advice,
         .inch = options.inch,
         .further_advice = ContourAdvice(ContourMachineOf(resolved))});
    machine::CompiledProgram made{.ok = compiled.ok,
                                  .object = std::move(compiled.object),
                                  .steps = static_cast<int>(compiled.module.step_count),
                                  .diagnostics = std::move(compiled.diagnostics),
                                  .diagnostics_dropped = compiled.diagnostics_dropped};
    if (made.ok && options.source_map)
      made.source_map = EncodeSourceMap(MapSource(file.bytes, options.inch, made.object));
    return made;
  }

  Result<machine::RecoveredSource> Decompile(
      std::string_view object, std::optional<std::string_view> source_map) const override {
    Result<RecoveredSource> source = RecoverSource(object, source_map);
    if (!source) return source.error();
    return machine::RecoveredSource{std::move(source->text), source->own_text, source->inch};
  }

  Result<machine::LinkedProgram> Link(int slot, const machine::ObjectLookup& lookup,
                                      const machine::Parameters& parameters) const override {
    const OptimoParameters resolved = Resolve(parameters);
    const Result<Executable> linked =
        optimo::Link(slot, lookup,
                     {.executable_limit = static_cast<std::uint32_t>(resolved.executable_limit),
                      .rotary_table = resolved.rotary_table});
    if (!linked) return linked.error();
    machine::LinkedProgram made{EncodeExecutable(*linked), {}};
    for (const LinkedModule& function : std::span(linked->modules).subspan(1))
      made.functions.push_back(function.slot);
    return made;
  }

  machine::FormattedText Format(const machine::SourceFile& file) const override {
    Compilation read = optimo::Compile(file.bytes, file.name, {.object_limit = 0, .advice = false});
    Formatting formatted = optimo::Format(file.bytes);
    machine::FormattedText made{
        .text = std::move(formatted.text), .changed = formatted.changed, .readable = read.ok};
    // The numbers of an inch source are not for the control; only its form matters here.
    if (FormOfFile(file.name, file.bytes) == FileForm::kInchSource) {
      made.readable = true;
    } else {
      made.diagnostics = std::move(read.diagnostics);
      made.diagnostics_dropped = read.diagnostics_dropped;
    }
    return made;
  }

  Result<std::optional<ConvertRequest>> ReadConvertArguments(
      std::span<const std::string> arguments) const override {
    return optimo::ReadConvertArguments(arguments);
  }

  machine::RewrittenText Convert(std::string_view text, Direction direction,
                                 const FileNames& names) const override {
    Conversion made = optimo::Convert(text, direction, names);
    return {.ok = true,
            .text = std::move(made.text),
            .diagnostics = std::move(made.diagnostics),
            .diagnostics_dropped = std::move(made.diagnostics_dropped)};
  }

  machine::RewrittenText Compensate(std::string_view text, const FileNames& names,
                                    bool inch) const override {
    Compensation made = optimo::Compensate(text, names, inch);
    return {.ok = made.ok,
            .text = std::move(made.text),
            .diagnostics = std::move(made.diagnostics),
            .diagnostics_dropped = std::move(made.diagnostics_dropped)};
  }

  machine::RewrittenText Transform(std::string_view text,
                                   const machine::Displacement& by) const override {
    const auto& [x, y, z] = by.move_mm;
    const auto& [rz, ry, rx] = by.turn_rad;
    return optimo::Transform(text, motion::RigidMotionOf({x, y, z}, rz, ry, rx));
  }

  machine::RewrittenText Shift(std::string_view text,
                               const machine::Displacement& by) const override {
    const auto& [x, y, z] = by.move_mm;
    const auto& [rz, ry, rx] = by.turn_rad;
    return optimo::Shift(text, {x, y, z, rz, ry, rx});
  }

  Result<std::string> List(std::string_view object) const override {
    const Result<Module> module = DecodeObject(object);
    if (!module) return module.error();
    return optimo::List(*module);
  }

  RepairedText Fix(const machine::SourceFile& file, const ProgramCheck& check) const override {
    return FixProgram(file, check);
  }

  Result<ProgramDiff> Diff(const machine::ComparedObject& a,
                           const machine::ComparedObject& b) const override {
    const Result<Module> before = DecodeObject(a.object);
    if (!before) return before.error();
    const Result<Module> after = DecodeObject(b.object);
    if (!after) return after.error();
    return optimo::Diff(*before, *after, a.figures, b.figures);
  }
};

}  // namespace

const machine::Tools& OptimoTools() {
  static const Tools tools;
  return tools;
}

}  // namespace rmlcell::optimo
