// A program of the Optimo carried out by its run, with nobody who listens: optimo_instructions.py
// counts its instructions, optimo_run.cc beside it takes its time.
//   optimo_count loop|call|moves ROUNDS
// loop: seven operations a round. call: a FUNCTION with two arguments that makes one move. moves:
// the same moves by the same expressions, without the call.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/bench/optimo_programs.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: optimo_count loop|call|moves ROUNDS\n");
    return 2;
  }
  const int rounds = std::atoi(argv[2]);
  rmlcell::bench::OptimoProgram program(argv[1], rounds);
  const bool over = program.RunToEnd();
  std::printf("%llu steps\n", static_cast<unsigned long long>(program.steps()));
  return over ? 0 : 1;
}
