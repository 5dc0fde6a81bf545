#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/core/diagnostic.h"

// What an editor asks about a program text while it is being written. A family whose programs
// people write has it (MachineFamily::editing), one with streams has none. Nothing is run or
// changed here, and nothing fails: half a line is a text, too.
namespace rmlcell::machine {

// Bytes of a text; `end` is behind the last one.
struct TextSpan {
  std::size_t begin = 0;
  std::size_t end = 0;

  bool operator==(const TextSpan&) const = default;
};

// A source whose name is a program number: "44.S".
struct NumberedFile {
  int number = 0;
  std::string uri{};
  std::string name{};  // "44.S"

  bool operator==(const NumberedFile&) const = default;
};
struct NumberedSource {
  std::string uri{};
  std::string name{};  // "44.S"
  std::string text{};
};

// What lies around the program: the sources of its folder as they stand in the editor or else on
// the disk, and what its project says. Empty where there is nothing.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  virtual const std::string& uri() const = 0;  // of the program itself
  // By number; of several with one number the one first that is taken for the program.
  virtual std::vector<NumberedFile> Programs() const = 0;
  virtual std::optional<NumberedSource> Read(const NumberedFile& file) const = 0;
  // "PULSE, 50 %, fine cut".
  virtual std::string ScheduleNote(int number) const = 0;
  // "8, 75, 0.5, 60 (steel, 2 mm)".
  virtual std::string ProcessNote(int kind, int process) const = 0;
};

struct HoverNote {
  std::string text{};  // Markdown
  TextSpan of{};
};

struct PlacesInFile {
  NumberedSource file{};
  std::vector<TextSpan> spans{};
};
struct Places {
  std::vector<TextSpan> here{};  // in the program itself
  std::vector<PlacesInFile> elsewhere{};
};

struct Highlight {
  TextSpan span{};
  bool defines = false;
};

// What could stand at a place.
struct Suggestion {
  enum class Kind { kWord, kFunction, kVariable, kConstant, kSequenceNumber, kProgram };
  Kind kind = Kind::kWord;
  std::string label{};   // what is written
  std::string detail{};  // one line; may be empty
  std::string text{};    // Markdown; may be empty
};
struct Suggestions {
  TextSpan typed{};  // what they replace
  std::vector<Suggestion> list{};
  bool cut = false;  // there are more: typing on finds them
};

// A part of a program as an outline shows it.
struct OutlinePart {
  enum class Kind { kVariable, kConstant, kSequenceNumber, kSubroutine, kStep };
  Kind kind = Kind::kStep;
  std::string name{};
  std::string detail{};  // may be empty
  TextSpan whole{};
  TextSpan name_at{};
  std::vector<OutlinePart> parts{};
};

// Lines, from 0, that an editor may fold away: all but the first.
struct FoldedLines {
  enum class Kind { kStatements, kComment, kRegion };
  Kind kind = Kind::kStatements;
  std::size_t first = 0;
  std::size_t last = 0;
};

// Why something cannot be renamed, for the programmer.
struct Refusal {
  std::string why{};
};

// One state of a text, looked through once; made anew when the text changes. `offset` is a byte of
// the text or its end.
class EditedProgram {
 public:
  virtual ~EditedProgram() = default;

  // Nothing where nothing of meaning stands.
  virtual std::optional<HoverNote> Hover(std::size_t offset, const Surroundings& around) const = 0;
  // Where that which stands here is defined, and where it is used.
  virtual Places Definition(std::size_t offset, const Surroundings& around) const = 0;
  virtual Places References(std::size_t offset, bool with_definition,
                            const Surroundings& around) const = 0;
  virtual std::vector<Highlight> Highlights(std::size_t offset) const = 0;
  virtual Suggestions Complete(std::size_t offset, const Surroundings& around) const = 0;
  // What can be renamed here, and everywhere that it is written. A new name is refused unless the
  // program stays the same.
  virtual std::variant<TextSpan, Refusal> Renamable(std::size_t offset) const = 0;
  virtual std::variant<std::vector<TextSpan>, Refusal> Rename(std::size_t offset,
                                                              const std::string& name) const = 0;
  virtual std::vector<OutlinePart> Outline() const = 0;
  virtual std::vector<FoldedLines> Folds() const = 0;
};

// Stateless; every method may be called from several threads at once.
class Editing {
 public:
  virtual ~Editing() = default;
  // Of sources, in the order in which one is taken for a program number, upper case: ".S" ...
  virtual std::span<const std::string_view> source_extensions() const = 0;
  // `text` must outlive what is made, and not change.
  virtual std::unique_ptr<EditedProgram> Look(std::string_view text) const = 0;
  // Whether a finding says that what it marks is never reached.
  virtual bool IsNeverReached(const Diagnostic& finding) const = 0;
  // A rule of the family that findings name, in a sentence; empty when it is not known.
  virtual std::string_view TextOfRule(std::string_view rule) const = 0;
  // The change that makes the checker pass over a finding from now on; nothing when it must not, or
  // when there is no room for it.
  virtual std::optional<Fix> Allow(std::string_view text, const Diagnostic& finding) const = 0;
};

}  // namespace rmlcell::machine
