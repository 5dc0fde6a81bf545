#include "engine/optimo/machine/machine_state.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/core/number_text.h"
#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {
namespace {

// First bytes of a saved state, then its version.
constexpr std::string_view kMagic{"OPTSTATE"};
constexpr std::uint8_t kVersion = 2;  // 1: without the counted program, BREAK and SIMUL

// Numbers are written least significant byte first, the same on every platform.
class Writer {
 public:
  void Byte(std::uint8_t value) { bytes_ += static_cast<char>(value); }
  template <class T>
  void Number(T value) {
    using Raw = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    const auto raw = std::bit_cast<Raw>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) Byte(static_cast<std::uint8_t>(raw >> (8 * i)));
  }
  template <class Array>
  void All(const Array& values) {
    for (const auto& value : values) Number(value);
  }
  void All(const Bits& values) {
    for (const bool value : values) Byte(value ? 1 : 0);
  }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_ = std::string(kMagic) + static_cast<char>(kVersion);
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  std::uint8_t Byte() {
    if (rest_.empty()) {
      good_ = false;
      return 0;
    }
    const auto value = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return value;
  }
  template <class T>
  void Number(T& value) {
    using Raw = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    Raw raw = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) raw |= static_cast<Raw>(Byte()) << (8 * i);
    value = std::bit_cast<T>(raw);
    if constexpr (std::is_floating_point_v<T>) {
      if (value != value) good_ = false;  // a machine never stands at "not a number"
    }
  }
  template <class Array>
  void All(Array& values) {
    for (auto& value : values) Number(value);
  }
  void All(Bits& values) {
    for (bool& value : values) value = Byte() != 0;
  }
  bool good() const { return good_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool good_ = true;
};

// One list of members for both directions.
template <class Archive, class State>
void Visit(Archive& archive, State& state) {
  auto& data = state.data;
  archive.All(data.vr);
  archive.All(data.vi);
  archive.All(data.vl);
  archive.All(data.il);
  archive.All(data.ol);
  archive.All(data.ia);
  archive.All(data.oa);
  archive.All(data.il_physical);
  archive.All(data.ia_physical);
  archive.All(state.outputs.logical);
  archive.All(state.outputs.analogue);
  archive.Number(state.axes.column.x());
  archive.Number(state.axes.column.y());
  archive.Number(state.axes.column.z());
  archive.Number(state.axes.a_rad);
  archive.Number(state.axes.b_rad);
  archive.Number(state.tool.offset.x_mm);
  archive.Number(state.tool.offset.y_mm);
  archive.Number(state.tool.offset.z_mm);
  archive.All(state.tool.reference);
  archive.All(state.work_offset.values);
  archive.Number(state.outputs.schedule);
  archive.Number(state.outputs.table_deg);
}

void WriteStep(Writer& writer, const std::optional<machine::ProgramStep>& step) {
  const machine::ProgramStep written = step.value_or(machine::ProgramStep{});
  writer.Number(written.program);
  writer.Number(written.step);
}

std::optional<machine::ProgramStep> ReadStep(Reader& reader) {
  machine::ProgramStep step;
  reader.Number(step.program);
  reader.Number(step.step);
  if (step.program == 0) return std::nullopt;
  return step;
}

}  // namespace

MachineState NewMachine(const OptimoParameters& parameters) {
  MachineState state;
  state.axes = parameters.home;
  return state;
}

std::string EncodeMachineState(const MachineState& state) {
  Writer writer;
  Visit(writer, state);
  writer.Byte(static_cast<std::uint8_t>((state.work_offset.active ? 1 : 0) |
                                        (state.zeroed ? 2 : 0) | (state.door_open ? 4 : 0)));
  writer.Number(state.selected);
  WriteStep(writer, state.breakpoint);
  WriteStep(writer, state.simul);
  return writer.Take();
}

Result<MachineState> DecodeMachineState(std::string_view bytes) {
  Reader reader(bytes.substr(std::min(bytes.size(), kMagic.size())));
  const std::uint8_t version = reader.Byte();
  if (!bytes.starts_with(kMagic) || version < 1 || version > kVersion) {
    return Error{
        ErrorCode::kCellBadText, "these bytes are no state of an Optimo of this version", {}};
  }
  MachineState state;
  Visit(reader, state);
  const std::uint8_t flags = reader.Byte();
  state.work_offset.active = (flags & 1) != 0;
  state.zeroed = (flags & 2) != 0;
  state.door_open = (flags & 4) != 0;
  if (version >= 2) {
    reader.Number(state.selected);
    state.breakpoint = ReadStep(reader);
    state.simul = ReadStep(reader);
  }
  if (!reader.good())
    return Error{ErrorCode::kCellBadText, "the state of the machine is damaged", {}};
  return state;
}

namespace {

std::string RealText(float value) {
  std::string text;
  PrintReal(value, text);
  return text;
}

}  // namespace

std::optional<Variable> VariableNamed(std::string_view name) {
  const std::size_t open = name.find('[');
  if (open == std::string_view::npos || !name.ends_with(']')) return std::nullopt;
  const auto number = ParseInteger(name.substr(open + 1, name.size() - open - 2));
  if (!number || *number < 0 || *number > kVariableIndexMax) return std::nullopt;
  const auto group = name.substr(0, open);
  const auto is = [&](std::string_view word) {
    return group.size() == 2 && (group[0] & ~0x20) == word[0] && (group[1] & ~0x20) == word[1];
  };
  using enum VariableGroup;
  for (const VariableGroup one : {kVr, kVi, kVl, kIl, kOl, kIa, kOa}) {
    if (is(GroupName(one)))
      return Variable{.group = one, .index = static_cast<std::uint8_t>(*number)};
  }
  return std::nullopt;
}

machine::MachineOutputs OutputsOf(const Outputs& outputs) {
  machine::MachineOutputs made{.laser_schedule = outputs.schedule};
  const auto add = [&made](std::string name, double value) {
    if (value != 0.0) made.on.push_back({.name = std::move(name), .value = value});
  };
  const auto add_all = [&add](const std::string& bank, const auto& values) {
    int n = 0;
    for (const auto value : values) {
      if (value != 0) add(bank + "[" + std::to_string(n) + "]", static_cast<double>(value));
      ++n;
    }
  };
  add_all("OL", outputs.logical);
  add_all("OA", outputs.analogue);
  add("rotary_table", outputs.table_deg);
  return made;
}

std::optional<machine::VariableValue> ReadByName(const DataArea& data, std::string_view name) {
  const std::optional<Variable> variable = VariableNamed(name);
  if (!variable) return std::nullopt;
  const std::size_t n = variable->index;
  const auto real = [](float value) {
    return machine::VariableValue{machine::VariableKind::kReal, RealText(value)};
  };
  const auto logical = [](bool value) {
    return machine::VariableValue{machine::VariableKind::kLogical, value ? "1" : "0"};
  };
  switch (variable->group) {
    case VariableGroup::kVr:
      return real(data.vr[n]);
    case VariableGroup::kVi:
      return machine::VariableValue{machine::VariableKind::kInteger,
                                    std::to_string(static_cast<int>(data.vi[n]))};
    case VariableGroup::kVl:
      return logical(data.vl[n]);
    case VariableGroup::kIl:
      return logical(data.il[n]);
    case VariableGroup::kOl:
      return logical(data.ol[n]);
    case VariableGroup::kIa:
      return real(data.ia[n]);
    case VariableGroup::kOa:
      return real(data.oa[n]);
    case VariableGroup::kPar:
      break;
  }
  return std::nullopt;
}

Result<float> Writable(Variable variable, double value, const OptimoParameters& parameters) {
  const auto refuse = [&](std::string_view why) {
    return Error{ErrorCode::kCellInvalidArgument, ToldVariable(variable) + " " + why, {}};
  };
  if (variable.group == VariableGroup::kIl || variable.group == VariableGroup::kIa)
    return refuse("is an input: set the input, not its image");
  if (IsReadOnly(variable)) return refuse("is written by the machine alone");
  const bool whole = value == std::trunc(value);
  switch (TypeOf(variable.group)) {
    case ValueType::kInteger:
      if (!whole || value < kIntegerMin || value > kIntegerMax)
        return refuse("holds whole numbers from -32768 to 32767");
      return static_cast<float>(value);
    case ValueType::kLogical:
      if (value != 0.0 && value != 1.0) return refuse("is 0 or 1");
      if (variable.group == VariableGroup::kOl && variable.index == kGas3 && value != 0.0 &&
          parameters.gas_channels < 3) {
        return Error{ErrorCode::kGas3NotFitted, {}, {}};
      }
      return static_cast<float>(value);
    case ValueType::kReal:
      if (!(std::abs(value) <= kRealMax)) return refuse("holds numbers up to 2^63");  // OPT-7.62
      return std::abs(value) < kRealMin ? 0.0F : static_cast<float>(value);
  }
  return 0.0F;
}

}  // namespace rmlcell::optimo
