#include <array>
#include <string>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/optimo/handbox/modal_text.h"
#include "engine/optimo/handbox/optimo_handbox.h"

// The forms that keys open. OPT-4.43, OPT-4.46, OPT-B.74
namespace rmlcell::optimo {
namespace {

using Lines = std::vector<Form::Line>;

Field Flag(std::string before, bool on) {
  return Field::Whole(std::move(before), 1, on ? 1 : 0, 0, 1);
}

}  // namespace

// In MANUAL. What was entered before is dropped. OPT-5.04
bool OptimoHandbox::OpensForm(Turn& turn) {
  const Key key = turn.key.key;
  std::optional<Form> form;
  switch (key) {
    case Key::kMov:
    case Key::kTcp:
    case Key::kCal:
      break;
    case Key::kDeb:
      form = Form::OfLines(FormKind::kBreak, {Field::Choice("BREAK = ", {"OFF", "ON"}, 0)});
      break;
    case Key::kDyn:
      form = Form::OfLines(
          FormKind::kCoord,
          {Field::Choice("COORD ", {"ABSOL", "ROBOT"}, static_cast<std::size_t>(modes_.coord))});
      break;
    case Key::kPath:
      form = Form::OfLines(FormKind::kPath, {Field::Choice("PATH ", {"PTP", "LIN", "CIR", "HOL"},
                                                           static_cast<std::size_t>(modes_.path))});
      break;
    case Key::kWork:
      form.emplace(FormKind::kProcess, Lines{{Field::Whole("TOOL = ", 1, 0, 0, 2),
                                              Field::Whole(" PROGR = ", 2, 0, 0, 9)}});
      break;
    case Key::kDly:
      form = Form::OfLines(FormKind::kDelay, {Field::Real("DELAY ", 0.0, 0.0, 999'999.0)});
      break;
    case Key::kOut:
      form.emplace(FormKind::kOutput,
                   Lines{{Field::Whole("OUT ", 2, 0, 1, kVariableIndexMax), Flag(" = ", false)}});
      break;
    case Key::kStart:
      form = Form::OfLines(FormKind::kLink, {Field::Choice("ISTR ", {"GO", "CALL"}, 0)});
      break;
    case Key::kOversh:
      form = Form::OfLines(FormKind::kOversh, {Field::Real("OVERSH ", modes_.oversh_percent, 0.0,
                                                           100.0, Decimals::kIfAny)});
      break;
    case Key::kFunction:
      form = std::exchange(shift_, false)
                 ? Form::OfLines(FormKind::kSysdef, {Field::Choice("SYSDEF = ", {"NO", "YES"}, 0)})
                 : Form::OfLines(FormKind::kFunction,
                                 {Field::Whole("FUNCTION = ", 2, 0, 1, kSlotMax)});
      break;
    case Key::kSimul:
      form.emplace(FormKind::kSimul,
                   Lines{{Field::Whole("SIM PRG ", 2, turn.program(), 0, kSlotMax),
                          Field::Whole(" STEP ", 4, 0, 1, 9999)}});
      break;
    case Key::kGosub:
      form = Form::OfLines(FormKind::kGosub, {Field::Whole("GOSUB ", 4, 0, 0, 9999)});
      break;
    default:
      return false;
  }
  Drop();
  form_ = std::move(form);
  if (key == Key::kMov) OpenMove();
  if (key == Key::kTcp) OpenTool(turn);
  if (key == Key::kCal) OpenParameters();
  return true;
}

// OPT-5.23
void OptimoHandbox::OpenMove() {
  form_ =
      Form::OfLines(FormKind::kMove,
                    {Field::Real("SPEED ", modes_.speed_percent, 0.0, 100.0),
                     Flag("FLY = ", modes_.fly), Flag("START = ", next_move_.start.has_value()),
                     Flag("TIME = ", next_move_.time_s.has_value()),
                     Flag("END = ", next_move_.end.has_value()), Flag("NEXT = ", next_move_.next)});
}

// OPT-4.73
void OptimoHandbox::OpenTool(Turn& turn) {
  constexpr std::array<std::string_view, 6> kNames = {"X0", "Y0", "Z0", "X1", "Y1", "Z1"};
  form_ = Form::OfNumbers(FormKind::kTool, kNames, ModalNumbers(turn.view, "TCP"));
}

// To be looked at; PREV and NEXT go through them. OPT-4.44
void OptimoHandbox::OpenParameters() {
  std::vector<Field> fields;
  for (const machine::ParameterInfo& info : parameters_.table()) {
    const std::string value = info.choices.empty() ? ShortestText(parameters_.Number(info.name))
                                                   : std::string(parameters_.Word(info.name));
    fields.push_back(Field::Shown(std::string(info.name) + " " + value));
  }
  form_ = Form::OfLines(FormKind::kParameters, std::move(fields));
}

}  // namespace rmlcell::optimo
