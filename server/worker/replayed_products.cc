#include "server/worker/replayed_products.h"

#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "engine/machine/machine_note.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/framing.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/report.h"
#include "proto/bridge/series.h"
#include "proto/bridge/spooled_bytes.h"
#include "proto/bridge/ticket.h"
#include "proto/recording/replay.h"
#include "server/worker/step_map.h"

namespace rmlcell::server {
namespace {

constexpr std::int64_t kRecordingMax = std::int64_t{1} << 30;

// Pieces of the file are framed, as those of a job are.
class ToolpathFile {
 public:
  explicit ToolpathFile(const std::string& path) : file_(path, std::ios::binary) {}
  bool Add(std::string_view block) {
    const auto length = bridge::FrameLength(block);
    file_.write(length.data(), length.size());
    file_.write(block.data(), static_cast<std::streamsize>(block.size()));
    return file_.good();
  }
  bool Close() {
    file_.close();
    return !file_.fail();
  }

 private:
  std::ofstream file_;
};

Status Write(const std::string& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file.fail()) return Error{ErrorCode::kCellFileUnwritable, path, {}};
  return {};
}

// What the run began with, as far as it is known before it is played.
Result<machine::RunSetup> SetupOf(const recording::Recording& recording,
                                  const recording::RecordedMachine& machine) {
  const auto note = machine::ReadMachineNote(recording.entries.front().mark().state());
  if (!note) return note.error();
  machine::MachineMemory memory = recording::MemoryOf(recording.head);
  machine::RunSetup setup(machine.parameters);
  setup.programs = std::move(memory.programs);
  setup.deleted_programs = std::move(memory.deleted);
  setup.schedules = std::move(memory.schedules);
  for (const v1::JournalEntry& entry : recording.entries) {
    if (!entry.applied().input().has_start()) continue;
    setup.main_program = entry.applied().input().start().program();
    break;
  }
  if (recording.head.has_brought()) {
    auto brought =
        recording::ProgramOf(recording.head.brought(), *machine.family, machine.parameters);
    if (!brought) return brought.error();
    setup.programs[setup.main_program] = *std::move(brought);
  }
  setup.machine_state = note->family;
  setup.mode = note->mode;
  setup.override_percent = note->override_percent;
  setup.budget = {.steps = 0, .virtual_time = SimTime(0)};
  return setup;
}

// The products of the first run that is played.
class Maker {
 public:
  Maker(const machine::MachineFamily& family, machine::RunSetup setup, std::string folder)
      : family_(family), folder_(std::move(folder)), toolpath_(folder_ + "/toolpath") {
    simulation::Products products;
    products.picture = true;
    products.toolpath = [this](std::string_view block) { return toolpath_.Add(block); };
    recorder_ = std::make_unique<simulation::Recorder>(family.Shape(setup.parameters),
                                                       simulation::DescribeInputs(family, setup),
                                                       std::move(products));
    steps_ = StepMapOf(family, setup);
    depends_on_ = bridge::DigestsOf(bridge::DependenciesOf(family, setup));
  }

  machine::RunObserver& observer() { return *recorder_; }
  void Begin(const machine::Run& run) {
    if (!std::exchange(begun_, true)) recorder_->Begin(run);
  }
  void End(const machine::RunOver& over) {
    if (report_) return;
    recorder_->Finish(*over.ended);
    report_ = recorder_->Report(*over.ended);
    // An emergency stop ends a run of a machine that has no number for it, too: it has failed.
    if (over.outcome.code == report_->outcome.code) return;
    report_->outcome = over.outcome;
    report_->judgement = simulation::Judge(*report_);
  }
  // By the end of its host, which is no end of a program.
  void CutOff(const machine::RunOver& over, const v1::Outcome& outcome) {
    if (!begun_ || report_) return;
    End(over);
    cut_off_ = outcome;
    report_->outcome.kind = machine::OutcomeKind::kFailed;  // no part is left that could be good
    report_->outcome.code = outcome.code() == CodeText(ErrorCode::kCellHostStopped)
                                ? ErrorCode::kCellHostStopped
                                : ErrorCode::kCellHostDied;
    report_->judgement = simulation::Judge(*report_);
  }

  bool over() const { return report_.has_value(); }

  Status WriteAll() {
    if (!report_)
      return Error{ErrorCode::kCellPrecondition, "the recording ends before the run does", {}};
    v1::RunReport report = bridge::ToProto(family_.info(), *report_, {});
    report.mutable_inputs()->insert(depends_on_.begin(), depends_on_.end());
    if (cut_off_) {
      const v1::Verdict verdict = report.outcome().verdict();
      auto reasons = report.outcome().reasons();
      *report.mutable_outcome() = *cut_off_;
      report.mutable_outcome()->set_verdict(verdict);
      *report.mutable_outcome()->mutable_reasons() = std::move(reasons);
    }
    if (!toolpath_.Close()) return Error{ErrorCode::kCellFileUnwritable, folder_ + "/toolpath", {}};
    Status written = Write(folder_ + "/report", bridge::StableBytes(report));
    if (written) written = Write(folder_ + "/picture.svg", recorder_->Svg(*report_, {}));
    if (written && !steps_.empty()) written = Write(folder_ + "/steps", steps_);
    return written;
  }

 private:
  const machine::MachineFamily& family_;
  const std::string folder_;
  ToolpathFile toolpath_;
  std::unique_ptr<simulation::Recorder> recorder_;
  std::string steps_;
  std::map<std::string, std::string> depends_on_;
  bool begun_ = false;
  std::optional<simulation::RunReport> report_;
  std::optional<v1::Outcome> cut_off_;
};

Error Differs(const recording::Difference& difference) {
  return {ErrorCode::kCellReplayDiffers,
          "entry " + std::to_string(difference.sequence) + ", " + difference.field + ": recorded " +
              difference.recorded + ", played " + difference.played,
          {}};
}

}  // namespace

Status MakeProducts(const std::string& file, const std::string& folder) {
  const auto bytes = bridge::ReadProgram(file, kRecordingMax);
  if (!bytes) return bytes.error();
  const auto recording = recording::ReadFile(**bytes);
  if (!recording) return recording.error();
  const auto machine = recording::MachineOf(recording->head);
  if (!machine) return machine.error();
  auto setup = SetupOf(*recording, *machine);
  if (!setup) return setup.error();
  Maker maker(*machine->family, *std::move(setup), folder);
  recording::ReplayOptions options;
  options.observer = &maker.observer();
  options.begun = [&maker](const machine::Run& run) { maker.Begin(run); };
  options.over = [&maker](const machine::RunOver& over) { maker.End(over); };
  options.cut_off = [&maker](const machine::RunOver& over, const v1::Outcome& outcome) {
    maker.CutOff(over, outcome);
  };
  options.goes_on = [&maker](SimTime) { return !maker.over(); };  // what comes behind it is not its
  const auto replayed = recording::Replay(*recording, options);
  if (!replayed) return replayed.error();
  if (replayed->difference) return Differs(*replayed->difference);
  return maker.WriteAll();
}

}  // namespace rmlcell::server
