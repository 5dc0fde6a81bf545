#include "engine/rml1/device.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::rml1 {
namespace {

FindingKind KindOf(ReadError error) {
  switch (error) {
    case ReadError::kForeignCharacter:
      return FindingKind::kForeignCharacter;
    case ReadError::kUnknownName:
      return FindingKind::kUnknownName;
    case ReadError::kStrayNumber:
      return FindingKind::kStrayNumber;
    case ReadError::kUnknownCall:
      return FindingKind::kUnknownCall;
    case ReadError::kAxisTwice:
      return FindingKind::kAxisTwice;
    case ReadError::kAxisValue:
      return FindingKind::kAxisValue;
    case ReadError::kAxisLetter:
      return FindingKind::kAxisLetter;
  }
  return FindingKind::kForeignCharacter;
}

FindingKind KindOf(LinkError error) {
  switch (error) {
    case LinkError::kBadParameter:
      return FindingKind::kBadSequenceParameter;
    case LinkError::kParameterOverflow:
      return FindingKind::kSequenceParameterRange;
    case LinkError::kTooManyParameters:
      return FindingKind::kTooManySequenceParameters;
    case LinkError::kLine:
      return FindingKind::kLineError;
    case LinkError::kOverflow:
      return FindingKind::kBufferOverflow;
    default:
      return FindingKind::kBadSequence;
  }
}

// Errors that leave the tool somewhere else than the program says.
bool LosesPosition(FindingKind kind) {
  switch (kind) {
    case FindingKind::kAxisTwice:
    case FindingKind::kAxisValue:
    case FindingKind::kAxisLetter:
    case FindingKind::kAxesTogether:
    case FindingKind::kLeftOver:
    case FindingKind::kValueRange:
    case FindingKind::kHeightRange:
    case FindingKind::kTravelRange:
      return true;
    default:
      return false;
  }
}

}  // namespace

Device::Device(const Profile& profile)
    : profile_(&profile),
      path_(profile.seven_bits, profile.all_sequences),
      buffer_(profile.buffer_bytes),
      reader_(profile.commands),
      registers_(profile),
      carriage_(profile) {}

void Device::Restore(const Registers& registers, const Point& at) {
  registers_ = registers;
  registers_.z0 = std::clamp(registers.z0, profile_->z.low, profile_->z.high);
  registers_.surface_z = registers_.z0;
  registers_.xy_speed = profile_->xy_speeds.Nearest(registers.xy_speed);
  registers_.z_speed = profile_->z_speeds.Nearest(registers.z_speed);
  registers_.rpm = std::clamp(registers.rpm, profile_->spindle_min_rpm, profile_->spindle_max_rpm);
  carriage_.Place(at);
}

void Device::Receive(unsigned char byte, std::int64_t offset, DeviceListener& listener) {
  last_offset_ = offset;
  if (const std::optional<unsigned char> plain = path_.Plain(byte)) {
    ToBuffer(*plain, offset, listener);
    return;
  }
  const Received received = path_.Put(byte);
  if (received.abort) {  // RML1-4.08 to 4.12: what has run stays, what has not is forgotten
    buffer_.Clear();
    reader_.Drop();
    listener.OnAbort(offset);
    return;
  }
  for (const LinkError error : received.errors) {
    if (error == LinkError::kNone) continue;
    Log(link_errors_, {.kind = KindOf(error), .offset = offset, .byte = byte}, listener);
  }
  for (std::uint8_t i = 0; i < received.count; ++i) {
    ToBuffer(received.bytes[i].byte, offset - received.bytes[i].back, listener);
  }
}

void Device::ToBuffer(unsigned char byte, std::int64_t offset, DeviceListener& listener) {
  if (buffer_.Push(byte, offset)) return;
  Log(link_errors_, {.kind = FindingKind::kBufferOverflow, .offset = offset, .byte = byte},
      listener);
}

void Device::ReportLineError(std::int64_t offset, DeviceListener& listener) {
  Log(link_errors_, {.kind = FindingKind::kLineError, .offset = offset}, listener);
}

bool Device::StepOn(DeviceListener& listener) {
  const DataBuffer::Entry entry = buffer_.front();
  const Reading reading = reader_.Put(entry.byte, entry.offset);
  if (reading.taken) {
    buffer_.Pop();
    ++bytes_read_;
  }
  if (reading.kind == Reading::Kind::kNothing) return true;
  listener.OnReading(reading, reader_, entry.offset);
  Act(reading, entry.byte, listener);
  return true;
}

bool Device::IsFarFromLimits() const {
  constexpr double kNear = 7'000'000;
  return std::max({std::abs(Present(0)), std::abs(Present(1)), std::abs(Present(2))}) <= kNear;
}

// By itself: what it needs in registers the reading around it does not.
[[gnu::noinline]] void Device::CarryOutSet(DeviceListener& listener) {
  BeginCommand(listener);
  operands_.ran = true;
  operands_.count = 0;
  const CommandRow& row = reader_.row();
  const auto [a, b, c] = operands_.set;
  ++registers_.act;
  ReliesOnZ0();
  const double lost = carriage_.lost().length;
  ApplyEffects(row);
  ReliesOnMode();
  Point to = carriage_.logical();
  if (registers_.absolute) {
    GivePlace(true, true);
    to.x = a + profile_->origin_x;
    if (profile_->has_y) to.y = b + profile_->origin_y;
    to.z = registers_.z0;
  } else {
    to.x += a;
    if (profile_->has_y) to.y += b;
  }
  if (row.values == 3) {
    to.z += c;
    programmed_.OnSetXYZ(a, b, c);
    carriage_.MoveXYZ(context(), to);
  } else {
    programmed_.OnSetXY(row, a, b);
    ReliesOnHeights();
    carriage_.ToToolHeight(context());
    carriage_.MoveXY(context(), to.x, to.y);
  }
  NoteClipping(lost, listener);
}

// A whole set, or a whole parameter. A set that may lead out of the range of numbers is read number
// by number.
[[gnu::always_inline]] inline bool Device::TakeParameters(ByteSpan& bytes,
                                                          DeviceListener& listener) {
  const CommandRow& row = reader_.row();
  const bool begins_set = row.shape == Shape::kSets && operands_.count == 0 && !operands_.dropped;
  const bool in_range = begins_set && (!IsRelative(row) || IsFarFromLimits());
  if (in_range && reader_.ReadSet(bytes, operands_.set)) {
    operands_.any = true;
    CarryOutSet(listener);
    return true;
  }
  if (!reader_.ReadParameter(bytes)) return false;
  OnParameter(listener);
  return true;
}

// One byte, unless it is for the receive path. True: it is to be looked at again.
inline bool Device::TakeByte(ByteSpan& bytes, DeviceListener& listener) {
  if (bytes.empty() || !ReceivePath::AlwaysPasses(*bytes.at())) return false;
  const unsigned char byte = bytes.front();
  const Reading reading = reader_.Put(byte, bytes.offset());
  if (reading.taken) bytes.Skip();
  if (reading.kind != Reading::Kind::kNothing) Act(reading, byte, listener);
  return !reading.taken;
}

// A byte that is for the receive path, and all that comes of it.
[[gnu::noinline]] void Device::TakeThroughBuffer(const ByteSpan& bytes, std::uint64_t done_max,
                                                 DeviceListener& listener) {
  Receive(bytes.front(), bytes.offset(), listener);
  --bytes_read_;  // Step counts what comes out of the buffer
  while (!Happened(done_max) && Step(listener)) {
  }
}

Device::Taken Device::Read(std::string_view bytes, std::int64_t offset, std::uint64_t commands,
                           DeviceListener& listener) {
  ByteSpan span(bytes, offset);
  const std::uint64_t done_max = commands_done_ + commands;
  bool again = false;  // the byte in front is to be looked at again
  while (!span.empty() && !Happened(done_max)) {
    if (path_.pending() || !ReceivePath::AlwaysPasses(*span.at())) {
      TakeThroughBuffer(span, done_max, listener);
      span.Skip();
      again = false;
      continue;
    }
    if (reader_.ListEndsBefore(*span.at())) {
      reader_.EndListHere();
      EndCommand(listener);
      again = true;
      if (Happened(done_max)) break;
    }
    if (reader_.searches()) {
      again = false;
      if (CommandReader::SkipStatementEnds(span)) programmed_.OnStatementEnd();
      if (span.empty()) break;
      if (reader_.ReadName(span)) {
        OnName();
        if (span.empty()) break;
      }
    }
    again = reader_.ParameterMayBegin(*span.at()) && TakeParameters(span, listener);
    if (!again) again = TakeByte(span, listener);
  }
  bytes_read_ += span.read();
  return {.bytes = span.read(), .next = again};
}

bool Device::spindle_turns() const {
  for (const Action& action : actions_.all()) {
    if (action.kind == Action::Kind::kSpindleStart) return false;
    if (action.kind == Action::Kind::kSpindleStop) return true;
  }
  return registers_.spindle_on;
}

// What the reading of this byte means.
void Device::Act(const Reading& reading, unsigned char byte, DeviceListener& listener) {
  switch (reading.kind) {
    case Reading::Kind::kNothing:
      break;
    case Reading::Kind::kCommand:
      OnName();
      if (reader_.row().shape == Shape::kAxes) ClearGroup();
      break;
    case Reading::Kind::kCall:
      programmed_.OnCommand(Op::kCall);
      break;
    case Reading::Kind::kParameter:
      OnParameter(listener);
      break;
    case Reading::Kind::kAxisValue:
      OnAxisValue(listener);
      break;
    case Reading::Kind::kGroup:
      OnGroup(listener);
      break;
    case Reading::Kind::kEnd:
      OnEnd(listener);
      break;
    case Reading::Kind::kError:
      OnReadError(byte, listener);
      break;
    case Reading::Kind::kStatementEnd:
      programmed_.OnStatementEnd();
      break;
  }
}

void Device::OnReadError(unsigned char byte, DeviceListener& listener) {
  const ReadError error = reader_.error();
  const bool in_axes = error == ReadError::kAxisTwice || error == ReadError::kAxisValue ||
                       error == ReadError::kAxisLetter;
  if (in_axes) {
    BeginCommand(listener);
  } else {
    programmed_.OnDiscarded(error == ReadError::kUnknownName || error == ReadError::kUnknownCall);
    bytes_foreign_ += static_cast<std::uint64_t>(reader_.error_length());
  }
  Log(command_errors_,
      {.kind = KindOf(error),
       .offset = reader_.error_offset(),
       .length = reader_.error_length(),
       .step = in_axes ? static_cast<int>(command_.number) : 0,
       .byte = byte,
       .op = command_.op},
      listener);
}

void Device::OnParameter(DeviceListener& listener) {
  operands_.any = true;
  const CommandRow& row = reader_.row();
  if (row.shape == Shape::kFixed) {
    operands_.fixed[static_cast<std::size_t>(operands_.count++)] = reader_.number();
    return;
  }
  if (row.shape != Shape::kSets || operands_.dropped) return;
  if (!TakeCoordinate(listener)) {
    operands_.dropped = true;
    return;
  }
  if (operands_.count < row.values) return;
  CarryOutSet(listener);
}

// The parameter list is over.
void Device::OnEnd(DeviceListener& listener) {
  BeginCommand(listener);
  const CommandRow& row = reader_.row();
  if (row.shape == Shape::kFixed) {
    RunFixed(listener);
  } else if (row.shape == Shape::kAny) {
    Advise(FindingKind::kSkippedName, listener);
  } else if (row.shape == Shape::kSets) {
    if (!operands_.any) {
      RunBare(listener);
    } else if (operands_.count > 0 && !operands_.dropped) {
      Report(FindingKind::kLeftOver, listener);  // RML1-9.15, RML1-9.16
    }
  }
  ++commands_done_;
}

void Device::Report(FindingKind kind, DeviceListener& listener, double value, Travel allowed) {
  BeginCommand(listener);
  Log(command_errors_,
      {.kind = kind,
       .offset = command_.offset,
       .length = static_cast<int>(RowOf(command_.op).name.size()),
       .step = static_cast<int>(command_.number),
       .op = command_.op,
       .value = value,
       .allowed = allowed},
      listener);
}

double Device::foreign_percent() const {
  // A mistyped word in a line is no other language. Of G-code nearly half is foreign, of noise more
  // than that: where it is more than a word and more than a quarter, few bytes are enough to tell.
  constexpr std::uint64_t kFew = 256;
  constexpr std::uint64_t kWord = 7;
  const bool much = bytes_foreign_ > kWord && 4 * bytes_foreign_ > bytes_read_;
  return 100.0 * static_cast<double>(bytes_foreign_) /
         static_cast<double>(much ? bytes_read_ : std::max(bytes_read_, kFew));
}

void Device::Log(ErrorLog& log, Finding finding, DeviceListener& listener) {
  if (LosesPosition(finding.kind)) {
    if (positions_refused_++ == 0) first_refused_ = command_;
  }
  const bool was_cut = log.cut();
  const int number = Lookup(RowOf(finding.kind).code).number;
  if (log.Add(number, finding.offset)) {
    listener.OnFinding(finding);
    return;
  }
  listener.OnCounted(finding);
  if (was_cut) return;
  finding.kind = FindingKind::kLogCut;
  listener.OnFinding(finding);
}

void Device::Advise(FindingKind kind, DeviceListener& listener, double value) {
  int& told = advised_[static_cast<std::size_t>(kind)];
  const Finding advice{.kind = kind,
                       .offset = command_.offset,
                       .length = static_cast<int>(RowOf(command_.op).name.size()),
                       .step = static_cast<int>(command_.number),
                       .op = command_.op,
                       .value = value};
  if (told >= kAdviceMax) return listener.OnCounted(advice);
  ++told;
  listener.OnFinding(advice);
}

}  // namespace rmlcell::rml1
