#include "engine/rml1/offline/stream_walk.h"

#include "engine/core/number_text.h"
#include "engine/rml1/command_table.h"
#include "engine/rml1/verdict_rules.h"

namespace rmlcell::rml1 {

StreamWalk::StreamWalk(const Profile& profile, PhraseListener& listener)
    : device_(profile),
      listener_(listener),
      before_(profile),
      logical_before_(device_.carriage().logical()),
      physical_before_(device_.carriage().physical()) {}

bool StreamWalk::Run(const machine::Bytes& stream) {
  std::int64_t offset = 0;
  for (const char c : *stream) {
    if (offset % static_cast<std::int64_t>(machine::kReleaseEvery) == 0) stream.Release();
    device_.Receive(static_cast<unsigned char>(c), offset++, *this);
    if (!link_findings_.empty() && !EmitLinkErrors(offset)) return false;
    if (complete_ && !Emit()) return false;  // ESC.K
    while (device_.Step(*this)) {
      for (const Action& action : device_.actions().all()) actions_.push_back(action);
      while (!device_.actions().empty()) device_.actions().Pop();
      if (complete_ && !Emit()) return false;
    }
  }
  device_.EndOfData();
  if (!device_.pending()) return true;
  if (!in_command_) {
    phrase_ = {};
    phrase_.begin = phrase_.name = call_ >= 0 ? call_ : device_.pending_offset();
  }
  Complete(Phrase::Kind::kIncomplete, offset);
  return Emit();
}

void StreamWalk::OnFinding(const Finding& finding) {
  const bool of_link =
      finding.kind >= FindingKind::kBadSequence && finding.kind <= FindingKind::kBufferOverflow;
  if (finding.kind == FindingKind::kValueRange) {
    dropped_ = true;
    complete_ = complete_ && phrase_.kind != Phrase::Kind::kSet;
  }
  std::vector<Finding>& findings = of_link ? link_findings_ : findings_;
  if (findings.size() < Phrase::kFindingsMax) findings.push_back(finding);
}

void StreamWalk::OnAbort(std::int64_t offset) {
  constexpr std::int64_t kSequenceBytes = 3;
  in_command_ = false;
  call_ = -1;
  value_count_ = 0;
  phrase_ = {};
  phrase_.begin = phrase_.name = offset + 1 - kSequenceBytes;
  Complete(Phrase::Kind::kAbort, offset + 1);
}

void StreamWalk::OnReading(const Reading& reading, const CommandReader& reader,
                           std::int64_t offset) {
  switch (reading.kind) {
    case Reading::Kind::kCall:
      call_ = offset;
      break;
    case Reading::Kind::kCommand:
      BeginCommand(reader);
      break;
    case Reading::Kind::kParameter:
      AddValue(reader, offset);
      // The device runs a set at once. A value out of range drops the rest of the list, which comes
      // as one phrase at its end (RML1-2.34).
      if (reader.row().shape == Shape::kSets && value_count_ == reader.row().values && !dropped_) {
        Complete(Phrase::Kind::kSet, offset);
      }
      break;
    case Reading::Kind::kAxisValue:
      AddValue(reader, offset);
      break;
    case Reading::Kind::kGroup:
      Complete(Phrase::Kind::kGroup, offset);
      break;
    case Reading::Kind::kEnd:
      OnListEnd(offset);
      break;
    case Reading::Kind::kError:
      if (in_command_) break;  // of !ZE: its terminator ends the phrase
      phrase_ = {};
      phrase_.begin = phrase_.name = call_ >= 0 ? call_ : reader.error_offset();
      call_ = -1;
      Complete(Phrase::Kind::kDiscarded, reader.error_offset() + reader.error_length());
      break;
    case Reading::Kind::kNothing:
    case Reading::Kind::kStatementEnd:
      break;
  }
}

void StreamWalk::BeginCommand(const CommandReader& reader) {
  in_command_ = true;
  ran_ = dropped_ = false;
  value_count_ = 0;
  phrase_ = {};
  phrase_.op = reader.row().op;
  phrase_.command = device_.command().number + 1;  // the device counts it next
  phrase_.has_call = call_ >= 0;
  phrase_.name = phrase_.begin = phrase_.has_call ? call_ : reader.command_offset();
  call_ = -1;
}

void StreamWalk::AddValue(const CommandReader& reader, std::int64_t end) {
  if (value_count_ == Phrase::kValuesMax) return;
  const bool axes = reader.row().shape == Shape::kAxes;
  values_[value_count_++] = {.number = reader.number(),
                             .axis = axes ? reader.axis() : '\0',
                             .begin = reader.number_offset(),
                             .end = end};
}

void StreamWalk::OnListEnd(std::int64_t offset) {
  in_command_ = false;
  switch (RowOf(phrase_.op).shape) {
    case Shape::kFixed:
      Complete(Phrase::Kind::kFixed, offset);
      break;
    case Shape::kAny:
      Complete(Phrase::Kind::kSkipped, offset);
      break;
    case Shape::kSets:
      if (value_count_ > 0) {
        Complete(Phrase::Kind::kLeftOver, offset);
      } else if (!ran_) {
        Complete(Phrase::Kind::kBare, offset);
      }
      break;
    case Shape::kAxes:
      if (!findings_.empty()) Complete(Phrase::Kind::kGroup, offset);
      break;
    case Shape::kCall:
      break;
  }
}

void StreamWalk::Complete(Phrase::Kind kind, std::int64_t end) {
  phrase_.kind = kind;
  phrase_.end = end;
  complete_ = true;
}

// What was collected, when the device has acted on it.
bool StreamWalk::Emit() {
  complete_ = false;
  phrase_.values = {values_.data(), value_count_};
  phrase_.actions = actions_;
  phrase_.findings = findings_;
  const bool go_on = Tell(phrase_);
  phrase_.begin = phrase_.end;
  phrase_.first = false;
  ran_ = true;
  value_count_ = 0;
  actions_.clear();
  findings_.clear();
  return go_on;
}

// They interrupt the command in collection no more than they do in the machine.
bool StreamWalk::EmitLinkErrors(std::int64_t end) {
  Phrase phrase{.kind = Phrase::Kind::kLinkError,
                .name = link_findings_.front().offset,
                .begin = link_findings_.front().offset,
                .end = end,
                .findings = link_findings_};
  const bool go_on = Tell(phrase);
  link_findings_.clear();
  return go_on;
}

bool StreamWalk::Tell(Phrase& phrase) {
  const Registers after = device_.registers();
  phrase.before = &before_;
  phrase.after = &after;
  phrase.logical_before = logical_before_;
  phrase.physical_before = physical_before_;
  phrase.logical = device_.carriage().logical();
  phrase.physical = device_.carriage().physical();
  const bool go_on = listener_.OnPhrase(phrase);
  before_ = after;
  logical_before_ = phrase.logical;
  physical_before_ = phrase.physical;
  return go_on;
}

Status CheckIsStream(const Device& device) {
  const double foreign_percent = device.foreign_percent();
  if (foreign_percent <= kForeignShareMax_percent) return {};
  return Error{ErrorCode::kRml1NoProgram,
               Told("share", foreign_percent, "%", FixedText(foreign_percent, 1) + " %") +
                   " of the bytes belong to no command",
               {}};
}

}  // namespace rmlcell::rml1
