#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rmlcell {

// Every error, alarm and warning has one number, kept as the manuals print it (optimo.md section C,
// rml1.md sections 4 and 6). Our own: 7000-7999 Optimo, 8000-8999 RML-1 advice, 9000-9999 the cell.
enum class ErrorFamily {
  kOptimo,
  kRml1,
  kCell,
  kFirstOfTables,  // and up: of tables that machine families bring
};

// What the machine does about it; optimo.md section C explains each.
enum class Severity {
  kAdvice,   // reported only; style of a program
  kWarning,  // reported with place and step; changes nothing
  kCompile,  // the program is not stored
  kProgram,  // the failing instruction has no effect; ERR may catch it
  kFatal,    // as kProgram, but ERR is not used
  kAlarm,    // as kFatal, and the machine stays in alarm
  kMessage,  // shown to the operator; the request has no effect
  kTool,     // an off-line tool stops and writes nothing
  kBudget,   // the run is ended by the cell
  kDevice,   // RML-1: noted in a register, interpretation goes on
  kRequest,  // the cell refuses a request and nothing changes
};

// Which sort of refusal a code is to a caller who may try again.
enum class Refusal {
  kInvalid,        // the program or request is wrong in itself
  kNotFound,       // what it names is not there
  kAlreadyExists,  // it is there already
  kConflict,       // somebody else was first
  kPermission,
  kUnauthenticated,
  kUnimplemented,
  kPrecondition,  // not in the present state
  kExhausted,     // a bound of the machine or the cell is reached
  kGone,          // it was there
  kUnavailable,   // not now
  kInternal,
  kDataLoss,
};

enum class ErrorCode {
#define RMLCELL_ERROR(family, number, symbol, ...) k##symbol,
#include "engine/core/catalogue.def"
#undef RMLCELL_ERROR
};

struct CatalogueEntry {
  ErrorCode code;
  ErrorFamily family;
  int number;
  std::string_view symbol;  // "HoleRadiusZero"
  Severity severity;
  std::string_view when;    // what happened, a phrase
  std::string_view advice;  // what the operator or programmer can do
  Refusal refusal = Refusal::kInvalid;
};

// All rows, in the order of engine/core/catalogue.def.
std::span<const CatalogueEntry> Catalogue();

// The codes of a machine family that stand in its own folder: constexpr int kTable =
// OwnErrorTable("PLT"). Row n has the code OwnError(kTable, n) and the family
// OwnErrorFamily(kTable).
struct ErrorTable {
  std::string_view prefix;  // "PLT", as OwnErrorTable takes it
  std::span<const CatalogueEntry> rows;
};
inline constexpr int kOwnErrorFirst = 100'000;
inline constexpr int kOwnErrorsMax = 1000;  // of one table

// The number of the table with this prefix, 1 to 4 letters A to Z. It is made of the letters, so
// that no list has to agree with it.
consteval int OwnErrorTable(std::string_view prefix) {
  if (prefix.empty() || prefix.size() > 4) throw "a prefix has 1 to 4 letters";
  int table = 0;
  for (const char c : prefix) {
    if (c < 'A' || c > 'Z') throw "a prefix has letters A to Z";
    table = table * 27 + (c - 'A' + 1);
  }
  return table;
}
constexpr ErrorCode OwnError(int table, int row) {
  return static_cast<ErrorCode>(kOwnErrorFirst + table * kOwnErrorsMax + row);
}
constexpr ErrorFamily OwnErrorFamily(int table) {
  return static_cast<ErrorFamily>(static_cast<int>(ErrorFamily::kFirstOfTables) + table);
}

// In any order, none empty. The registry of families defines this (engine/families/registry.cc); a
// program that is linked without it has none.
std::span<const ErrorTable> OwnErrorTables();

const CatalogueEntry& Lookup(ErrorCode code);

// The row with this number, or nothing. Numbers of different families may be equal: RML1-E10.
std::optional<ErrorCode> FindError(ErrorFamily family, int number);

std::string_view FamilyPrefix(ErrorFamily family);  // "OPT", "RML1", "CELL"
std::string_view SeverityName(Severity severity);   // "warning"

// What the machine does on an error of this severity, one sentence.
std::string_view SeverityEffect(Severity severity);

std::string CodeText(ErrorCode code);  // "OPT-E348"

// The symbol as a constant of the API: "HOLE_RADIUS_ZERO", "GAS_3_NOT_FITTED".
std::string ConstantName(ErrorCode code);

// The rows that a person may mean by "OPT-E348", "rml1-e2", "348", "HoleRadiusZero" or
// "HOLE_RADIUS_ZERO", in the order of the catalogue; empty when there is none. A bare number may
// name rows of several families.
std::vector<const CatalogueEntry*> FindByText(std::string_view text);

}  // namespace rmlcell
