#include "engine/optimo/language/linker.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/compiler.h"

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kExecutableMagic = "LMX";
constexpr unsigned kExecutableVersion = 1;

// Size model of OPT-B.72.
constexpr std::uint32_t kExecutableBytes = 16, kFunctionBytes = 8, kStepBytes = 4, kRealBytes = 5,
                        kIntegerBytes = 3, kVariableBytes = 2, kOperatorBytes = 1, kLabelBytes = 3;

std::uint32_t NodeBytes(const ExprNode& node) {
  switch (node.op) {
    case Node::kReal:
    case Node::kPi:
      return kRealBytes;
    case Node::kInteger:
      return kIntegerBytes;
    case Node::kVariable:
      return kVariableBytes;
    default:
      return kOperatorBytes;  // operators, functions, ON and OFF
  }
}

// Whole numbers of an instruction that are no expressions count as INTEGER literals.
std::uint32_t NumberBytes(const Instruction& i) {
  switch (i.op) {
    case Op::kWorkdef:
    case Op::kWork:
      return 2 * kIntegerBytes;
    case Op::kTask:
    case Op::kAssign:
    case Op::kDefine:
      return kIntegerBytes;
    case Op::kBreak:
    case Op::kSimul:
      return (i.numbers[1] != 0 ? 2 : 1) * kIntegerBytes;
    default:
      return 0;
  }
}

std::uint64_t ModuleBytes(const Module& module) {
  std::uint64_t bytes = kStepBytes;  // the end of the module
  for (const Instruction& i : module.instructions) {
    if (i.op == Op::kDeclare) continue;
    bytes += kStepBytes + NumberBytes(i) + i.target_count * kLabelBytes;
    for (unsigned rest = i.attributes; rest != 0; rest &= rest - 1) bytes += kOperatorBytes;
    for (std::uint32_t e = 0; e < module.ExpressionCount(i); ++e) {
      for (const ExprNode& node : module.expression(i.first_expression + e))
        bytes += NodeBytes(node);
    }
  }
  return bytes;
}

std::uint64_t SizeOf(const Executable& executable) {
  std::uint64_t bytes = kExecutableBytes;
  for (const LinkedModule& module : executable.modules) bytes += ModuleBytes(module.module);
  return bytes + kFunctionBytes * (executable.modules.size() - 1);
}

// A function names its entry with TASK 1, or has no TASK at all. OPT-9.11
bool HasEntry(const Module& module) {
  bool task = false;
  for (const Instruction& i : module.instructions) {
    if (i.op != Op::kTask) continue;
    if (i.numbers[0] == 1) return true;
    task = true;
  }
  return !task;
}

Error At(ErrorCode code, Detail detail) { return {code, std::move(detail), {}}; }

// Of CALL and GO with a number; what is computed nobody knows before.
std::vector<int> CalledSlots(const Module& module) {
  std::vector<int> slots;
  for (const Instruction& i : module.instructions) {
    if (i.op != Op::kCall && i.op != Op::kGo) continue;
    const Expression nodes = module.Value(i, 0);
    if (nodes.size() == 1 && nodes[0].op != Node::kVariable)
      slots.push_back(static_cast<int>(nodes[0].number));
  }
  return slots;
}

}  // namespace

const LinkedModule* Executable::Find(int slot) const {
  for (const LinkedModule& module : modules) {
    if (module.slot == slot) return &module;
  }
  return nullptr;
}

std::uint64_t HashObject(std::string_view object) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const char c : object) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
  return hash;
}

Result<Executable> Link(int main_slot, const ObjectLookup& lookup, const LinkOptions& options) {
  Executable executable;
  const std::optional<std::string_view> main_object = lookup(main_slot);
  if (!main_object)
    return At(ErrorCode::kProgramMissing,
              "program " + Told("program", main_slot) + " is not stored");
  Result<Module> main = DecodeObject(*main_object);
  if (!main) return main.error();
  executable.modules.push_back({main_slot, HashObject(*main_object), std::move(*main)});

  // Modules found on the way are appended and looked through in their turn: each once.
  for (std::size_t m = 0; m < executable.modules.size(); ++m) {
    const std::size_t count = executable.modules[m].module.instructions.size();
    for (std::size_t n = 0; n < count; ++n) {
      const Instruction& i = executable.modules[m].module.instructions[n];
      if (i.op != Op::kFunction) continue;
      const int slot = i.numbers[0];
      const auto function = [slot] { return "FUNCTION " + Told("function", slot); };
      const auto place = [&, step = i.step] {
        if (executable.modules[m].slot == kNoProgram) return function();  // given by hand
        return function() + " in program " + Told("program", executable.modules[m].slot) +
               ", step " + Told("step", step);
      };
      if (slot == kRotaryTableFunction && options.rotary_table) continue;
      if (slot == main_slot)
        return At(ErrorCode::kFunctionIsMain, place() + " is the main program");
      if (executable.Find(slot) != nullptr) continue;
      const std::optional<std::string_view> object = lookup(slot);
      if (!object) return At(ErrorCode::kFunctionMissing, "no object for " + place());
      if (executable.modules.size() > static_cast<std::size_t>(kFunctionsMax)) {
        return At(ErrorCode::kTooManyFunctions, place() + " is the 33rd function");
      }
      Result<Module> module = DecodeObject(*object);
      if (!module) return At(module.error().code, function() + ": " + module.error().detail);
      if (!HasEntry(*module))
        return At(ErrorCode::kFunctionEntry, function() + " has TASK, but no TASK 1");
      for (Instruction& other : module->instructions) {
        if (other.op == Op::kEndtask) other.op = Op::kReturn;
      }
      executable.modules.push_back({slot, HashObject(*object), std::move(*module)});
    }
  }
  const std::uint64_t size = SizeOf(executable);
  if (size >= options.executable_limit) {
    return At(ErrorCode::kExecutableTooLong, "the executable has " + ToldSize("bytes", size) +
                                                 " bytes; it must have fewer than " +
                                                 ToldSize("limit", options.executable_limit));
  }
  return executable;
}

Status CheckCalls(int main_slot, const std::function<Result<Executable>(int)>& executable_of) {
  std::set<int> known{main_slot};
  std::vector<int> to_look_at{main_slot};
  while (!to_look_at.empty()) {
    const int slot = to_look_at.back();
    to_look_at.pop_back();
    const Result<Executable> executable = executable_of(slot);
    if (!executable) return executable.error();
    for (const LinkedModule& module : executable->modules) {
      for (const int called : CalledSlots(module.module)) {
        if (known.insert(called).second) to_look_at.push_back(called);
      }
    }
  }
  return {};
}

std::uint32_t ExecutableSize(const Executable& executable) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(SizeOf(executable), 0xFFFF'FFFFU));
}

std::string EncodeExecutable(const Executable& executable) {
  ByteWriter out;
  out.Raw(kExecutableMagic);
  out.Byte(kExecutableVersion);
  out.Whole(executable.modules.size());
  for (const LinkedModule& module : executable.modules) {
    out.Byte(static_cast<unsigned>(module.slot));
    out.Fixed64(module.object_hash);
    out.Text(EncodeObject(module.module));
  }
  out.Fixed32(Checksum(out.bytes()));
  return out.Take();
}

Result<Executable> DecodeExecutable(std::string_view bytes) {
  constexpr std::size_t kHead = kExecutableMagic.size() + 1, kTail = 4;
  const Error corrupt = At(ErrorCode::kObjectCorrupt, "the executable is damaged");
  if (bytes.size() < kHead + kTail ||
      bytes.substr(0, kExecutableMagic.size()) != kExecutableMagic ||
      static_cast<unsigned char>(bytes[kExecutableMagic.size()]) != kExecutableVersion) {
    return corrupt;
  }
  const std::string_view body = bytes.substr(0, bytes.size() - kTail);
  if (ByteReader(bytes.substr(body.size())).Fixed32() != Checksum(body)) return corrupt;
  ByteReader in(body.substr(kHead));
  const std::uint64_t count = in.Whole(kFunctionsMax + 1);
  if (count == 0) return corrupt;
  Executable executable;
  for (std::uint64_t m = 0; m < count; ++m) {
    const int slot = static_cast<int>(in.Byte());
    const std::uint64_t hash = in.Fixed64();
    Result<Module> module = DecodeObject(in.Text(bytes.size()));
    if (in.bad() || !module || slot < 1 || slot > 99 || executable.Find(slot) != nullptr)
      return corrupt;
    executable.modules.push_back({slot, hash, std::move(*module)});
  }
  return in.AtEnd() ? Result<Executable>(std::move(executable)) : Result<Executable>(corrupt);
}

}  // namespace rmlcell::optimo
