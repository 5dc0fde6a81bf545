#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "engine/machine/machine_states.h"
#include "engine/optimo/handbox/modal_text.h"
#include "engine/optimo/handbox/optimo_handbox.h"
#include "engine/optimo/language/operands.h"

// Programs and steps: which one is shown, what is put in before it and taken out.
namespace rmlcell::optimo {
namespace {

using machine::ProgramEdit;
using machine::ShownStep;

// Of points that are recorded: finer than the axes, and rounding errors of the head are no digits.
constexpr double kLengthSteps = 1e4;  // a mm
constexpr double kAngleSteps = 1e6;   // a rad

bool SysdefIsActive(const machine::MachineView& view) {
  const std::string value = ModalText(view, "SYSDEF");
  return !value.empty() && value != "OFF";
}

std::size_t BytesOf(const machine::StoredProgram& program) {
  return (program.object != nullptr ? program.object->size() : 0) +
         (program.executable != nullptr ? program.executable->size() : 0);
}

// OPT-B.73
bool HasRoom(const machine::MachineView& view, const ProgramEdit& edit, double cmos_size) {
  std::size_t bytes = edit.object.size();
  for (const auto& [slot, program] : view.programs) {
    if (slot != edit.program) bytes += BytesOf(program);
  }
  return static_cast<double>(bytes) <= cmos_size;
}

// OPT-5.16
std::vector<double> PointAt(const machine::MachineView& view, CoordType coord) {
  const machine::RunState& run = view.status.run;
  const bool tip = coord == CoordType::kAbsol;
  const motion::MachinePoint& place = tip ? run.tip.tip : run.axes.column;
  const auto rounded = [](double value, double steps) { return std::round(value * steps) / steps; };
  return {rounded(place.x(), kLengthSteps), rounded(place.y(), kLengthSteps),
          rounded(place.z(), kLengthSteps), rounded(run.axes.a_rad, kAngleSteps),
          rounded(run.axes.b_rad, kAngleSteps)};
}

}  // namespace

// OPT-4.57
void OptimoHandbox::OpenJob(Turn& turn) {
  Drop();
  form_.emplace(
      FormKind::kJob,
      std::vector<Form::Line>{{Field::Whole("P=", 2, turn.program(), 1, kSlotMax),
                               Field::Whole(" S=", 4, 0, 0, 9999), Field::Whole(" T=", 1, 0, 0, 9),
                               Field::Whole(" M=", 1, 0, 0, 9)}});
}

// Nothing: the answer says why.
std::optional<Steps> OptimoHandbox::StepsOf(Turn& turn, int program) {
  if (program == 0) {
    Refuse(turn, ErrorCode::kNoProgramSelected);
    return std::nullopt;
  }
  Result<std::optional<Steps>> steps = Steps::Of(turn.view.programs, program);
  if (!steps) {
    Refuse(turn, steps.error().code);
    return std::nullopt;
  }
  if (!*steps) Refuse(turn, ErrorCode::kProgramMissing);
  return *std::move(steps);
}

// One that does not exist can be selected, too. OPT-4.59
void OptimoHandbox::Select(Turn& turn, int program, int step) {
  first_point_.reset();
  next_move_ = {};
  turn.answer.shown = ShownStep{.program = program};
  turn.answer.selects_program = true;
  if (step == 0 || !turn.view.programs.contains(program)) return;
  if (const std::optional<Steps> steps = StepsOf(turn, program))
    turn.answer.shown = steps->Show(program, step);
}

// Who stood at its end stands there still.
ShownStep OptimoHandbox::ShowAgain(const machine::MachineView& view) const {
  const ShownStep& shown = view.status.shown;
  const auto steps = Steps::Of(view.programs, shown.program);
  if (!steps || !*steps || shown.step == 0) return {.program = shown.program};
  const bool at_end = shown.instruction == "ENDTASK" || shown.instruction == "ENDPRG";
  const int at = at_end ? (*steps)->end() : shown.step;
  return (*steps)->Show(shown.program, at);
}

// OPT-4.32
void OptimoHandbox::SelectNeighbour(Turn& turn, bool next) {
  shift_ = false;
  const auto& programs = turn.view.programs;
  const auto above = programs.upper_bound(turn.program());
  const auto at = programs.lower_bound(turn.program());
  Drop();
  if (next && above != programs.end()) return Select(turn, above->first, 0);
  if (next) return;
  if (turn.program() == 0 && !programs.empty()) return Select(turn, programs.rbegin()->first, 0);
  if (at != programs.begin()) Select(turn, std::prev(at)->first, 0);
}

// OPT-4.30, OPT-4.31, OPT-6.37
void OptimoHandbox::ShowNeighbour(Turn& turn, bool next) {
  const std::optional<Steps> steps = StepsOf(turn, turn.program());
  if (!steps) return;
  const int to = next ? turn.step() + 1 : std::max(turn.step() - 1, std::min(turn.step(), 1));
  turn.answer.shown = steps->Show(turn.program(), to);
}

void OptimoHandbox::ShowEnd(Turn& turn) {
  if (const std::optional<Steps> steps = StepsOf(turn, turn.program()))
    turn.answer.shown = steps->Show(turn.program(), steps->end());
}

// DEL at a step, SHIFT DEL of a program: both ask first. OPT-4.63, OPT-6.38
void OptimoHandbox::Delete(Turn& turn) {
  const bool whole = std::exchange(shift_, false);
  if (whole) Drop();
  const std::optional<Steps> steps = StepsOf(turn, turn.program());
  if (!steps) return;
  if (whole && turn.view.loaded.contains(turn.program()))
    return Refuse(turn, ErrorCode::kProgramInUse);
  if (!whole && !steps->Has(turn.step())) return Refuse(turn);
  question_ = whole ? Question::kDeleteProgram : Question::kDeleteStep;
}

// 1 is YES, 0 is NO. OPT-4.41
void OptimoHandbox::Answer(Turn& turn) {
  const char c = turn.key.character;
  if (c != '0' && c != '1') return Refuse(turn);
  const Question asked = *std::exchange(question_, std::nullopt);
  if (asked == Question::kExecution) return AnswerExecution(turn, c == '1');
  if (c == '0') return;
  if (asked == Question::kZero) return turn.Ask(machine::ZeroAxes{});
  const std::optional<Steps> steps = StepsOf(turn, turn.program());
  if (!steps) return;
  if (asked == Question::kDeleteProgram)
    return AskForEdit(turn, RemoveProgram(*steps, turn.program()), {.program = turn.program()});
  AskForEdit(turn, DeleteStep(*steps, turn.program(), turn.step()), turn.view.status.shown);
}

// OPT-4.28, OPT-4.60
void OptimoHandbox::Record(Turn& turn) {
  if (form_ || question_) return Refuse(turn);
  if (turn.program() == 0) return Refuse(turn, ErrorCode::kNoProgramSelected);
  if (!ready_) {
    if (turn.view.programs.contains(turn.program())) return ShowEnd(turn);
    return AskForEdit(turn, CreateProgram(turn.program()),
                      {.program = turn.program(), .step = 1, .instruction = "ENDTASK"});
  }
  if (ready_->as == Ready::As::kPoint || ready_->as == Ready::As::kCentre) return RecordPoint(turn);
  RecordStatement(turn, ready_->statement);
}

// OPT-5.15 to 5.22, OPT-6.41: circle and hole have two points, and the second one makes the step.
void OptimoHandbox::RecordPoint(Turn& turn) {
  if (!turn.view.status.run.zeroed) return Refuse(turn, ErrorCode::kNotZeroed);
  if (machine::MovesAxes(turn.view.status.state)) return Refuse(turn);
  const bool two = modes_.path == PathType::kCir || modes_.path == PathType::kHole;
  if (two && !first_point_) {
    if (!StepsOf(turn, turn.program())) return;
    first_point_ = PointAt(turn.view, modes_.coord);
    ready_.reset();
    return;
  }
  RecordStatement(turn, MoveText(turn.view));
  if (edit_ && SysdefIsActive(turn.view)) Refuse(turn, ErrorCode::kSysdefWhileTeaching);
}

std::string OptimoHandbox::MoveText(const machine::MachineView& view) const {
  // First the via point and then the end of a circle; first the centre of a hole. OPT-5.18,
  // OPT-5.19
  std::vector<double> target = PointAt(view, modes_.coord);
  std::vector<double> via = first_point_.value_or(std::vector<double>());
  if (first_point_ && modes_.path == PathType::kHole) std::swap(target, via);
  std::string text = WithList("MOVE", target);
  if (!via.empty()) text += WithList(" /VIA", via);
  if (modes_.fly) text += " /FLY";
  if (next_move_.start) text += " /START (IL[" + std::to_string(*next_move_.start) + "])";
  if (next_move_.end) text += " /END (IL[" + std::to_string(*next_move_.end) + "])";
  if (next_move_.time_s) {
    text += WithReal(" /TIME (", *next_move_.time_s);
    text += ", " + std::to_string(next_move_.time_label) + ")";
  }
  if (next_move_.next) text += " /NEXT";
  return text;
}

// Before the step that is shown, which is shown again behind it; with none shown, at the end.
// OPT-6.39, OPT-6.40
void OptimoHandbox::RecordStatement(Turn& turn, std::string_view statement) {
  const std::optional<Steps> steps = StepsOf(turn, turn.program());
  if (!steps) return;
  const int step = turn.step() > 0 ? turn.step() : steps->end();
  const auto limit = static_cast<std::size_t>(parameters_.Number("OBJECT_LIMIT"));
  ShownStep behind = steps->Show(turn.program(), step);
  behind.step += 1;
  AskForEdit(turn, InsertStep(*steps, turn.program(), behind.step - 1, statement, limit), behind);
}

void OptimoHandbox::AskForEdit(Turn& turn, Result<ProgramEdit> edit, ShownStep behind) {
  if (!edit) return Refuse(turn, edit.error().code);
  const bool grows =
      edit->kind == ProgramEdit::Kind::kCreate || edit->kind == ProgramEdit::Kind::kInsert;
  if (grows && !HasRoom(turn.view, *edit, parameters_.Number("CMOS_SIZE")))
    return Refuse(turn, ErrorCode::kCmosFull);
  edit->note = NoteOf(turn.view);
  // Later steps move up.
  if (edit->kind == ProgramEdit::Kind::kDelete) {
    std::map<int, machine::StoredProgram> made;
    made[edit->program].object = machine::Bytes::Borrowed(edit->object);
    const Result<std::optional<Steps>> steps = Steps::Of(made, edit->program);
    if (steps && *steps) behind = (*steps)->Show(edit->program, edit->step);
  }
  shown_behind_ = std::move(behind);
  const bool hole = ready_ && ready_->name == "PATH" && modes_.path == PathType::kHole;
  ready_behind_.reset();
  if (hole) ready_behind_ = Ready{.as = Ready::As::kCentre, .name = "ENTER CENTER NORMAL"};
  edit_ = *edit;
  turn.answer.edit = *std::move(edit);
}

std::optional<ShownStep> OptimoHandbox::EditStored() {
  if (ready_ && (ready_->as == Ready::As::kPoint || ready_->as == Ready::As::kCentre)) {
    first_point_.reset();
    next_move_ = {};
  }
  edit_.reset();
  ready_ = std::exchange(ready_behind_, std::nullopt);
  return shown_behind_;
}

void OptimoHandbox::EditRefused(ErrorCode code) {
  edit_.reset();
  ready_behind_.reset();
  told_ = code;
}

machine::TeachNote OptimoHandbox::NoteOf(const machine::MachineView& view) const {
  const auto word = [](auto words, auto choice) {
    return std::string(Describe(words[static_cast<std::size_t>(choice)]).text);
  };
  std::string modes = "PATH " + word(operands::kPathWords, modes_.path);
  if (modes_.path == PathType::kHole) modes = WithList(std::move(modes), {modes_.radius_mm});
  modes += modes_.fly ? " FLY 1" : " FLY 0";
  return {.coord = word(operands::kCoordWords, modes_.coord),
          .tcp = ModalText(view, "TCP"),
          .sysdef_active = SysdefIsActive(view),
          .modes = std::move(modes),
          .axes = view.status.run.axes,
          .tip = view.status.run.tip};
}

}  // namespace rmlcell::optimo
