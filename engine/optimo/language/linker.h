#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/optimo/language/ast.h"

// The second pass: an executable is the main program with the FUNCTION programs that it needs
// (optimo.md 9.1).
namespace rmlcell::optimo {

inline constexpr int kFunctionsMax = 32;                           // OPT-9.05
inline constexpr std::uint32_t kExecutableLimitStandard = 32'768;  // OPT-9.10: must stay below
inline constexpr int kRotaryTableFunction = 99;                    // OPT-9.19

struct LinkedModule {
  int slot = 0;
  std::uint64_t object_hash = 0;  // of the object that it was made from (OPT-1.13)
  Module module;                  // functions: every ENDTASK is a RETURN (OPT-9.02)
};

struct Executable {
  std::vector<LinkedModule> modules;  // main first, functions in order of first use

  // The module of a FUNCTION program, or nothing.
  const LinkedModule* Find(int slot) const;
};

struct LinkOptions {
  std::uint32_t executable_limit = kExecutableLimitStandard;
  bool rotary_table = false;  // FUNCTION 99 is built into the control
};

// Object bytes of a slot 1..99; nothing when it is empty. The view must stay valid during Link.
using ObjectLookup = std::function<std::optional<std::string_view>(int slot)>;

// Errors: ProgramMissing 7102 (no main), ObjectCorrupt 7034, FunctionMissing 7103, FunctionIsMain
// 7104, TooManyFunctions 7105, ExecutableTooLong 7106, FunctionEntry 7108.
Result<Executable> Link(int main_slot, const ObjectLookup& lookup, const LinkOptions& options);

// Whether all is there that a run of the program can come to, where CALL and GO name a program by
// its number and not by a computed one. `executable_of` is asked once for each. Errors: its own.
Status CheckCalls(int main_slot, const std::function<Result<Executable>(int slot)>& executable_of);

// Bytes of the size model, OPT-B.72.
std::uint32_t ExecutableSize(const Executable& executable);

std::string EncodeExecutable(const Executable& executable);
// Errors: ObjectCorrupt.
Result<Executable> DecodeExecutable(std::string_view bytes);

// 64-bit FNV-1a of object bytes; tells whether an executable was made from them.
std::uint64_t HashObject(std::string_view object);

}  // namespace rmlcell::optimo
