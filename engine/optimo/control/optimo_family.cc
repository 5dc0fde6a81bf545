#include "engine/optimo/control/optimo_family.h"

#include <algorithm>
#include <array>

#include "engine/optimo/control/optimo_run.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"

namespace rmlcell::optimo {
namespace {

constexpr machine::FamilyInfo kInfo = {.id = "optimo",
                                       .title = "Amada OPTIMO 5-axis laser",
                                       .extensions = ".S .SI .CMP .O",
                                       .axes = "X Y Z A B",
                                       .has_executables = true,
                                       .has_schedules = true};

constexpr std::array kFigures = {
    machine::FigureInfo{"lookahead_starved", "", "knots that the planner had to decide before it could see enough"},
    machine::FigureInfo{"executables_made", "", "executables that the run had to make"},
};

bool HasExtension(std::string_view name, std::string_view extension) {
  if (name.size() < extension.size()) return false;
  return std::ranges::equal(name.substr(name.size() - extension.size()), extension, [](char a, char b) {
    return (a >= 'a' && a <= 'z' ? static_cast<char>(a - 'a' + 'A') : a) == b;
  });
}

machine::Translation TranslateObject(const machine::SourceFile& file, const Result<Module>& module) {
  machine::Translation translation;
  if (!module) {
    translation.diagnostics.push_back({.code = module.error().code,
                                       .severity = Lookup(module.error().code).severity,
                                       .detail = module.error().detail,
                                       .rule = "OPT-B.71",
                                       .file = std::string(file.name)});
    return translation;
  }
  translation.ok = true;
  translation.object = std::string(file.bytes);
  translation.figures = {{"steps", "", static_cast<double>(module->step_count)},
                         {"object_bytes", "bytes", static_cast<double>(file.bytes.size())}};
  return translation;
}

class Family final : public machine::MachineFamily {
 public:
  const machine::FamilyInfo& info() const override { return kInfo; }
  std::span<const machine::ParameterInfo> parameters() const override { return OptimoParameterTable(); }
  std::span<const machine::MachineProfile> profiles() const override { return OptimoProfiles(); }
  std::span<const machine::FigureInfo> figures() const override { return kFigures; }
  machine::MachineShape Shape(const machine::Parameters& parameters) const override {
    return ShapeOf(Resolve(parameters));
  }

  machine::Translation Translate(const machine::SourceFile& file, const machine::Parameters& parameters,
                                 const machine::CheckOptions& options) const override {
    if (HasExtension(file.name, ".O")) return TranslateObject(file, DecodeObject(file.bytes));
    Compilation compiled = Compile(file.bytes, file.name,
                                   {.object_limit = static_cast<std::uint32_t>(Resolve(parameters).object_limit),
                                    .advice = options.advice,
                                    .inch = HasExtension(file.name, ".SI"),
                                    .diagnostics_max = machine::kDiagnosticsMax});
    machine::Translation translation;
    translation.ok = compiled.ok;
    translation.object = std::move(compiled.object);
    translation.diagnostics = std::move(compiled.diagnostics);
    translation.diagnostics_dropped = compiled.diagnostics_dropped;
    if (translation.ok) {
      translation.figures = {{"steps", "", static_cast<double>(compiled.module.step_count)},
                             {"object_bytes", "bytes", static_cast<double>(translation.object.size())}};
    }
    return translation;
  }

  machine::TransferPlan PlanTransfer(const machine::ProjectBundle& project, const machine::Parameters& parameters,
                                     const machine::TransferOptions& options) const override;

  Result<std::string> Decompile(std::string_view object) const override { return ObjectToSource(object); }

  Status CheckExecutable(std::string_view executable) const override {
    const Result<Executable> decoded = DecodeExecutable(executable);
    if (!decoded) return decoded.error();
    return {};
  }

  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override {
    if (!setup.machine_state.empty()) {
      if (const Result<MachineState> state = DecodeMachineState(setup.machine_state); !state) return state.error();
    }
    const OptimoParameters resolved = Resolve(setup.parameters);
    return std::unique_ptr<machine::Run>(std::make_unique<OptimoRun>(resolved, std::move(setup), observer));
  }
};

machine::TransferPlan Family::PlanTransfer(const machine::ProjectBundle&, const machine::Parameters&,
                                           const machine::TransferOptions&) const {
  return {};
}

}  // namespace

const machine::MachineFamily& OptimoFamily() {
  static const Family family;
  return family;
}

}  // namespace rmlcell::optimo
