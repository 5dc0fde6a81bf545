// What each command does, from its parameters (rml1.md sections 3A to 3E).
#include <algorithm>
#include <array>

#include "engine/rml1/device.h"

namespace rmlcell::rml1 {
namespace {

bool InFloatRange(double value) {
  return value >= static_cast<double>(kFloatMin) && value <= static_cast<double>(kFloatMax);
}

constexpr std::int64_t kFirstRpm = 100;  // of !RC; below, it is a stage (RML1-3C.15)

// !RC sets no speed where that is done by hand (RML1-3C.20); one that cannot be set there either is
// not the one that the program is made for.
SpeedLimit LimitByHand(const Profile& profile, std::int64_t wanted) {
  const auto rpm = static_cast<double>(wanted);
  const double nearest = std::clamp(rpm, static_cast<double>(profile.spindle_min_rpm),
                                    static_cast<double>(profile.spindle_max_rpm));
  if (wanted < kFirstRpm || nearest == rpm) return {};
  return {.asked = rpm, .used = nearest};
}

// 16 stages, evenly spaced; higher ones count as the last (RML1-9.31).
int StageSpeed(const Profile& profile, std::int64_t stage) {
  constexpr int kLastStage = 15;
  const int n = static_cast<int>(std::min<std::int64_t>(stage, kLastStage));
  const int span = profile.spindle_max_rpm - profile.spindle_min_rpm;
  return profile.spindle_min_rpm + static_cast<int>(std::int64_t{span} * n / kLastStage);
}

}  // namespace

void Device::NotePlace(bool x, bool y) {
  registers_.x_given = registers_.x_given || x;
  registers_.y_given = registers_.y_given || y;
  const bool both = registers_.x_given && registers_.y_given;
  if (both) registers_.place_given_by = registers_.act;
}

// One number of a set. False: it is out of range, and so are its set and the later ones
// (RML1-2.34, RML1-2.35).
bool Device::TakeCoordinate(DeviceListener& listener) {
  const Number& number = reader_.number();
  const bool relative = IsRelative(reader_.row());
  const double result = relative ? number.single + Present(operands_.count) : number.single;
  if (!number.Within(kFloatMin, kFloatMax) || !InFloatRange(result)) {
    Report(FindingKind::kValueRange, listener, relative ? result : number.decimal);
    return false;
  }
  operands_.set[static_cast<std::size_t>(operands_.count++)] = number.single;
  return true;
}

// A command with sets, without any parameter.
void Device::RunBare(DeviceListener& listener) {
  const CommandRow& row = reader_.row();
  ++registers_.act;
  ReliesOnZ0();
  const double lost = carriage_.lost().length;
  ApplyEffects(row);
  programmed_.OnBare(row);
  if (row.tool != ToolChange::kNone) {
    ReliesOnHeights();
    carriage_.ToToolHeight(context());
  }
  NoteClipping(lost, listener);
}

void Device::TellClipping(DeviceListener& listener) {
  for (const Carriage::LostLine& line : carriage_.lost_lines()) listener.OnLost(line);
  carriage_.ForgetLostLines();
  if (first_lost_.number == 0) first_lost_ = command_;
  if (clip_told_ == command_.number) return;
  clip_told_ = command_.number;
  Advise(FindingKind::kClipped, listener);
}

void Device::RunFixed(DeviceListener& listener) {
  const CommandRow& row = reader_.row();
  ++registers_.act;
  switch (row.op) {
    case Op::kF:
    case Op::kVS:
      SetXYSpeed(listener);
      break;
    case Op::kV:
    case Op::kVZ:
      SetZSpeed(listener);
      break;
    case Op::kW:
    case Op::kDW:
      SetDwell(listener);
      break;
    case Op::kAt:
    case Op::kPZ:
      SetHeights(listener);
      break;
    case Op::kMC:
      SetRotation();
      break;
    case Op::kRC:
      SetSpindleSpeed(listener);
      break;
    case Op::kZM:
      MoveMachineZ(listener);
      break;
    case Op::kZO:
      SetZ0(listener);
      break;
    case Op::kNR:
      actions_.Push(Action::Kind::kPause);
      break;
    case Op::kDF:
      programmed_.OnBare(row);
      RestoreDefaults();
      break;
    case Op::kIN:
      programmed_.OnBare(row);
      RestoreDefaults();
      ApplyEffects(row);
      carriage_.RaiseForInitialise(context());
      command_errors_.ClearRegister();
      StopSpindle(false);
      break;
    case Op::kH:
      programmed_.OnBare(row);
      ApplyEffects(row);
      GivePlace(true, true);
      carriage_.GoHome(context());
      command_errors_.ClearRegister();
      StopSpindle(false);
      break;
    default:
      break;
  }
}

void Device::ClearGroup() {
  group_ = {.to = carriage_.logical(), .has_y = false, .has_a = false, .named = {}};
}

// One axis of a group of !ZE. Axes that the model lacks are read and ignored (RML1-3D.10).
void Device::OnAxisValue(DeviceListener& listener) {
  const Number& number = reader_.number();
  const Point& logical = carriage_.logical();
  double* target = nullptr;
  double origin = 0.0;
  double present = 0.0;
  switch (reader_.axis()) {
    case 'X':
      target = &group_.to.x;
      origin = profile_->origin_x;
      present = logical.x;
      group_.named.has_x = true;
      group_.named.x = number.single;
      break;
    case 'Y':
      group_.named.has_y = true;
      group_.named.y = number.single;
      if (!profile_->has_y) break;
      group_.has_y = true;
      target = &group_.to.y;
      origin = profile_->origin_y;
      present = logical.y;
      break;
    case 'Z':
      target = &group_.to.z;
      origin = registers_.z0;
      present = logical.z;
      group_.named.has_z = true;
      group_.named.z = number.single;
      break;
    case 'A':
      if (!profile_->has_rotary) break;
      group_.has_a = true;
      target = &group_.to.a;
      present = logical.a;
      break;
    default:
      break;
  }
  const double machine = number.single + (registers_.absolute ? origin : present);
  const bool in_range =
      number.Within(kFloatMin, kFloatMax) && (target == nullptr || InFloatRange(machine - origin));
  if (in_range) {
    if (target != nullptr) *target = machine;
    return;
  }
  Report(FindingKind::kValueRange, listener, number.decimal);
  reader_.SkipGroups();
}

void Device::OnGroup(DeviceListener& listener) {
  BeginCommand(listener);
  if (group_.has_y && group_.has_a && !profile_->y_with_rotary) {
    Report(FindingKind::kAxesTogether, listener);
    reader_.SkipGroups();
    return;
  }
  ReliesOnMode();
  ReliesOnZ0();
  ++registers_.act;
  const Programmed::AxisGroup& named = group_.named;
  if (registers_.absolute) GivePlace(named.has_x, named.has_y || !profile_->has_y);
  if (named.has_x || named.has_y || named.has_z) programmed_.OnGroup(named);
  const double lost = carriage_.lost().length;
  carriage_.MoveXYZ(context(), group_.to);
  NoteClipping(lost, listener);
  ClearGroup();
}

// Rounding to a step of the control is no limit.
double Device::NearestSpeed(const motion::FeedSteps& steps, SpeedLimit& limit,
                            DeviceListener& listener) {
  const double wanted = operands_.fixed[0].decimal;
  limit = {};
  if (wanted < steps.minimum_mm_s || wanted > steps.maximum_mm_s) {
    ++speeds_limited_;
    limit = {.asked = wanted, .used = steps.Nearest(wanted)};
    Advise(FindingKind::kSpeedLimited, listener, wanted);
  }
  return steps.Nearest(wanted);
}

// F, VS: never an error (RML1-3A.46, RML1-3B.28).
void Device::SetXYSpeed(DeviceListener& listener) {
  registers_.xy_speed_given = operands_.count > 0;
  registers_.xy_limit = {};
  registers_.xy_speed = operands_.count == 0
                            ? profile_->xy_speed
                            : NearestSpeed(profile_->xy_speeds, registers_.xy_limit, listener);
}

// V, !VZ: an error outside int (RML1-3A.52).
void Device::SetZSpeed(DeviceListener& listener) {
  if (operands_.count == 0) {
    registers_.z_speed = profile_->z_speed;
    registers_.z_speed_given = false;
    registers_.z_limit = {};
  } else if (!operands_.fixed[0].Within(kIntMin, kIntMax)) {
    Report(FindingKind::kSettingRange, listener, operands_.fixed[0].decimal);
  } else {
    registers_.z_speed = NearestSpeed(profile_->z_speeds, registers_.z_limit, listener);
    registers_.z_speed_given = true;
  }
}

void Device::SetDwell(DeviceListener& listener) {
  const std::int64_t wanted = operands_.count == 0 ? 0 : operands_.fixed[0].truncated();
  if (wanted < 0 || wanted > kIntMax) {
    Report(FindingKind::kSettingRange, listener, static_cast<double>(wanted));
    return;
  }
  registers_.dwell_ms = static_cast<int>(wanted);
}

// @, !PZ: each height is set or refused by itself (RML1-3A.01 to 3A.09).
void Device::SetHeights(DeviceListener& listener) {
  programmed_.OnHeights(operands_.count, operands_.fixed[0], operands_.fixed[1]);
  registers_.heights_given = true;
  if (operands_.count == 0) {
    registers_.z1 = profile_->z1;
    registers_.z2 = profile_->z2;
    return;
  }
  const auto z1 = static_cast<double>(operands_.fixed[0].truncated());
  const double lowest = profile_->z.low - registers_.z0;
  if (z1 > 0.0 || z1 < lowest - CuttingRange::kFaceTolerance) {
    Report(FindingKind::kHeightRange, listener, z1, {lowest, 0.0});
  } else {
    registers_.z1 = z1;
  }
  if (operands_.count < 2) return;
  const std::int64_t z2 = operands_.fixed[1].truncated();
  if (z2 < 0 || z2 > kFloatMax) {
    Report(FindingKind::kHeightRange, listener, static_cast<double>(z2),
           {0.0, static_cast<double>(kFloatMax)});
  } else {
    registers_.z2 = static_cast<double>(z2);
  }
}

// !MC: never an error; a value beyond int is not 0 (RML1-3C.07).
void Device::SetRotation() {
  registers_.rotation = operands_.count == 0 || operands_.fixed[0].truncated() != 0;
  registers_.rotation_given = true;
  if (!registers_.rotation) StopSpindle(true);
}

void Device::SetSpindleSpeed(DeviceListener& listener) {
  if (operands_.count == 0) return;
  const std::int64_t wanted = operands_.fixed[0].truncated();
  if (profile_->spindle_control == SpindleControl::kNone) {
    registers_.rpm_limit = LimitByHand(*profile_, wanted);
    return;
  }
  if (wanted < 0 || wanted > kFloatMax) {
    Report(FindingKind::kSettingRange, listener, static_cast<double>(wanted));
    return;
  }
  int rpm = StageSpeed(*profile_, wanted);
  if (wanted >= kFirstRpm && profile_->spindle_control == SpindleControl::kRpm) {
    const int step = profile_->spindle_step_rpm;
    rpm = std::clamp(static_cast<int>(wanted) / step * step, profile_->spindle_min_rpm,
                     profile_->spindle_max_rpm);
  }
  const bool has_it = wanted < kFirstRpm ||
                      (profile_->spindle_control == SpindleControl::kRpm &&
                       wanted >= profile_->spindle_min_rpm && wanted <= profile_->spindle_max_rpm);
  registers_.rpm_limit = {};
  if (!has_it) {
    registers_.rpm_limit = {.asked = static_cast<double>(wanted), .used = static_cast<double>(rpm)};
  }
  if (rpm == registers_.rpm) return;  // RML1-3C.39
  registers_.rpm = rpm;
  if (registers_.spindle_on) actions_.Push(Action::Kind::kSpindleSpeed).rpm = rpm;
}

void Device::MoveMachineZ(DeviceListener& listener) {
  if (operands_.count == 0) return;
  ReliesOnMode();
  const auto wanted = static_cast<double>(operands_.fixed[0].truncated());
  const double z = wanted + (registers_.absolute ? 0.0 : carriage_.logical().z);
  if (z < profile_->z.low || z > profile_->z.high) {
    Report(FindingKind::kTravelRange, listener, z);
  } else {
    carriage_.MoveZ(context(), z);
  }
}

void Device::SetZ0(DeviceListener& listener) {
  if (operands_.count == 0) {
    MoveZ0(profile_->z0);
    return;
  }
  ReliesOnMode();
  const auto wanted = static_cast<double>(operands_.fixed[0].truncated());
  const double z = wanted + (registers_.absolute ? 0.0 : carriage_.logical().z);
  if (z < profile_->z.low || z > profile_->z.high) {
    Report(FindingKind::kTravelRange, listener, z);
  } else {
    MoveZ0(z);
  }
}

// The material stays where it is: RML1-9.11.
void Device::MoveZ0(double z) {
  registers_.z0 = z;
  z0_moved_by_ = command_;
}

void Device::NoteMovedZ0() {
  const double up = registers_.z0 - registers_.surface_z;
  const auto note = [&](double by, MovedZ0& furthest) {
    if (!(by > furthest.by)) return;
    if (furthest.by == 0.0) furthest.at = z0_moved_by_;
    furthest.by = by;
  };
  note(up, raised_);
  note(-up, lowered_);
}

// DF (RML1-3B.01).
void Device::RestoreDefaults() {
  registers_.absolute = true;
  registers_.mode_given = registers_.heights_given = registers_.rotation_given = true;
  registers_.xy_speed = profile_->xy_speed;
  registers_.z_speed = profile_->z_speed;
  registers_.xy_speed_given = registers_.z_speed_given = false;
  registers_.xy_limit = registers_.z_limit = {};
  registers_.dwell_ms = 0;
  registers_.rotation = true;
  registers_.z1 = profile_->z1;
  registers_.z2 = profile_->z2;
}

void Device::StopSpindle(bool waits) {
  if (!registers_.spindle_on) return;
  registers_.spindle_on = false;
  actions_.Push(Action::Kind::kSpindleStop).waits = waits;
}

}  // namespace rmlcell::rml1
