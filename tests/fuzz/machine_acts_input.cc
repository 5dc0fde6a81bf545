#include "tests/fuzz/machine_acts_input.h"

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/families/families.h"
#include "engine/machine/machine.h"
#include "engine/machine/parameters.h"
#include "tests/fuzz/told.h"

namespace rmlcell::machine {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kActsMax = 200;
constexpr int kWorkMax = 30;                // calls of Advance for one wait
constexpr std::size_t kRefusesEdit = 0x40;  // bit of the byte that says how a key is pressed

// One act, and the wait behind it.
struct Act {
  MachineInput input{};
  SimTime wait{0};
  bool stores = true;  // a change of a program that a key asks for; else it is refused
};

constexpr std::array kKeys = {"START",
                              "STOP",
                              "HOLD",
                              "SHIFT",
                              "STEP",
                              "HOME",
                              "ZERO",
                              "NOTE",
                              "MODE_LEFT",
                              "MODE_RIGHT",
                              "OVERRIDE_PLUS",
                              "OVERRIDE_MINUS",
                              "JOG_ROB",
                              "JOG_ABS",
                              "DEL",
                              "MOD",
                              "REC",
                              "ERR",
                              "PREV",
                              "NEXT",
                              "ENT",
                              "JOB",
                              "TCP",
                              "DYN",
                              "PATH",
                              "WORK",
                              "DLY",
                              "MOV",
                              "OUT",
                              "DEB",
                              "CAL",
                              "PAR",
                              "DISP",
                              "F1",
                              "F2",
                              "F3",
                              "F4",
                              "F5",
                              "F6",
                              "F7",
                              "F8",
                              "X+",
                              "X-",
                              "Y+",
                              "Y-",
                              "Z+",
                              "Z-",
                              "A+",
                              "A-",
                              "B+",
                              "B-",
                              "C+",
                              "C-",
                              "POINT",
                              "MINUS",
                              "0",
                              "1",
                              "2",
                              "3",
                              "4",
                              "5",
                              "6",
                              "7",
                              "8",
                              "9",
                              "JOG_TCP",
                              "EMERGENCY_STOP"};

constexpr std::array<SimTime, 8> kWaits = {0ms, 1ms, 10ms, 70ms, 200ms, 1s, 5s, 40s};

SimTime WaitOf(unsigned byte) { return kWaits[byte % kWaits.size()]; }
template <class Values>
auto OneOf(const Values& values, unsigned byte) {
  return values[byte % values.size()];
}

PressedKey KeyOf(unsigned which, unsigned how) {
  constexpr std::array kHow = {KeyAction::kTap, KeyAction::kPress, KeyAction::kRelease,
                               KeyAction::kTap};
  return {.key = OneOf(kKeys, which), .action = OneOf(kHow, how >> 3)};
}

constexpr std::array<std::string_view, 5> kOptimoPrograms = {
    "COORD ABSOL\nPATH LIN\nSPEED 10\n10 MOVE (1500.,500.,-400.,0.,0.)\nOL[3] = ON\nDELAY 0.2\n"
    "MOVE (1600.,500.,-400.,0.,0.)/FLY\nMOVE (1600.,600.,-400.,0.,0.)\nOL[3] = OFF\n",
    "10 VI[3] = VI[3] + 1\nIF IL[20] THEN 20\nDELAY 0.5\nIF VI[3] < 40 THEN 10\n20 PAUSE\nCALL 1\n",
    "COORD ABSOL\nWORKDEF 1,0 (8.,75.,.2,50.)\nWORK 1,0/ON\nMOVE (1520.,520.,-420.,0.,0.)\n"
    "WORK 1,0/OFF\nVR[1] = IA[1] * 2\nMOVE (99999.,0.,0.,0.,0.)\n",
    "COORD ROBOT\nMOVE (1000.,1000.,-300.,0.1,0.1)\nDELAY .1\n",
    "ERR 20\nVR[2] = 1. / VR[3]\n10 MOVE (1500.,520.,-400.,0.,0.)\nDELAY 1.\nVI[4] = VI[4] + 1\n"
    "IF VI[4] < 9 THEN 10\n20 DELAY .1\n"};
constexpr std::array<std::string_view, 4> kStreams = {
    "PA;PA;VS10;!VZ5;!PZ-50,100;!MC1;PU1000,1000;PD3000,1000,3000,3000;PU0,0;!MC0;",
    "PU100,100;PD200,200;PU;H;", "PA;Z0,0,0;!DW2000;Z500,500,-20;!ZZ1;PU90000,90000;", "IN;QQ;^,"};

std::vector<std::string_view> ProgramsOf(const MachineFamily& family) {
  if (family.info().id == "optimo") return {kOptimoPrograms.begin(), kOptimoPrograms.end()};
  return {kStreams.begin(), kStreams.end()};
}

MachineMemory MemoryOf(const MachineFamily& family, const Parameters& parameters) {
  MachineMemory memory;
  int slot = 0;
  for (const std::string_view text : ProgramsOf(family)) {
    Translation made =
        family.Translate({.name = "a", .bytes = text}, parameters, {.advice = false});
    RMLCELL_CHECK(made.ok || family.info().id != "optimo");  // a stream may have anything in it
    memory.programs[++slot] = {.name = "a", .object = Bytes::Of(ObjectOf(std::move(made), text))};
  }
  return memory;
}

// What sets it up, moves it by hand, or changes its memory.
MachineInput SettingOf(unsigned kind, unsigned with, const MachineMemory& programs) {
  const int slot = 1 + static_cast<int>(with % 6);
  constexpr std::array kValues = {0.0, 1.0, 0.3, -7.5, 10.0, 99.0, 145.0, 1e30};
  constexpr std::array kNames = {"VR[3]", "VI[3]", "VI[4]", "OL[3]", "IL[20]",
                                 "VL[1]", "X",     "VX[7]", "RPM",   "none"};
  constexpr std::array kPanel = {PanelKey::kView, PanelKey::kSpindle, PanelKey::kZ0,
                                 PanelKey::kOrigin, PanelKey::kHome};
  const JogKey jog{.axis = static_cast<JogAxis>(with % 6), .plus = (with & 8U) != 0};
  switch (kind) {
    case 18:
      return WriteVariable{.name = OneOf(kNames, with), .value = OneOf(kValues, with >> 4)};
    case 19:
      return SetBreakpoints{with % 4 == 0
                                ? std::vector<Breakpoint>()
                                : std::vector<Breakpoint>{
                                      {.at = {.program = slot, .step = static_cast<int>(with >> 5)},
                                       .condition = with % 4 == 1 ? "VI[3] > 2" : "",
                                       .from_pass = 1 + with % 3}}};
    case 20:
      return SetSimulation{with % 3 == 0
                               ? std::optional<ProgramStep>()
                               : ProgramStep{.program = slot, .step = static_cast<int>(with >> 5)}};
    case 21: {
      const auto found = programs.programs.find(1 + static_cast<int>(with >> 4) % 5);
      return StoreProgram{
          .slot = slot,
          .program = found == programs.programs.end() ? StoredProgram{.name = "b"} : found->second};
    }
    case 22:
      return DeleteProgram{.slot = slot};
    case 23:
      return ClearMessage{};
    case 24:
    case 25:
      return PressJog{.key = jog,
                      .reference = static_cast<JogReference>(with >> 4 & 1U),
                      .fast = (with & 64U) != 0};
    case 26:
      return ReleaseJog{jog};
    case 27:
      return ReleaseJogs{};
    case 28:
      return SetGates{{slot, static_cast<int>(with >> 5)}};
    case 29:
      return PressGate{1 + static_cast<int>(with % 3)};
    case 30:
      return PressPanel{OneOf(kPanel, with)};
    default:
      return KeyOf(with, with >> 1);
  }
}

// What an input of this kind and argument is.
MachineInput InputOf(unsigned kind, unsigned with, const MachineMemory& programs) {
  const int slot = 1 + static_cast<int>(with % 6);
  constexpr std::array kModes = {Mode::kRemote, Mode::kCycle, Mode::kSingle, Mode::kRepeat,
                                 Mode::kManual};
  constexpr std::array kSources = {StartSource::kConsole, StartSource::kPanel, StartSource::kQueue};
  constexpr std::array kValues = {0.0, 1.0, 0.3, -7.5, 10.0, 99.0, 145.0, 1e30};
  switch (kind % 32) {
    case 0:
    case 1:
      return StartRun{.program = slot, .source = OneOf(kSources, with >> 3), .unzeroed = with > 99};
    case 2:
      return ZeroAxes{};
    case 3:
    case 4:
      return ResumeRun{.source = OneOf(kSources, with),
                       .accept_displaced = (with & 16U) != 0,
                       .restore_process = (with & 32U) != 0};
    case 5:
      return HoldRun{};
    case 6:
      return StopRun{};
    case 7:
      return AbortRun{};
    case 8:
      return EmergencyStop{.pressed = with % 8 == 0};
    case 9:
      return Acknowledge{.alarm = static_cast<int>(with % 16)};
    case 10:
    case 11:
      return ChangeMode{OneOf(kModes, with)};
    case 12:
      return ChangeOverride{with % 16 == 0 ? OneOf(kValues, with >> 4) : with * 0.6};
    case 13:
      return ChangeInput{.kind = InputKind::kLogical,
                         .index = static_cast<int>(with % 100),
                         .value = static_cast<double>(with >> 7)};
    case 14:
      return ChangeInput{
          .kind = InputKind::kLogical, .index = 20, .value = static_cast<double>(with % 2)};
    case 15:
      return ChangeInput{.kind = InputKind::kAnalogue,
                         .index = static_cast<int>(with % 4),
                         .value = OneOf(kValues, with >> 2)};
    case 16:
      return MoveDoor{.open = with % 2 == 0};
    case 17:
      return SwitchPower{.on = with % 8 != 0};
    default:
      return SettingOf(kind % 32, with, programs);
  }
}

// A run, a jog, HOME, ZERO, a start of a program: what a person or a program asks for.
bool MayBeginMotion(const MachineInput& input) {
  return BeginsRun(input) || std::holds_alternative<ZeroAxes>(input) ||
         std::holds_alternative<ResumeRun>(input) || std::holds_alternative<PressJog>(input) ||
         std::holds_alternative<PressPanel>(input) ||
         (std::holds_alternative<PressedKey>(input) &&
          std::get<PressedKey>(input).action != KeyAction::kRelease);
}

// A machine and whoever does all this to it.
class Player {
 public:
  Player(const MachineFamily& family, const Parameters& parameters, MachineMemory memory,
         std::string_view state)
      : family_(family),
        parameters_(parameters),
        machine_(*Machine::Make(family, parameters, std::move(memory), state, teller_)) {}

  // Time passes in so many pieces. Returns what is wrong.
  std::string Do(const Act& act, int pieces) {
    const MachineState before = machine_->state();
    Take(act);
    if (!MovesAxes(before) && MovesAxes(machine_->state()) && !MayBeginMotion(act.input))
      return "it moves by an act that begins nothing, of index " +
             std::to_string(act.input.index()) + ", in " + std::string(Name(before));
    if (std::string wrong = Look(); !wrong.empty()) return wrong;
    const MachineStatus stood = machine_->status();
    const SimTime from = machine_->time();
    // Dry runs that are repeated go round and round at one instant: how often hangs on the calls.
    if (act.wait == SimTime(0) && stood.run.dry) pieces = 1;
    for (int piece = 1; piece <= pieces; ++piece) {
      tires_ = tires_ || !GoOn(std::max(machine_->time(), from + act.wait * piece / pieces));
      if (tires_) return {};
    }
    if (machine_->time() < from) return "time falls";
    const MachineStatus stands = machine_->status();
    if (!MovesAxes(stood.state) && MovesAxes(stands.state))
      return "it begins to move by itself, in " + std::string(Name(stood.state));
    if (!MovesAxes(stood.state) && !(stood.run.axes == stands.run.axes))
      return "it stands and goes elsewhere, in " + std::string(Name(stood.state));
    return Look();
  }

  std::string SavesWhatItReads() const {
    const std::string saved = machine_->Save();
    RunObserver nobody;
    const auto again = Machine::Make(family_, parameters_, machine_->memory(), saved, nobody);
    if (!again) return "what it saves is refused: " + again.error().detail;
    return (*again)->Save() == saved ? "" : "what it saves is not what it reads";
  }

  // Nothing of it is under way that Save leaves out.
  bool IsAllSaved() const {
    return machine_->open_run() == nullptr && !MovesAxes(machine_->state()) &&
           !machine_->settles() && !machine_->has_open_mask();
  }

  // Keys that are down are of this machine alone, and what was entered at its handbox: that is as
  // it comes when the power is switched off and on.
  void LetGo() {
    static_cast<void>(machine_->Apply(ReleaseJogs{}));
    if (!std::exchange(pressed_, false)) return;
    static_cast<void>(machine_->Apply(SwitchPower{false}));
    static_cast<void>(machine_->Apply(SwitchPower{true}));
  }

  // More is to be computed than is worth waiting for here: a program that lets no time pass, which
  // its budget ends (kLiveBudget).
  bool tires() const { return tires_; }
  const Machine& machine() const { return *machine_; }
  const std::string& answers() const { return answers_; }
  const std::string& shown() const { return shown_; }
  const std::string& told() const { return teller_.told; }
  void ForgetAnswers() { answers_.clear(); }

 private:
  void Take(const Act& act) {
    if (const auto* key = std::get_if<PressedKey>(&act.input)) {
      pressed_ = true;
      const Result<KeyAnswer> answer = machine_->PressKey(key->key, key->action);
      answers_ += key->key + " " +
                  (!answer            ? CodeText(answer.error().code)
                   : !answer->message ? "said nothing"
                                      : CodeText(*answer->message)) +
                  "\n";
      if (answer && answer->edit) Store(*answer->edit, act.stores);
    } else {
      const Status done = machine_->Apply(Resolved(act.input));
      answers_ += std::to_string(act.input.index()) + " " +
                  (done ? "done" : CodeText(done.error().code)) + "\n";
    }
    shown_ = machine_->panel().display;
  }

  // An acknowledgement of alarm 0 is one of the alarm that there is.
  MachineInput Resolved(const MachineInput& input) const {
    const auto* of = std::get_if<Acknowledge>(&input);
    const std::vector<Alarm> alarms = machine_->status().alarms;
    if (of == nullptr || of->alarm > 4 || alarms.empty()) return input;
    return Acknowledge{alarms.front().id};
  }

  void Store(const ProgramEdit& edit, bool stores) {
    Status stored;
    if (!stores) {
      stored = machine_->Apply(RefuseEdit{ErrorCode::kCellStoreUnavailable});
    } else if (edit.object.empty()) {
      stored = machine_->Apply(DeleteProgram{.slot = edit.program});
    } else {
      stored = machine_->Apply(StoreProgram{
          .slot = edit.program, .program = {.name = "a", .object = Bytes::Of(edit.object)}});
    }
    answers_ += "edit of " + std::to_string(edit.program) + " " +
                (stored ? "stored" : CodeText(stored.error().code)) + "\n";
  }

  bool GoOn(SimTime until) {
    for (int i = 0; i < kWorkMax; ++i) {
      if (machine_->Advance(until) == Progress::kReached) return true;
    }
    return false;
  }

  std::string Look() const {
    const MachineStatus now = machine_->status();
    const std::string where = " in " + std::string(Name(now.state));
    const motion::AxisPose& axes = now.run.axes;
    if (!axes.column.allFinite() || !std::isfinite(axes.a_rad) || !std::isfinite(axes.b_rad))
      return "an axis is nowhere" + where;
    if (!(now.run.tip_speed_mm_s >= 0.0) || std::isinf(now.run.tip_speed_mm_s))
      return "a speed that is none" + where;
    if (MovesAxes(now.state)) return {};
    if (now.run.tip_speed_mm_s != 0.0) return "it has a speed" + where;
    if (now.run.beam_on) return "the beam is on" + where;
    if (now.run.spindle_on && now.state != MachineState::kHeld) return "the spindle turns" + where;
    return {};
  }

  const MachineFamily& family_;
  const Parameters& parameters_;
  Teller teller_;
  std::unique_ptr<Machine> machine_;
  std::string answers_;
  std::string shown_;     // on the display, behind the last act
  bool pressed_ = false;  // a key of the handbox
  bool tires_ = false;
};

std::string Play(const MachineFamily& family, const Parameters& parameters,
                 const MachineMemory& memory, const std::vector<Act>& acts, std::size_t again_at,
                 int pieces) {
  Player one(family, parameters, memory, {});
  Player other(family, parameters, memory, {});
  std::unique_ptr<Player> again;
  for (std::size_t i = 0; i < acts.size(); ++i) {
    const std::string at = ", act " + std::to_string(i);
    if (std::string wrong = one.Do(acts[i], 1); !wrong.empty()) return wrong + at;
    if (std::string wrong = other.Do(acts[i], pieces); !wrong.empty()) return wrong + at;
    if (one.tires() || other.tires() || (again != nullptr && again->tires())) return {};
    if (one.answers() != other.answers())
      return "another answer when time is divided" + at + Apart(other.answers(), one.answers());
    if (one.shown() != other.shown()) return "another display when time is divided" + at;
    if (one.told() != other.told())
      return "another telling when time is divided" + at + Apart(other.told(), one.told());
    const std::string saved = one.machine().Save();
    if (saved != other.machine().Save())
      return "another state when time is divided" + at + Apart(other.machine().Save(), saved);
    if (again != nullptr) {
      if (std::string wrong = again->Do(acts[i], 1); !wrong.empty()) return wrong + at + " again";
      if (one.answers() != again->answers())
        return "another answer of one made again" + at + Apart(again->answers(), one.answers());
    }
    one.ForgetAnswers(), other.ForgetAnswers();
    if (again != nullptr) again->ForgetAnswers();
    if (i % 8 == 0) {
      if (std::string wrong = one.SavesWhatItReads(); !wrong.empty()) return wrong + at;
    }
    if (i < again_at || again != nullptr || !one.IsAllSaved()) continue;
    one.LetGo(), other.LetGo();
    if (one.IsAllSaved())
      again = std::make_unique<Player>(family, parameters, one.machine().memory(),
                                       one.machine().Save());
  }
  const std::string saved = one.machine().Save();
  if (again != nullptr && again->machine().Save() != saved)
    return "one made again ends in another state" + Apart(again->machine().Save(), saved);
  return one.SavesWhatItReads();
}

unsigned ByteOf(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}

struct Begins {
  unsigned with = 0;
  std::size_t again_at = 0;
  int pieces = 2;
};
constexpr std::size_t kHead = 3;
Begins HeadOf(std::string_view bytes) {
  return {.with = ByteOf(bytes, 0),
          .again_at = ByteOf(bytes, 1),
          .pieces = 2 + static_cast<int>(ByteOf(bytes, 2) % 6)};
}

// As somebody has it before him: zeroed or not, in MANUAL or not.
void Prepare(unsigned with, std::vector<Act>& acts) {
  if ((with & 2U) != 0) acts.push_back({.input = ZeroAxes{}, .wait = 60s});
  if ((with & 4U) != 0) acts.push_back({.input = ChangeMode{Mode::kManual}});
}

struct Bed {
  const MachineFamily& family;
  Parameters parameters;
  MachineMemory memory;
};
Bed MakeBed(std::string_view id) {
  const MachineFamily& family = *families::FindFamily(id);
  const Parameters parameters =
      *MakeParameters(family, std::string(family.info().default_profile), {});
  return {.family = family, .parameters = parameters, .memory = MemoryOf(family, parameters)};
}
const Bed& BedOf(bool mill) {
  static const Bed kMill = MakeBed("rml1");
  static const Bed kOptimo = MakeBed("optimo");
  return mill ? kMill : kOptimo;
}

}  // namespace

std::string TryKeys(std::string_view bytes) {
  if (bytes.size() < kHead) return {};
  const Begins begins = HeadOf(bytes);
  const Bed& bed = BedOf(false);
  std::vector<Act> acts;
  Prepare(begins.with, acts);
  for (std::size_t at = kHead; at + 2 <= bytes.size() && acts.size() < kActsMax; at += 2) {
    const unsigned how = ByteOf(bytes, at + 1);
    acts.push_back({.input = KeyOf(ByteOf(bytes, at), how),
                    .wait = WaitOf(how),
                    .stores = (how & kRefusesEdit) == 0});
  }
  return Play(bed.family, bed.parameters, bed.memory, acts, begins.again_at, begins.pieces);
}

std::string TryInputs(std::string_view bytes) {
  if (bytes.size() < kHead) return {};
  const Begins begins = HeadOf(bytes);
  const Bed& bed = BedOf((begins.with & 1U) != 0);
  std::vector<Act> acts;
  Prepare(begins.with, acts);
  for (std::size_t at = kHead; at + 3 <= bytes.size() && acts.size() < kActsMax; at += 3) {
    const unsigned wait = ByteOf(bytes, at + 2);
    acts.push_back({.input = InputOf(ByteOf(bytes, at), ByteOf(bytes, at + 1), bed.memory),
                    .wait = WaitOf(wait),
                    .stores = (wait & kRefusesEdit) == 0});
  }
  return Play(bed.family, bed.parameters, bed.memory, acts, begins.again_at, begins.pieces);
}

}  // namespace rmlcell::machine
