#pragma once

#include <bitset>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/optimo/language/ast.h"
#include "engine/optimo/language/findings.h"

// Source text to tree. The text is never changed and must outlive what points into it.
namespace rmlcell::optimo {

// Where the text of an instruction stands, without its sequence number; parallel to
// Module::instructions.
struct Statement {
  std::uint32_t begin = 0;  // byte offset of its first token
  std::uint32_t end = 0;    // behind its last token
  std::uint32_t tokens = 0;
};
// Where a literal or name stands, a literal with its sign: all of "-(4.)". Operators have the place
// of their sign.
struct NodePlace {
  std::uint32_t offset = 0;
  std::uint32_t length = 0;
};
struct Comment {
  std::uint32_t begin = 0;  // the ';'
  std::uint32_t end = 0;    // behind the last byte, without line end
};

// Which places are kept. Those of nodes are a third of a program's memory, and a compiler needs
// them only where there is something to report: then the statement is read again.
enum class Places : std::uint8_t {
  kStatements,
  kNodes,  // of every node, too: for tools that rewrite the text
};

// A module with its places. Names are not resolved; a statement that cannot be parsed is
// Op::kInvalid.
struct ParsedProgram {
  std::string_view text;  // up to the end of text (1Ah, OPT-1.03)
  Module module;
  std::vector<Statement> statements;
  std::vector<NodePlace> node_places;   // parallel to Module::nodes; empty with Places::kStatements
  std::vector<NodePlace> label_places;  // parallel to Module::labels
  std::vector<NodePlace> end_label_places;  // parallel to Module::end_labels
  std::vector<Comment> comments;
  std::vector<bool> broken_names;  // parallel to Module::names: its DECLARE has an error
  std::bitset<kParameterCount> broken_parameters;  // the same of DEFINE
  // Instructions with an error that are no Op::kInvalid, in any order, some of them twice.
  std::vector<std::uint32_t> faulty;
  std::vector<std::uint32_t> mislabelled;  // ascending: the sequence number on its line is refused
  std::uint64_t tokens_read = 0;           // those read twice counted twice: what the reading cost

  Place At(const Instruction& instruction) const;  // the whole statement
  std::string_view TextOf(const Instruction& instruction) const;

  // Where the nodes of the instruction stand, from Module::FirstNode on. Takes as long as reading
  // its statement when the places were not kept.
  std::vector<NodePlace> NodePlacesOf(const Instruction& instruction) const;
};

// A text longer than this is refused (offsets have 32 bits); design.md: programs of up to 256 MiB.
inline constexpr std::size_t kSourceBytesMax = std::size_t{1} << 30;
// Parentheses and signs inside each other; deeper is an error and not a deep call stack.
inline constexpr int kNestingMax = 200;

// Reports every syntax error, one per statement, and goes on with the next statement. Linear in the
// text. Errors reported: 7001 to 7006, 7017, 7019 to 7022, 7025, 7027 and those that need no names.
ParsedProgram Parse(std::string_view text, Findings& findings, Places places = Places::kNodes);

}  // namespace rmlcell::optimo
