#include "engine/rml1/rml1_family.h"

#include <algorithm>
#include <set>

#include "engine/core/number_text.h"
#include "engine/machine/shape.h"
#include "engine/rml1/command_facts.h"
#include "engine/rml1/figures.h"
#include "engine/rml1/panel.h"
#include "engine/rml1/physical.h"
#include "engine/rml1/run.h"
#include "engine/rml1/standing.h"
#include "engine/rml1/timing.h"
#include "engine/rml1/variables.h"
#include "engine/rml1/verdict_rules.h"

namespace rmlcell::rml1 {
namespace {

constexpr std::array<std::string_view, 1> kWaiting = {"DW"};

constexpr machine::FamilyInfo kInfo = {.id = "rml1",
                                       .title = "Roland mill or engraver, RML-1",
                                       .extensions = ".RML .PRN",
                                       .axes = "X Y Z A",
                                       .editor_language = "rml1",
                                       .has_executables = false,
                                       .hold_in_remote = true,  // it has no such mode
                                       .turns_in_degrees = true,
                                       .default_profile = "srm-20",  // the most common one
                                       .origin_parameters = {"ORIGIN_X", "ORIGIN_Y", "Z0"},
                                       .clamps_parameter = "CLAMP_HEIGHT",
                                       .override_min_percent = kOverrideMin,
                                       .override_max_percent = 145.0,
                                       .jog_axes = "X Y Z A",
                                       .cover_stops_jog = true,
                                       .start_takes_back = true,
                                       .spindle_speed = "RPM",
                                       .waiting = kWaiting,
                                       .has_breakpoints = true,
                                       .torn = ErrorCode::kRml1IncompleteCommand};

Diagnostic Plain(ErrorCode code, Detail detail) {
  return {.code = code,
          .severity = Lookup(code).severity,
          .detail = std::move(detail),
          .rule = {},
          .file = {},
          .where = {},
          .program = 0,
          .step = 0,
          .fixes = {}};
}

// The diagnostics of one stream: as many as a translation holds, and the kinds of the rest.
class Findings final : public DeviceListener {
 public:
  Findings(const machine::SourceFile& file, bool advice, machine::Translation& translation)
      : file_(file), advice_(advice), translation_(translation) {}

  void OnFinding(const Finding& finding) override {
    if (!Wants(RowOf(finding.kind).code)) return;
    if (full()) return OnCounted(finding);
    Add(ToDiagnostic(finding, file_.bytes, lines_));
  }

  void OnCounted(const Finding& finding) override {
    if (!Wants(RowOf(finding.kind).code)) return;
    Count(PlainDiagnostic(finding, file_.bytes, lines_));
  }

  void AddAdvice(ErrorCode code, Detail detail, std::string rule, const SourceSpan& at, int step) {
    if (!Wants(code)) return;
    Diagnostic diagnostic = Plain(code, std::move(detail));
    diagnostic.rule = std::move(rule);
    diagnostic.where = lines_.At(file_.bytes, at.byte_offset, at.length);
    diagnostic.step = step;
    if (full()) return Count(std::move(diagnostic));
    Add(std::move(diagnostic));
  }

 private:
  bool Wants(ErrorCode code) const { return advice_ || Lookup(code).severity != Severity::kAdvice; }
  bool full() const { return translation_.diagnostics.size() >= machine::kDiagnosticsMax; }
  void Add(Diagnostic diagnostic) {
    diagnostic.file = file_.name;
    translation_.diagnostics.push_back(std::move(diagnostic));
  }

  void Count(Diagnostic diagnostic) {
    diagnostic.file = file_.name;
    translation_.diagnostics_dropped.Add(diagnostic);
  }

  const machine::SourceFile& file_;
  bool advice_;
  machine::Translation& translation_;
  LineCounter lines_;
};

// What is no stream at all is shown by one finding of each kind: more say nothing else.
void TellKindsOnce(machine::Translation& translation) {
  std::set<ErrorCode> told;
  std::erase_if(translation.diagnostics, [&](const Diagnostic& finding) {
    if (told.insert(finding.code).second) return false;
    translation.diagnostics_dropped.Add(finding);
    return true;
  });
}

// Runs a stream through a device at once, whatever time its actions would take.
class StreamReading {
 public:
  StreamReading(const Profile& profile, Findings& findings)
      : profile_(profile), findings_(findings), device_(profile), physical_(profile) {
    tool_ = device_.carriage().physical();
  }

  void Run(const machine::SourceFile& file) {
    for (std::size_t at = 0; at < file.bytes.size(); at += machine::kReleaseEvery) {
      Read(file.bytes.substr(at, machine::kReleaseEvery), static_cast<std::int64_t>(at));
      if (file.keeper != nullptr) file.keeper->Release();
    }
    device_.EndOfData();
    if (!device_.pending()) return;
    findings_.AddAdvice(ErrorCode::kRml1IncompleteCommand, "incomplete command at end of data",
                        "RML1-9.42", {.length = 1, .byte_offset = device_.pending_offset()}, 0);
  }

  const Device& device() const { return device_; }
  // With what a check alone tells: how long a run takes at least, which ends at its budget, and
  // where it went on and a run waits for the resume key.
  std::vector<machine::Figure> Figures() const {
    std::vector<machine::Figure> figures = FiguresOf(device_, physical_, true);
    figures.push_back({.name = "least_time", .unit = "s", .value = least_time_s_});
    constexpr double kDay_s = 24.0 * 3600.0;
    figures.push_back({.name = "least_days", .unit = {}, .value = least_time_s_ / kDay_s});
    if (pauses_ == 0) return figures;
    figures.push_back({.name = "waits_for_key",
                       .unit = {},
                       .value = static_cast<double>(pauses_),
                       .first = {.step = static_cast<int>(first_pause_.number),
                                 .byte_offset = first_pause_.offset}});
    return figures;
  }

 private:
  void Read(std::string_view part, std::int64_t offset) {
    while (!part.empty()) {
      const std::size_t read = device_.Read(part, offset, Device::kAnyCommands, findings_).bytes;
      part.remove_prefix(read);
      offset += static_cast<std::int64_t>(read);
      do {
        while (!device_.actions().empty()) CarryOut();
      } while (device_.Step(findings_));
    }
  }
  void CarryOut() {
    const Action action = device_.actions().front();
    device_.actions().Pop();
    least_time_s_ += LeastTime_s(action);
    if (action.kind == Action::Kind::kMotion) {
      physical_.OnRide(
          {.from = tool_,
           .to = action.to,
           .use = action.use,
           .length_mm = DistanceXYZ(tool_, action.to) / profile_.units_per_mm,
           .in_work = Physical::IsInWork(action.use, tool_, action.to, device_.registers()),
           .rapid = action.rapid,
           .chain = action.chain,
           .spindle_turns = device_.spindle_turns()},
          device_.registers(), device_.command());
      tool_ = action.to;
    } else if (action.kind == Action::Kind::kPause) {
      const CommandPlace& place = device_.command();
      if (pauses_ == 0) first_pause_ = place;
      ++pauses_;
      findings_.AddAdvice(ErrorCode::kRml1PausedAtEnd, "the machine waits for its resume key here",
                          "RML1-3C.08", {.length = 3, .byte_offset = place.offset},
                          static_cast<int>(place.number));
    }
  }

  // Ramps and corners take more.
  double LeastTime_s(const Action& action) const {
    switch (action.kind) {
      case Action::Kind::kMotion:
        return DistanceXYZ(tool_, action.to) / profile_.units_per_mm / action.speed_mm_s;
      case Action::Kind::kDwell:
        return action.dwell_ms * 1e-3;
      case Action::Kind::kSpindleStart:
        return profile_.spin_up_s;
      case Action::Kind::kSpindleStop:
        return action.waits ? profile_.spin_down_s : 0.0;
      default:
        return 0.0;
    }
  }

  const Profile& profile_;
  Findings& findings_;
  Device device_;
  Physical physical_;
  Point tool_;
  std::uint64_t pauses_ = 0;
  CommandPlace first_pause_;
  double least_time_s_ = 0.0;
};

class MillFamily final : public machine::MachineFamily {
 public:
  const machine::FamilyInfo& info() const override { return kInfo; }
  std::span<const machine::ParameterInfo> parameters() const override { return ParameterTable(); }
  std::span<const machine::MachineProfile> profiles() const override { return MachineProfiles(); }
  Status CheckParameters(const machine::Parameters& parameters) const override {
    return CheckFit(parameters);
  }
  bool HasVariable(const machine::Parameters& parameters, std::string_view name) const override {
    const Result<Profile> profile = MakeProfile(parameters);
    return profile && HasRegister(*profile, name);
  }
  std::span<const machine::FigureInfo> figures() const override { return FigureTable(); }
  std::span<const machine::VerdictRule> verdict_rules() const override { return VerdictRules(); }
  machine::MachineShape Shape(const machine::Parameters& parameters) const override;
  machine::Panel ShowPanel(const machine::MachineStatus& status) const override {
    return ShowMillPanel(status);
  }
  std::vector<machine::LanguageWord> words() const override { return CommandFacts(); }
  machine::Translation Translate(const machine::SourceFile& file,
                                 const machine::Parameters& parameters,
                                 const machine::CheckOptions& options) const override;
  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override;
  Result<std::unique_ptr<machine::Standing>> NewStanding(
      const machine::Parameters& parameters, std::string_view machine_state) const override;
};

machine::MachineShape MillFamily::Shape(const machine::Parameters& parameters) const {
  const Result<Profile> made = MakeProfile(parameters);
  if (!made) return {};
  const Profile& p = *made;
  const auto mm = [&p](double x, double y, double z) -> motion::MachinePoint {
    return motion::MachineVector{x, y, z} * (1.0 / p.units_per_mm);
  };
  machine::MachineShape shape;
  shape.travel.Add(mm(p.x.low, p.y.low, p.z.low));
  shape.travel.Add(mm(p.x.high, p.y.high, p.z.high));
  shape.has_work_origin = true;
  shape.work_origin = mm(p.origin_x, p.origin_y, p.z0);
  shape.limits = MillLimits(p);
  return shape;
}

machine::Translation MillFamily::Translate(const machine::SourceFile& file,
                                           const machine::Parameters& parameters,
                                           const machine::CheckOptions& options) const {
  machine::Translation translation;
  const auto refuse = [&](ErrorCode code, Detail detail) {
    translation.diagnostics.push_back(Plain(code, std::move(detail)));
    translation.diagnostics.back().file = file.name;
    return translation;
  };
  if (file.bytes.empty()) return refuse(ErrorCode::kCellEmptyProgram, "the stream has no bytes");
  const Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return refuse(profile.error().code, profile.error().detail);

  Findings findings(file, options.advice, translation);
  StreamReading reading(*profile, findings);
  reading.Run(file);
  const double foreign_percent = reading.device().foreign_percent();
  if (foreign_percent > kForeignShareMax_percent && !options.forced) {
    translation.figures = reading.Figures();
    TellKindsOnce(translation);
    translation.diagnostics.insert(
        translation.diagnostics.begin(),
        Plain(ErrorCode::kRml1NoProgram,
              Told("share", foreign_percent, "%", FixedText(foreign_percent, 1) + " %") +
                  " of the bytes belong to no command"));
    translation.diagnostics.front().file = file.name;
    return translation;
  }
  translation.ok = true;
  translation.as_it_came = true;
  translation.figures = reading.Figures();
  PlaceFigures(file.bytes, file.keeper, 0, translation.figures);
  translation.figures.push_back(
      {.name = "object_bytes", .unit = "bytes", .value = static_cast<double>(file.bytes.size())});
  return translation;
}

Result<std::unique_ptr<machine::Run>> MillFamily::NewRun(machine::RunSetup setup,
                                                         machine::RunObserver& observer) const {
  Result<std::unique_ptr<MillRun>> run = MillRun::Make(std::move(setup), observer);
  if (!run) return run.error();
  return std::unique_ptr<machine::Run>(std::move(*run));
}

Result<std::unique_ptr<machine::Standing>> MillFamily::NewStanding(
    const machine::Parameters& parameters, std::string_view machine_state) const {
  Result<Profile> profile = MakeProfile(parameters);
  if (!profile) return profile.error();
  return MillStanding::Make(*std::move(profile), machine_state);
}

}  // namespace

const machine::MachineFamily& Rml1Family() {
  static const MillFamily family;
  return family;
}

}  // namespace rmlcell::rml1
