#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// What a key of the handbox asks for: fields to be filled in, a line of the display at a time.
// OPT-5.01, OPT-5.07, OPT-5.08
namespace rmlcell::optimo {

// How a number is shown. OPT-B.76
enum class Decimals { kOne, kUpToThree, kIfAny };

// One field, with the words before it.
class Field {
 public:
  // With decimal point: what stands there is cleared before another value is typed. OPT-5.07
  static Field Real(std::string before, double value, double low, double high,
                    Decimals decimals = Decimals::kOne);
  // So many digits, which come in at the right and go out at the left. OPT-5.08
  static Field Whole(std::string before, int digits, int value, int low, int high);
  // To be looked at alone.
  static Field Shown(std::string text);
  // One of these words, chosen with PREV and NEXT.
  static Field Choice(std::string before, std::vector<std::string> words, std::size_t chosen);

  bool is_choice() const { return !words_.empty(); }
  void Choose(bool next);
  void Clear();          // DEL
  void Type(char c);     // a digit, '.' or '-'
  bool InRange() const;  // OPT-5.10
  double value() const;  // precondition: InRange
  int whole() const { return static_cast<int>(value()); }
  std::size_t chosen() const { return chosen_; }
  std::string text() const { return before_ + (is_choice() ? words_[chosen_] : digits_); }

 private:
  std::string before_;
  std::string digits_;
  double given_ = 0.0;  // what a real field held when it was opened: more than it shows
  bool fixed_ = false;  // it is only shown
  bool typed_ = false;  // it was cleared since
  int width_ = 0;       // of a whole field
  double low_ = 0.0;
  double high_ = 0.0;
  std::vector<std::string> words_;
  std::size_t chosen_ = 0;
};

enum class FormKind {
  kJob,
  kMove,      // SPEED and what a MOVE has besides
  kInput,     // of START
  kEndInput,  // of END
  kTime,
  kTimeLabel,
  kOversh,
  kDelay,
  kCoord,
  kPath,
  kRadius,
  kTool,
  kProcess,
  kWork,
  kWorkdef,
  kWorkOn,
  kWorkInput,
  kOutput,
  kLink,
  kLinkProgram,
  kBreak,
  kBreakStep,
  kSimul,
  kFunction,
  kFunctionCount,
  kFunctionValues,
  kSysdef,
  kSysdefValues,
  kGosub,
  kParameters,  // of the machine, to be looked at
};

class Form {
 public:
  using Line = std::vector<Field>;
  Form(FormKind kind, std::vector<Line> lines) : kind_(kind), lines_(std::move(lines)) {}
  // Each field in a line of its own.
  static Form OfLines(FormKind kind, std::vector<Field> fields);
  // "X0 = 0.0" for each of the names; values that are not there are 0.
  static Form OfNumbers(FormKind kind, std::span<const std::string_view> names,
                        const std::vector<double>& values);

  FormKind kind() const { return kind_; }
  void Move(bool next);  // NEXT and PREV: to another word, field or line; it stays at the ends
  void Clear() { field().Clear(); }
  void Type(char c) { field().Type(c); }
  // False: a value is out of its range, and is shown.
  bool Check();
  // Of the field with this number, over all lines.
  const Field& at(std::size_t number) const;
  std::size_t count() const;
  std::string text() const;

 private:
  Field& field() { return lines_[line_][field_]; }

  FormKind kind_;
  std::vector<Line> lines_;
  std::size_t line_ = 0;
  std::size_t field_ = 0;
};

}  // namespace rmlcell::optimo
