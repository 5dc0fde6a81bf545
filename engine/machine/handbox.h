#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/machine_input.h"
#include "engine/machine/machine_status.h"
#include "engine/machine/panel.h"
#include "engine/machine/run.h"
#include "engine/machine/run_setup.h"
#include "engine/motion/geometry/pose.h"

namespace rmlcell::machine {

// What is known besides of a change of a program at the machine. LIVE-7.09
struct TeachNote {
  std::string coord{};         // "ABSOL": what recorded points are
  std::string tcp{};           // in force: "(0.0, 0.0, 3.0, 0.0, 0.0, -5.0)"
  bool sysdef_active = false;  // recorded points know nothing of it
  std::string modes{};         // of the handbox: "PATH CIR FLY 1"
  motion::AxisPose axes{};
  motion::TipPose tip{};

  bool operator==(const TeachNote&) const = default;
};

// One change of a program at the machine. What it says is enough to take it back
// (MachineFamily::UndoEdit).
struct ProgramEdit {
  enum class Kind : std::uint8_t {
    kCreate,  // of a program
    kInsert,  // of a step, before what was at this step
    kDelete,  // of a step
    kRemove,  // of a program
  };
  Kind kind = Kind::kInsert;
  int program = 0;
  int step = 0;   // 0: of a program
  int place = 0;  // of the step among all instructions, those that count as no step included
  std::string text_before{};  // of the step, with its sequence numbers; of a program that goes
  std::string text_after{};   // likewise; of one that comes
  std::string object{};       // of the program behind it; empty: it has none any more
  TeachNote note{};

  bool operator==(const ProgramEdit&) const = default;
};

// What a handbox sees of its machine.
struct MachineView {
  MachineStatus status;
  const std::map<int, StoredProgram>& programs;  // by slot
  std::vector<ModalValue> modal_values;
  std::set<int> loaded;   // programs of the open run that are on their way
  bool compiles = false;  // the run that has just begun made an executable
};

// A modal value that the machine keeps while no run is open, given by hand: "TCP" with six values,
// "SYSDEF" with none.
struct ModalSetting {
  std::string name{};
  std::vector<double> values{};
};

// A run in MANUAL, of a program that is nowhere stored. It needs what a run needs.
struct RunByHand {
  HandRun what = HandRun::kHome;
  std::string text{};
};

// What a key asks of the machine, in this order.
struct HandboxAnswer {
  std::vector<MachineInput> requests{};  // none behind one that is refused
  std::optional<RunByHand> run{};
  std::optional<ModalSetting> setting{};
  std::optional<ShownStep> shown{};  // the step that is selected now
  bool selects_program = false;      // and with it a program, be it the same one again
  // The control cannot do what was asked. A code of the control, or of the cell.
  std::optional<ErrorCode> message{};
  int beeps = 0;
  std::optional<ProgramEdit> edit{};
};

// The keys and the display that a machine has on it. Pure: the same keys on machines that are alike
// give the same. LIVE-7.01
class Handbox {
 public:
  virtual ~Handbox() = default;

  // Errors: CellInvalidArgument, there is no such key; CellNotLive, there is no power.
  virtual Result<HandboxAnswer> Press(std::string_view key, KeyAction action,
                                      const MachineView& view) = 0;
  // What became of the requests of the answer; what the key said for it.
  virtual std::optional<ErrorCode> Done(const Status& done) = 0;

  // The edit that was asked for last and is not stored yet. Until then no other one is made.
  virtual const ProgramEdit* open_edit() const = 0;
  // It is stored (LIVE-7.08); the step that is shown then.
  virtual std::optional<ShownStep> EditStored() = 0;
  // It is not, and was asked for in vain.
  virtual void EditRefused(ErrorCode code) = 0;

  // The program that is selected was changed elsewhere: the step that is shown now.
  virtual ShownStep ShowAgain(const MachineView& view) const = 0;

  // What was carried out from it ended with an error, which is shown.
  virtual void FunctionFailed() = 0;

  // Something is half entered: a mask, or a question.
  virtual bool has_open_mask() const = 0;
  virtual Panel panel(const MachineView& view) const = 0;
  virtual JogReference jog_reference() const = 0;  // of the jog keys
  // Of such a run, where the override of the machine is this.
  virtual double OverrideOf(HandRun run, double override_percent) const = 0;
  virtual void CyclePower() = 0;  // it is as it comes

  // Without what is half entered; empty: it is as it comes. One line.
  virtual std::string Save() const = 0;
};

}  // namespace rmlcell::machine
