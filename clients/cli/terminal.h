#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// What the command shows to people: colour on a terminal, tables, a progress bar. Data goes to
// standard output, everything about it to standard error.
namespace rmlcell::cli {

// Exit codes (design.md section 7).
enum Exit : int { kGood = 0, kProgramErrors = 1, kUsage = 2, kConnection = 3 };

// True when standard output (or error) is a terminal and NO_COLOR is not set.
bool ColourOnOutput();
bool ColourOnErrors();

enum class Colour { kPlain, kRed, kYellow, kGreen, kBlue, kDim, kBold };
std::string Paint(std::string_view text, Colour colour, bool on);

void Print(std::string_view text);  // to standard output, with a line end
// Foreign text on one line: bytes that would steer a terminal are shown as \xNN.
std::string Visible(std::string_view text);

void PrintRaw(std::string_view text);  // to standard output, as it is
void Complain(std::string_view text);  // to standard error, "rmlcell: ..."

// Characters in a line of standard output; 0: it is no terminal, and a line may be of any length.
std::size_t OutputWidth();

// Columns as wide as they need to be, cells of more than 60 characters cut; numbers are not aligned
// specially. The first row is the heading. Where lines would be longer than `width`, the column
// "TITLE" is cut, to 8 characters at least; 0: lines may be of any length.
std::string Table(std::vector<std::vector<std::string>> rows, std::size_t width = OutputWidth());

// One line on standard error that is drawn over; draws nothing when standard error is no terminal.
class ProgressLine {
 public:
  ~ProgressLine();
  // `share` 0..1; below 0: not known, a moving mark is shown.
  void Show(double share, std::string_view text);
  void Clear();
  // Shows it once more and goes on below.
  void Leave(double share, std::string_view text);

 private:
  bool shown_ = false;
  unsigned turn_ = 0;
};

std::string Fixed(double value, int decimals);
std::string Duration(double seconds);   // "1 h 2 min 3.400 s"
std::string Bytes(std::int64_t bytes);  // "1.2 MB"

}  // namespace rmlcell::cli
