// motion_reference FILE.csv: computes every case of a table in the format of motion.md section 12
// and prints each one that differs beyond the tolerance, or whose input makes no sense. Exit code 0
// when there is none, 1 when there is one, 2 when the file cannot be read.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/conformance/motion_cases.h"

int main(int argc, char** argv) {
  using namespace rmlcell::motion;
  if (argc != 2) {
    std::fputs("usage: motion_reference FILE.csv\n", stderr);
    return 2;
  }
  std::ifstream file(argv[1], std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto cases = ReadReferenceCases(text);
  if (!file || !cases) {
    std::fprintf(stderr, "%s: %s\n", argv[1],
                 file ? cases.error().detail.c_str() : "cannot be read");
    return 2;
  }
  int agreed = 0;
  int differed = 0;
  for (const ReferenceCase& reference : *cases) {
    const ReferenceVerdict verdict = Judge(reference);
    if (verdict.kind == ReferenceVerdict::Kind::kAgrees) {
      ++agreed;
      continue;
    }
    ++differed;
    std::printf("%s (%s) %s\n", reference.name.c_str(), reference.group.c_str(),
                reference.text.c_str());
    for (const std::string& difference : verdict.differences)
      std::printf("  %s\n", difference.c_str());
  }
  std::printf("%d agree, %d differ\n", agreed, differed);
  return differed == 0 ? 0 : 1;
}
