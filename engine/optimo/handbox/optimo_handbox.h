#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/handbox.h"
#include "engine/machine/parameters.h"
#include "engine/optimo/handbox/form.h"
#include "engine/optimo/handbox/keys.h"
#include "engine/optimo/handbox/steps.h"
#include "engine/optimo/language/ast.h"

namespace rmlcell::optimo {

// What the handbox keeps for recording; programs have their own. OPT-5.11, OPT-5.25
struct HandboxModes {
  bool beeps = false;
  machine::JogReference reference = machine::JogReference::kRobot;
  CoordType coord = CoordType::kRobot;
  PathType path = PathType::kPtp;
  double radius_mm = 0.0;  // the last one
  bool fly = false;
  double speed_percent = 70.0;
  double oversh_percent = 100.0;

  bool operator==(const HandboxModes&) const = default;
};

// The handbox of an Optimo. optimo.md chapters 4 to 6, LIVE-7
// It has at most one of: a form that is filled in, a question, an instruction whose name flashes,
// an edit that is to be stored.
class OptimoHandbox final : public machine::Handbox {
 public:
  OptimoHandbox(const machine::Parameters& parameters, HandboxModes modes)
      : parameters_(parameters), modes_(modes) {}
  // Of Save. Errors: CellBadText.
  static Result<HandboxModes> ReadModes(std::string_view saved);

  Result<machine::HandboxAnswer> Press(std::string_view key, machine::KeyAction action,
                                       const machine::MachineView& view) override;
  std::optional<ErrorCode> Done(const Status& done) override;

  bool has_open_mask() const override { return form_ || question_ || ready_; }
  const machine::ProgramEdit* open_edit() const override { return edit_ ? &*edit_ : nullptr; }
  std::optional<machine::ShownStep> EditStored() override;
  void EditRefused(ErrorCode code) override;

  machine::ShownStep ShowAgain(const machine::MachineView& view) const override;
  void FunctionFailed() override;

  machine::Panel panel(const machine::MachineView& view) const override;
  machine::JogReference jog_reference() const override { return modes_.reference; }
  double OverrideOf(machine::HandRun run, double override_percent) const override;
  void CyclePower() override;
  std::string Save() const override;

 private:
  // What happens for one key.
  struct Turn {
    const machine::MachineView& view;
    KnownKey key;
    machine::HandboxAnswer answer{};

    int program() const { return view.status.shown.program; }
    int step() const { return view.status.shown.step; }
    void Ask(machine::MachineInput input) { answer.requests.push_back(std::move(input)); }
  };
  enum class Question { kZero, kDeleteStep, kDeleteProgram, kExecution };

  // An instruction that is ready to record: its name flashes.
  struct Ready {
    enum class As {
      kStatement,
      kPoint,   // MOVE, here
      kCentre,  // the first point of a hole
      kOutput,  // shown as LET
      kLink,    // GO, CALL and a FUNCTION that was carried out: with the place where they come
    };
    As as = As::kStatement;
    std::string name{};
    std::string statement{};
  };
  // Into the next MOVE only. OPT-5.26
  struct NextMove {
    std::optional<int> start{};
    std::optional<int> end{};
    std::optional<double> time_s{};
    int time_label = 0;
    bool next = false;
  };

  void Refuse(Turn& turn, ErrorCode code = ErrorCode::kKeyNotEnabled) const {
    turn.answer.message = code;
  }
  void Drop();  // what is half entered

  // optimo_handbox.cc: modes, runs, axes
  void Release(Turn& turn);
  bool ActsAlways(Turn& turn);
  bool ActsOutsideRemote(Turn& turn);
  void InManual(Turn& turn);
  void ChangeMode(Turn& turn, int by);
  void ChangeOverride(Turn& turn, bool up);
  void ClearError(Turn& turn);
  void Start(Turn& turn);
  void ChooseReference(Turn& turn);
  void GoHome(Turn& turn);
  void Jog(Turn& turn);

  // selection.cc: programs, steps, and what changes them
  void OpenJob(Turn& turn);
  void Select(Turn& turn, int program, int step);
  void SelectNeighbour(Turn& turn, bool next);
  void ShowNeighbour(Turn& turn, bool next);
  void Delete(Turn& turn);
  void Answer(Turn& turn);
  void Record(Turn& turn);
  void RecordPoint(Turn& turn);
  void RecordStatement(Turn& turn, std::string_view statement);
  void ShowEnd(Turn& turn);
  std::optional<Steps> StepsOf(Turn& turn, int program);
  void AskForEdit(Turn& turn, Result<machine::ProgramEdit> edit, machine::ShownStep behind);
  machine::TeachNote NoteOf(const machine::MachineView& view) const;
  std::string MoveText(const machine::MachineView& view) const;

  // forms.cc: the forms that keys open
  bool OpensForm(Turn& turn);
  void OpenMove();
  void OpenTool(Turn& turn);
  void OpenParameters();

  // entry.cc: what ENT makes of them
  void InForm(Turn& turn);
  void Enter(Turn& turn);
  void EnterMove(Turn& turn);
  void EnterPath(Turn& turn);
  void EnterTool(Turn& turn);
  void EnterWork(Turn& turn);
  void EnterWorkdef(Turn& turn);
  void EnterOutput(Turn& turn);
  void EnterBreak(Turn& turn);
  void EnterSimul(Turn& turn);
  void EnterFunction(Turn& turn);
  void AnswerExecution(Turn& turn, bool yes);
  void EnterSysdef(Turn& turn);
  void AskNext(Turn& turn);
  // OPT-5.02; with no program selected only what it set stays. False: the control does not take it.
  bool MakeReady(Turn& turn, std::string name, std::string statement,
                 Ready::As as = Ready::As::kStatement);

  const machine::Parameters parameters_;
  HandboxModes modes_;
  bool shift_ = false;
  std::optional<ErrorCode> told_{};  // by the last key
  std::optional<Form> form_{};
  std::optional<Question> question_{};
  std::optional<Ready> ready_{};
  std::optional<Ready> ready_when_done_{};  // if the machine does what the key asks for
  std::optional<Ready> ready_behind_{};     // the edit
  std::optional<machine::ProgramEdit> edit_{};
  machine::ShownStep shown_behind_{};
  std::optional<std::vector<double>> first_point_{};  // of a circle or a hole
  NextMove next_move_{};
  std::vector<FormKind> asks_{};  // still, of a MOVE
  // What was entered in the forms before: kind and number of a process, number of a FUNCTION.
  int tool_ = 0;
  int process_ = 0;
  int function_ = 0;
  std::string function_text_{};  // with its parameters
  bool call_ = false;
};

}  // namespace rmlcell::optimo
