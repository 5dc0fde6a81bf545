#include "engine/rml1/offline/stream_scaler.h"

#include <cmath>

namespace rmlcell::rml1 {
bool StreamScaler::OnPhrase(const Phrase& phrase) {
  if (const auto why = WhyNotFollowed(phrase)) {
    copy_.Refuse(*why, phrase.begin);
    return false;
  }
  const CommandRow& row = RowOf(phrase.op);
  switch (phrase.kind) {
    case Phrase::Kind::kSet:
    case Phrase::Kind::kGroup:
      ScaleSet(phrase);
      break;
    case Phrase::Kind::kBare:
      if (row.tool != ToolChange::kNone)
        short_[kAxisZ] = short_z0_ + (phrase.after->tool_down ? short_z1_ : short_z2_);
      break;
    case Phrase::Kind::kFixed:
      ScaleFixed(phrase);
      break;
    default:
      break;
  }
  return !copy_.failed();
}

double StreamScaler::Replace(const Phrase::Value& value, double exact) {
  const double rounded = std::round(exact);
  copy_.Replace(value, rounded);
  return exact - rounded;
}

void StreamScaler::ScaleSet(const Phrase& phrase) {
  if (RowOf(phrase.op).values == 2)
    short_[kAxisZ] = short_z0_ + (phrase.after->tool_down ? short_z1_ : short_z2_);
  const bool relative = IsRelative(phrase);
  for (std::size_t i = 0; i < phrase.values.size(); ++i) {
    const Phrase::Value& value = phrase.values[i];
    const auto axis = AxisOf(value, i);
    if (!axis) continue;  // degrees
    // What stays in one axis goes on staying there: nothing is made good across the motion.
    if (relative && value.number.decimal == 0.0) continue;
    const double exact = value.number.decimal * factor_;
    const double base = *axis == kAxisZ ? short_z0_ : 0.0;
    short_[*axis] = relative ? Replace(value, exact + short_[*axis]) : Replace(value, exact) + base;
  }
}

void StreamScaler::ScaleFixed(const Phrase& phrase) {
  const bool given = !phrase.values.empty();
  const double first =
      given ? static_cast<double>(phrase.values[0].number.truncated()) * factor_ : 0.0;
  switch (phrase.op) {
    case Op::kAt:
    case Op::kPZ:
      short_z1_ = given ? Replace(phrase.values[0], first) : 0.0;
      if (!given) short_z2_ = 0.0;
      if (phrase.values.size() > 1) {
        short_z2_ = Replace(phrase.values[1],
                            static_cast<double>(phrase.values[1].number.truncated()) * factor_);
      }
      break;
    case Op::kZM:
      if (given)
        short_[kAxisZ] =
            Replace(phrase.values[0], first + (IsRelative(phrase) ? short_[kAxisZ] : 0.0));
      break;
    case Op::kZO:
      if (!given) {
        short_z0_ = 0.0;
      } else {
        short_z0_ = Replace(phrase.values[0], first + (IsRelative(phrase) ? short_[kAxisZ] : 0.0));
      }
      break;
    case Op::kIN:
    case Op::kDF:
      short_z1_ = short_z2_ = 0.0;
      if (phrase.op == Op::kIN) short_ = {0.0, 0.0, short_z0_};
      break;
    case Op::kH:
      short_ = {};
      break;
    default:
      break;
  }
}

}  // namespace rmlcell::rml1
