#include "tests/conformance/rml1_bench.h"

#include "engine/core/number_text.h"
#include "engine/machine/run.h"
#include "engine/rml1/rml1_family.h"
#include "engine/rml1/variables.h"

namespace rmlcell::rml1::conformance {
namespace {

using Event = Observed::Event;

// Everything a run tells, as the trace of an example.
class TraceObserver final : public machine::RunObserver {
 public:
  void OnStep(SimTime, const machine::Place&, std::string_view instruction) override {
    if (instruction == "H" || instruction == "IN") seen.log_cleared_at = seen.log.size();
  }
  void OnMove(const machine::MoveDone& move) override {
    seen.trace.push_back({.kind = Event::Kind::kMove,
                          .x = move.program_point.x(),
                          .y = move.program_point.y(),
                          .z = move.program_point.z(),
                          .a = move.rotary_a,
                          .feed = move.feed_mm_s});
  }
  void OnSignal(const machine::SignalChange& change) override {
    if (change.signal == machine::Signal::kSpindleSpeed) {
      Add(Event::Kind::kRpm, static_cast<int>(change.value));
    } else if (change.signal == machine::Signal::kSpindle && change.value != 0.0) {
      Add(Event::Kind::kSpin, static_cast<int>(change.detail));
    } else if (change.signal == machine::Signal::kSpindle) {
      Add(Event::Kind::kStop, 0);
    }
  }
  void OnWait(const machine::Wait& wait) override {
    if (wait.kind != machine::WaitKind::kDwell) return;
    Add(Event::Kind::kDwell, static_cast<int>(ToSeconds(wait.end - wait.start) * 1e3 + 0.5));
  }
  void OnHalt(const machine::Halt& halt) override {
    last_halt = halt.why;
    Add(Event::Kind::kPause, 0);
  }
  void OnDiagnostic(SimTime, const Diagnostic& diagnostic) override {
    const CatalogueEntry& entry = Lookup(diagnostic.code);
    if (entry.number >= 1 && entry.number <= 3) seen.log.push_back(entry.number);
    if (entry.number >= 10 && entry.number <= 18) seen.comlog.push_back(entry.number);
    if (diagnostic.code == ErrorCode::kRml1IncompleteCommand) seen.pending = true;
  }

  Observed seen;
  std::string last_halt;

 private:
  void Add(Event::Kind kind, int number) {
    Event event;
    event.kind = kind;
    event.number = number;
    seen.trace.push_back(event);
  }
};

double NumberOf(const machine::Run& run, std::string_view name) {
  const std::optional<machine::VariableValue> value = run.ReadVariable(name);
  return value ? ParseDouble(value->text).value() : 0.0;
}

void ReadState(const machine::Run& run, Observed& seen) {
  seen.err = static_cast<int>(NumberOf(run, "ERR"));
  seen.com = static_cast<int>(NumberOf(run, "COM"));
  seen.mode = run.ReadVariable("MODE")->text;
  seen.tool = run.ReadVariable("TOOL")->text;
  seen.vs = NumberOf(run, "VS");
  seen.vz = NumberOf(run, "VZ");
  seen.z0 = NumberOf(run, "Z0");
  seen.z1 = NumberOf(run, "Z1");
  seen.z2 = NumberOf(run, "Z2");
  seen.dwell_ms = static_cast<int>(NumberOf(run, "DW"));
  seen.rpm = static_cast<int>(NumberOf(run, "RPM"));
  seen.rotation = run.ReadVariable("MC")->text == "on";
  seen.spindle_on = run.ReadVariable("SPINDLE")->text == "on";
  seen.at.x = NumberOf(run, "X");
  seen.at.y = NumberOf(run, "Y");
  seen.at.z = NumberOf(run, "Z");
  seen.at.a = NumberOf(run, "A");
  seen.logical.x = NumberOf(run, "LX");
  seen.logical.y = NumberOf(run, "LY");
  seen.logical.z = NumberOf(run, "LZ");
  seen.esc_m = run.ReadVariable("ESC.M")->text;
  seen.esc_t = run.ReadVariable("ESC.T")->text;
}

std::vector<int> Numbers(const ErrorLog& log) {
  std::vector<int> numbers;
  for (const ErrorLog::Entry& entry : log.entries()) numbers.push_back(entry.number);
  return numbers;
}

}  // namespace

Bench::Bench(const machine::Parameters& parameters, bool resumes_outside_pauses)
    : profile_(MakeProfile(parameters).value()),
      resumes_outside_pauses_(resumes_outside_pauses),
      device_(std::make_unique<Device>(profile_)) {}

void Bench::Feed(std::string_view chunk) {
  for (const char c : chunk) {
    device_->Receive(static_cast<unsigned char>(c), offset_++, *this);
    Work();
  }
}

void Bench::PressResume() {
  if (!device_->paused()) return;
  device_->actions().Pop();
  pause_told_ = false;
  Work();
}

void Bench::Work() {
  for (;;) {
    while (!device_->actions().empty()) {
      const Action action = device_->actions().front();
      if (action.kind == Action::Kind::kPause) {
        if (!pause_told_) trace_.push_back({.kind = Event::Kind::kPause});
        pause_told_ = true;
        if (!action.outside || !resumes_outside_pauses_) return;
        pause_told_ = false;
      }
      device_->actions().Pop();
      CarryOut(action);
    }
    if (!device_->Step(*this)) return;
  }
}

void Bench::CarryOut(const Action& action) {
  Event event;
  switch (action.kind) {
    case Action::Kind::kMotion:
      event.x = action.to.x - profile_.origin_x;
      event.y = action.to.y - profile_.origin_y;
      event.z = action.to.z - device_->registers().z0;
      event.a = action.to.a;
      event.feed = action.speed_mm_s;
      break;
    case Action::Kind::kSpindleStart:
      event.kind = Event::Kind::kSpin;
      event.number = action.rpm;
      break;
    case Action::Kind::kSpindleStop:
      event.kind = Event::Kind::kStop;
      break;
    case Action::Kind::kSpindleSpeed:
      event.kind = Event::Kind::kRpm;
      event.number = action.rpm;
      break;
    case Action::Kind::kDwell:
      event.kind = Event::Kind::kDwell;
      event.number = action.dwell_ms;
      break;
    case Action::Kind::kPause:
      return;
  }
  trace_.push_back(event);
}

void Bench::OnCommand(const CommandPlace& command) {
  const bool clears = command.op == Op::kH || command.op == Op::kIN;
  if (clears) log_cleared_at_ = device_->command_errors().entries().size();
}

Observed Bench::Look() const {
  const Registers& registers = device_->registers();
  const auto place = [&](const Point& p) {
    Event event;
    event.x = p.x - profile_.origin_x;
    event.y = p.y - profile_.origin_y;
    event.z = p.z - registers.z0;
    event.a = p.a;
    return event;
  };
  Observed seen;
  seen.trace = trace_;
  seen.err = device_->command_errors().value();
  seen.log = Numbers(device_->command_errors());
  seen.log_cleared_at = log_cleared_at_;
  seen.com = device_->link_errors().value();
  seen.comlog = Numbers(device_->link_errors());
  seen.mode = registers.absolute ? "abs" : "rel";
  seen.tool = registers.tool_down ? "down" : "up";
  seen.vs = registers.xy_speed;
  seen.vz = registers.z_speed;
  seen.z0 = registers.z0;
  seen.z1 = registers.z1;
  seen.z2 = registers.z2;
  seen.dwell_ms = registers.dwell_ms;
  seen.rpm = registers.rpm;
  seen.rotation = registers.rotation;
  seen.spindle_on = device_->spindle_turns();
  seen.paused = device_->paused();
  seen.pending = device_->pending();
  seen.at = place(device_->carriage().physical());
  seen.logical = place(device_->carriage().logical());
  seen.esc_m = ReadRegister(*device_, profile_, {}, "ESC.M")->text;
  seen.esc_t = ReadRegister(*device_, profile_, {}, "ESC.T")->text;
  return seen;
}

Observed RunOnBench(const Example& example, std::size_t chunk) {
  Bench bench(ParametersFor(example), ResumesOutsidePauses(example));
  for (const Stroke& stroke : Unescape(example.input)) {
    std::string_view left = stroke.bytes;
    while (!left.empty()) {
      const std::size_t size = chunk == 0 ? left.size() : std::min(chunk, left.size());
      bench.Feed(left.substr(0, size));
      bench.Feed({});  // empty chunks change nothing
      left.remove_prefix(size);
    }
    if (stroke.resume) bench.PressResume();
  }
  return bench.Look();
}

Observed RunOnBenchSplitAt(const Example& example, std::size_t position) {
  Bench bench(ParametersFor(example), ResumesOutsidePauses(example));
  for (const Stroke& stroke : Unescape(example.input)) {
    const std::string_view bytes = stroke.bytes;
    const std::size_t cut = std::min(position, bytes.size());
    bench.Feed(bytes.substr(0, cut));
    bench.Feed(bytes.substr(cut));
    position -= cut;
    if (stroke.resume) bench.PressResume();
  }
  return bench.Look();
}

Observed RunAsProgram(const Example& example) {
  machine::RunSetup setup(ParametersFor(example));
  std::string bytes;
  int resumes = 0;
  for (const Stroke& stroke : Unescape(example.input)) {
    bytes += stroke.bytes;
    resumes += stroke.resume ? 1 : 0;
  }
  setup.main_program = 7;
  setup.programs[7] = {
      .name = "example", .object = machine::Bytes::Of(bytes), .executable = nullptr};
  TraceObserver observer;
  const auto run = Rml1Family().NewRun(std::move(setup), observer).value();
  while (run->Advance(kForever) == machine::RunPhase::kHalted) {
    const bool panel = observer.last_halt == "OVER_AREA" && ResumesOutsidePauses(example);
    if (!panel && resumes-- == 0) break;
    run->Apply({.at = run->state().time, .kind = machine::InputKind::kStart});
  }
  observer.seen.paused = run->state().phase == machine::RunPhase::kHalted;
  ReadState(*run, observer.seen);
  return observer.seen;
}

}  // namespace rmlcell::rml1::conformance
