#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/outcome.h"
#include "engine/machine/run_setup.h"

namespace rmlcell::machine {

// A program text or stream as it comes from a user.
struct SourceFile {
  std::string name{};  // decides units: .SI is inch
  std::string_view bytes{};
  const BytesKeeper* keeper = nullptr;  // of the bytes, where whoever reads may release them
  bool is_object = false;               // whatever the name says
};

// What the machine would store, and what there is to say about it.
struct Translation {
  bool ok = false;  // false: nothing may be stored
  std::string object{};
  // The machine keeps the bytes of the file as they came: `object` has no copy of them.
  bool as_it_came = false;
  std::vector<Diagnostic> diagnostics{};  // in order of place; at most kDiagnosticsMax
  UntoldFindings diagnostics_dropped{};   // those that had no room
  std::vector<Figure> figures{};          // "steps", "object_bytes" ...
  SourceNotes source{};                   // empty: not asked for, or none
};
inline constexpr std::size_t kDiagnosticsMax = 1000;

// What the machine keeps of a good translation of these bytes.
inline std::string ObjectOf(Translation translation, std::string_view bytes) {
  return translation.as_it_came ? std::string(bytes) : std::move(translation.object);
}

struct CheckOptions {
  bool advice = true;   // lint findings of severity warning and advice
  bool source = false;  // fill in Translation::source
  // The text is still being written: a source in units of its own is checked as it stands, with the
  // advice to convert it, and advice that depends on units is left out.
  bool unconverted = false;
  // Take what looks like no program of the family at all, too, where its machine would.
  bool forced = false;
};

}  // namespace rmlcell::machine
