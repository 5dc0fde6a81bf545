#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"

namespace rmlcell::cli {

// Of many findings of one kind the first few are shown, and the others counted: nobody reads a
// thousand lines of one code.
class KindsShown {
 public:
  // Whether this one is to be shown. `line` 0: not known.
  bool Show(const std::string& code, int line);
  // "and 95 more RML1-E2, lines 12 to 300" for each kind that was cut, with line ends.
  std::string Rest() const;

 private:
  struct Kind {
    std::uint64_t shown = 0;
    std::uint64_t left_out = 0;
    int first_line = 0;
    int last_line = 0;
  };
  std::map<std::string, Kind> kinds_;
};

// ", lines 12 to 300", ", line 7"; empty where no line is known.
std::string ExtentText(int first_line, int last_line);

// Findings with the source line of each and a caret below it; `source` may be empty.
// To standard output: they are what was asked for.
void PrintFindings(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
                   std::string_view source);
// To standard error: something else was asked for.
void ComplainOf(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
                std::string_view source);

// Says why nothing is done, and gives the exit code of a wrong use or an unreadable file.
int Refuse(const Error& error);

}  // namespace rmlcell::cli
