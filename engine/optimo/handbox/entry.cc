#include <array>
#include <string>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/optimo/handbox/modal_text.h"
#include "engine/optimo/handbox/optimo_handbox.h"
#include "engine/optimo/language/compiler.h"

// What ENT makes of what was filled in: it acts on the control, and is ready to record.
// OPT-4.33, OPT-5.02, OPT-5.03
namespace rmlcell::optimo {
namespace {

using Lines = std::vector<Form::Line>;

// As the compiler takes it in any program.
bool IsInstruction(const std::string& statement) {
  return Compile(statement + "\n", {}, {.object_limit = 0, .advice = false}).ok;
}

Form InputForm(FormKind kind, int input) {
  return Form::OfLines(kind, {Field::Whole("INPUT = ", 2, input, 0, kVariableIndexMax)});
}

std::vector<double> ValuesOf(const Form& form, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(form.at(i).value());
  return values;
}

constexpr std::array<std::string_view, 6> kFrameNames = {"X", "Y", "Z", "RZ", "RY", "RX"};
constexpr std::array<std::string_view, kParameterCount> kParameterNames = {
    "PAR0", "PAR1", "PAR2", "PAR3", "PAR4", "PAR5", "PAR6", "PAR7"};

}  // namespace

// Precondition: form_.
void OptimoHandbox::InForm(Turn& turn) {
  switch (turn.key.key) {
    case Key::kCharacter:
      return form_->Type(turn.key.character);
    case Key::kPrev:
      return form_->Move(false);
    case Key::kNext:
      return form_->Move(true);
    case Key::kDel:
      return form_->Clear();
    case Key::kEnt:
      // OPT-5.10: it stays.
      if (!form_->Check()) return Refuse(turn, ErrorCode::kFieldRange);
      return Enter(turn);
    default:
      return Refuse(turn);
  }
}

bool OptimoHandbox::MakeReady(Turn& turn, std::string name, std::string statement, Ready::As as) {
  if (!IsInstruction(statement)) {
    Refuse(turn, ErrorCode::kFieldRange);
    return false;
  }
  form_.reset();
  if (turn.program() > 0)
    ready_when_done_ = Ready{.as = as, .name = std::move(name), .statement = std::move(statement)};
  return true;
}

void OptimoHandbox::Enter(Turn& turn) {
  const Form form = *form_;
  switch (form.kind()) {
    case FormKind::kJob:
      form_.reset();
      return Select(turn, form.at(0).whole(), form.at(1).whole());
    case FormKind::kMove:
    case FormKind::kInput:
    case FormKind::kEndInput:
    case FormKind::kTime:
    case FormKind::kTimeLabel:
      return EnterMove(turn);
    case FormKind::kOversh:
      modes_.oversh_percent = form.at(0).value();
      MakeReady(turn, "OVERSH", "OVERSH " + ShortestText(modes_.oversh_percent));
      return;
    case FormKind::kDelay:
      MakeReady(turn, "DELAY", WithReal("DELAY", form.at(0).value()));
      return;
    case FormKind::kCoord:
      modes_.coord = static_cast<CoordType>(form.at(0).chosen());
      first_point_.reset();
      MakeReady(turn, "COORD", form.text());
      return;
    case FormKind::kPath:
    case FormKind::kRadius:
      return EnterPath(turn);
    case FormKind::kTool:
      return EnterTool(turn);
    case FormKind::kProcess:
    case FormKind::kWork:
    case FormKind::kWorkOn:
    case FormKind::kWorkInput:
      return EnterWork(turn);
    case FormKind::kWorkdef:
      return EnterWorkdef(turn);
    case FormKind::kOutput:
      return EnterOutput(turn);
    case FormKind::kLink:
      call_ = form.at(0).chosen() == 1;
      form_ = Form::OfLines(FormKind::kLinkProgram, {Field::Whole("PROG ", 2, 0, 1, kSlotMax)});
      return;
    case FormKind::kLinkProgram: {
      const std::string name = call_ ? "CALL" : "GO";
      MakeReady(turn, name, name + " " + std::to_string(form.at(0).whole()), Ready::As::kLink);
      return;
    }
    case FormKind::kBreak:
    case FormKind::kBreakStep:
      return EnterBreak(turn);
    case FormKind::kSimul:
      return EnterSimul(turn);
    case FormKind::kFunction:
    case FormKind::kFunctionCount:
    case FormKind::kFunctionValues:
      return EnterFunction(turn);
    case FormKind::kSysdef:
    case FormKind::kSysdefValues:
      return EnterSysdef(turn);
    case FormKind::kGosub:
      MakeReady(turn, "GOSUB", "GOSUB " + std::to_string(form.at(0).whole()));
      return;
    case FormKind::kParameters:
      form_.reset();
      return;
  }
}

// OPT-5.24, OPT-5.26, OPT-5.50
void OptimoHandbox::EnterMove(Turn& turn) {
  const Form form = *form_;
  switch (form.kind()) {
    case FormKind::kMove:
      modes_.speed_percent = form.at(0).value();
      modes_.fly = form.at(1).whole() == 1;
      next_move_.next = form.at(5).whole() == 1;
      asks_.clear();
      if (form.at(2).whole() == 1) asks_.push_back(FormKind::kInput);
      if (form.at(3).whole() == 1) {
        asks_.push_back(FormKind::kTime);
        asks_.push_back(FormKind::kTimeLabel);
      }
      if (form.at(4).whole() == 1) asks_.push_back(FormKind::kEndInput);
      if (form.at(2).whole() == 0) next_move_.start.reset();
      if (form.at(3).whole() == 0) next_move_.time_s.reset();
      if (form.at(4).whole() == 0) next_move_.end.reset();
      break;
    case FormKind::kInput:
      next_move_.start = form.at(0).whole();
      break;
    case FormKind::kEndInput:
      next_move_.end = form.at(0).whole();
      break;
    case FormKind::kTime:
      next_move_.time_s = form.at(0).value();
      break;
    default:
      next_move_.time_label = form.at(0).whole();
      break;
  }
  AskNext(turn);
}

void OptimoHandbox::AskNext(Turn& turn) {
  if (asks_.empty()) {
    MakeReady(turn, "SPEED", WithReal("SPEED", modes_.speed_percent));
    return;
  }
  const FormKind kind = asks_.front();
  asks_.erase(asks_.begin());
  if (kind == FormKind::kInput) {
    form_ = InputForm(kind, next_move_.start.value_or(0));
  } else if (kind == FormKind::kEndInput) {
    form_ = InputForm(kind, next_move_.end.value_or(0));
  } else if (kind == FormKind::kTime) {
    form_ = Form::OfLines(kind,
                          {Field::Real("TIME ", next_move_.time_s.value_or(0.0), 0.0, 999'999.0)});
  } else {
    form_ = Form::OfLines(kind, {Field::Whole("GOSUB ", 4, next_move_.time_label, 0, 9999)});
  }
}

// OPT-5.13, OPT-5.14
void OptimoHandbox::EnterPath(Turn& turn) {
  if (form_->kind() == FormKind::kRadius) {
    modes_.path = PathType::kHole;
    modes_.radius_mm = form_->at(0).value();
    first_point_.reset();
    MakeReady(turn, "PATH", WithList("PATH HOLE", {modes_.radius_mm}));
    return;
  }
  const auto path = static_cast<PathType>(form_->at(0).chosen());
  if (path == PathType::kHole) {
    form_ = Form::OfLines(FormKind::kRadius, {Field::Real("RAD = ", modes_.radius_mm, 0.0, 99'999.0,
                                                          Decimals::kUpToThree)});
    return;
  }
  modes_.path = path;
  first_point_.reset();
  MakeReady(turn, "PATH", form_->text());
}

// It moves the tip, and a run that stands has its own. OPT-4.73
void OptimoHandbox::EnterTool(Turn& turn) {
  if (turn.view.status.open) return Refuse(turn);
  const std::vector<double> values = ValuesOf(*form_, 6);
  if (MakeReady(turn, "TCP", WithList("TCP", values)))
    turn.answer.setting = {.name = "TCP", .values = values};
}

// OPT-5.29, OPT-5.30, OPT-5.33 to 5.35
void OptimoHandbox::EnterWork(Turn& turn) {
  const Form form = *form_;
  const std::string of = std::to_string(tool_) + "," + std::to_string(process_);
  switch (form.kind()) {
    case FormKind::kProcess:
      tool_ = form.at(0).whole();
      process_ = form.at(1).whole();
      form_ = Form::OfLines(FormKind::kWork, {Field::Choice("WORK = ", {"DEF", "ON", "OFF"}, 0)});
      return;
    case FormKind::kWorkOn:
      if (form.at(0).whole() == 1) {
        form_ = InputForm(FormKind::kWorkInput, 0);
        return;
      }
      MakeReady(turn, "WORKON", "WORK " + of + "/ON");
      return;
    case FormKind::kWorkInput:
      MakeReady(turn, "WORKON",
                "WORK " + of + "/ON/START (IL[" + std::to_string(form.at(0).whole()) + "])");
      return;
    default:
      break;
  }
  if (form.at(0).chosen() == 2) {
    MakeReady(turn, "WORKOFF", "WORK " + of + "/OFF");
  } else if (form.at(0).chosen() == 1) {
    form_ = Form::OfLines(FormKind::kWorkOn, {Field::Whole("START = ", 1, 0, 0, 1)});
  } else if (tool_ == 0) {
    MakeReady(turn, "WORKDEF", "WORKDEF " + of);
  } else {
    std::vector<Field> fields;
    if (tool_ == 1) {
      fields = {Field::Real("POWER ", 0.0, 0.0, 100.0), Field::Real("SPEED ", 0.0, 0.0, 100.0),
                Field::Real("DELAY ", 0.0, 0.0, 999'999.0), Field::Real("PEAK ", 0.0, 0.0, 100.0)};
    }
    fields.push_back(Field::Whole("PROG ", 2, 0, tool_ == 1 ? 0 : 1, 63));
    form_ = Form::OfLines(FormKind::kWorkdef, std::move(fields));
  }
}

// In the order of OPT-3.04; a schedule of 0 is none. OPT-5.31, OPT-5.32
void OptimoHandbox::EnterWorkdef(Turn& turn) {
  const Form& form = *form_;
  std::string text = "WORKDEF " + std::to_string(tool_) + "," + std::to_string(process_);
  if (tool_ == 2) {
    MakeReady(turn, "WORKDEF", text + " (" + std::to_string(form.at(0).whole()) + ")");
    return;
  }
  text = WithList(std::move(text),
                  {form.at(1).value(), form.at(0).value(), form.at(2).value(), form.at(3).value()});
  if (const int schedule = form.at(4).whole(); schedule > 0) {
    text.pop_back();
    text += ", " + std::to_string(schedule) + ")";
  }
  MakeReady(turn, "WORKDEF", std::move(text));
}

// OPT-5.37
void OptimoHandbox::EnterOutput(Turn& turn) {
  const int output = form_->at(0).whole();
  const int on = form_->at(1).whole();
  const std::string name = "OL[" + std::to_string(output) + "]";
  turn.Ask(machine::WriteVariable{.name = name, .value = static_cast<double>(on)});
  MakeReady(turn, "LET", name + " = " + std::to_string(on), Ready::As::kOutput);
}

// One, which takes the place of what was set before. OPT-6.06, OPT-6.09
void OptimoHandbox::EnterBreak(Turn& turn) {
  const Form form = *form_;
  if (form.kind() == FormKind::kBreak && form.at(0).chosen() == 1) {
    form_.emplace(FormKind::kBreakStep,
                  Lines{{Field::Whole("STEP = ", 3, 0, 1, 999),
                         Field::Whole(" PRG = ", 2, turn.program(), 1, kSlotMax)}});
    return;
  }
  form_.reset();
  machine::SetBreakpoints set;
  if (form.kind() == FormKind::kBreakStep)
    set.breakpoints = {{.at = {.program = form.at(1).whole(), .step = form.at(0).whole()}}};
  turn.Ask(std::move(set));
}

// Program 0 is the one that is selected. OPT-6.12, OPT-6.15
void OptimoHandbox::EnterSimul(Turn& turn) {
  const int given = form_->at(0).whole();
  const machine::ProgramStep until{.program = given > 0 ? given : turn.program(),
                                   .step = form_->at(1).whole()};
  if (until.program == 0) return Refuse(turn, ErrorCode::kNoProgramSelected);
  form_.reset();
  turn.Ask(machine::SetSimulation{.until = until});
}

// OPT-9.33, OPT-9.34
void OptimoHandbox::EnterFunction(Turn& turn) {
  const Form form = *form_;
  const auto ask = [this](const std::vector<double>& values) {
    const std::string text = "FUNCTION " + std::to_string(function_);
    function_text_ = values.empty() ? text : WithList(text, values);
    form_.reset();
    question_ = Question::kExecution;
  };
  if (form.kind() == FormKind::kFunction) {
    function_ = form.at(0).whole();
    form_ = Form::OfLines(FormKind::kFunctionCount,
                          {Field::Whole("NUMBER PARAMETERS=", 1, 0, 0, kParameterCount)});
  } else if (form.kind() == FormKind::kFunctionValues) {
    ask(ValuesOf(form, form.count()));
  } else if (const auto count = static_cast<std::size_t>(form.at(0).whole()); count > 0) {
    form_ = Form::OfNumbers(FormKind::kFunctionValues, std::span(kParameterNames).first(count), {});
  } else {
    ask({});
  }
  if (question_ && !IsInstruction(function_text_)) {
    question_.reset();
    Refuse(turn, ErrorCode::kFieldRange);
  }
}

// Carried out with the modes of the handbox, or not: then it is ready to record. OPT-9.35 to 9.37
void OptimoHandbox::AnswerExecution(Turn& turn, bool yes) {
  const std::string number = (function_ < 10 ? "0" : "") + std::to_string(function_);
  if (!yes) {
    MakeReady(turn, "FUNCTION = " + number, function_text_);
    return;
  }
  constexpr std::array<std::string_view, 4> kPaths = {"PTP", "LIN", "CIR", "HOLE"};
  const std::string path(kPaths[static_cast<std::size_t>(modes_.path)]);
  const bool hole = modes_.path == PathType::kHole;
  const std::string coord = modes_.coord == CoordType::kAbsol ? "ABSOL" : "ROBOT";
  if (!MakeReady(turn, "FUNC=" + number, function_text_, Ready::As::kLink)) return;
  turn.answer.run = {.what = machine::HandRun::kFunction,
                     .text = "COORD " + coord + "\n" +
                             (hole ? WithList("PATH HOLE", {modes_.radius_mm}) : "PATH " + path) +
                             "\n" + WithReal("SPEED", modes_.speed_percent) + "\n" +
                             WithReal("OVERSH", modes_.oversh_percent) + "\n" + function_text_ +
                             "\n"};
}

// OPT-9.38
void OptimoHandbox::EnterSysdef(Turn& turn) {
  const bool values = form_->kind() == FormKind::kSysdefValues;
  if (!values && form_->at(0).chosen() == 1) {
    form_ =
        Form::OfNumbers(FormKind::kSysdefValues, kFrameNames, ModalNumbers(turn.view, "SYSDEF"));
    return;
  }
  if (turn.view.status.open) return Refuse(turn);
  const std::vector<double> given = values ? ValuesOf(*form_, 6) : std::vector<double>();
  if (MakeReady(turn, "SYSDEF", values ? WithList("SYSDEF", given) : "SYSDEF"))
    turn.answer.setting = {.name = "SYSDEF", .values = given};
}

}  // namespace rmlcell::optimo
