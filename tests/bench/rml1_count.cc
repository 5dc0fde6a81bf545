// RML-1 of four forms (rml1_texts.h), and what is done with it: rml1_instructions.py counts it.
//   rml1_count FORM-STAGE MOVES
// text: it is written, and no more. read: by a device, to moves whose places are checked against
// the travel. check: by the family, with all that a check tells. run: in virtual time, with nobody
// to tell.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tests/bench/rml1_reading.h"
#include "tests/bench/rml1_texts.h"

namespace rmlcell::bench {
namespace {

int Main(std::string_view what, int moves) {
  const std::string_view form = what.substr(0, what.find('-'));
  const std::string_view stage = what.substr(std::min(form.size() + 1, what.size()));
  const Result<machine::Parameters> parameters = WideMachine();
  if (!parameters || !Rml1Walk::Knows(form)) return 2;
  const Result<rml1::Profile> profile = rml1::MakeProfile(*parameters);
  if (!profile) return 2;
  const std::string text = Rml1Walk(form).Text(moves);
  if (stage == "text") return text.empty() ? 1 : 0;
  if (stage == "read") return ReadPlaces(*profile, text).moves > 0 ? 0 : 1;
  if (stage == "check") return CheckText(*parameters, text) ? 0 : 1;
  return stage == "run" && RunText(*parameters, text) > 0.0 ? 0 : 1;
}

}  // namespace
}  // namespace rmlcell::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: rml1_count FORM-STAGE MOVES\n");
    return 2;
  }
  return rmlcell::bench::Main(argv[1], std::atoi(argv[2]));
}
