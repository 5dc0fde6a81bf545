#!/usr/bin/env python3
"""A source with switches does what the source does, and with one change awake what the changed source does."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from places import Finder  # noqa: E402
from switched_source import SwitchedSource  # noqa: E402
from switched_tree import NUMBERS_MAX, ROOM, SwitchedTree  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]

# One line of output for each statement; no place stands in a constant expression.
SOURCE = """#include <cstdio>
#include <string>
namespace rmlcell {
enum class ErrorCode { kBelow, kFar };
int Take(int from, int what) { return 10 * from - what; }
void Show(int value) { std::puts(std::to_string(value).c_str()); }
int Run(int a, int b, double length) {
  int sum = a + 2 * b - 3;
  if (a < b && !(length > 4.0) || sum == 12) sum += Take(a, b);
  for (int k = 0; k <= b && k > -9; ++k) {
    if (k >= 6 && sum != 5) break;
    sum -= k < a ? -k : k;
  }
  Show(sum);
  int at = b;
  Show(Take(at -= 1, 1) - Take(at -= 2, 1) + (Take(at += a, 0) < Take(at -= 3, 0)));
  const std::string text = "at " + std::to_string(sum + a);
  Show(static_cast<int>(text.size()) + Take(Take(1, a), b - 1));
  const ErrorCode code = length < 3.0 ? ErrorCode::kBelow : ErrorCode::kFar;
  Show(code == ErrorCode::kBelow);
  return b-- > 3 || a > 1 ? b : -1;
}
}
int main() {
  rmlcell::Show(rmlcell::Run(2, 7, 4.0));
  rmlcell::Show(rmlcell::Run(5, 3, 2.5));
}
"""


def all_of(sources):
    """One program of them all, which runs the one that its argument names: the headers are read but once."""
    head, calls, parts = "#include <cstdlib>\n#include <cstdio>\n#include <string>\n", "", ""
    for number, source in enumerate(sources):
        body = source[source.index("namespace rmlcell"):]
        parts += body.replace("rmlcell", f"one{number}").replace("int main()", f"void Main{number}()")
        calls += f"  if (which == {number}) Main{number}();\n"
    return head + parts + "int main(int, char** words) {\n  const int which = std::atoi(words[1]);\n" + calls + "}\n"


class SwitchedSourceTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def program(self, source, name):
        (self.folder / f"{name}.cc").write_text(source, encoding="utf-8")
        made = self.folder / name
        done = subprocess.run(["g++", "-std=c++20", "-w", "-I", str(ROOT), "-o", str(made), f"{made}.cc"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return made

    @staticmethod
    def output(program, *words, **environment):
        return subprocess.run([str(program), *words], capture_output=True, text=True, env=environment, timeout=20,
                              check=False).stdout

    def switched(self):
        places = Finder("run.cc", SOURCE).find(["kBelow", "kFar"])
        numbers = {place: n + 1 for n, place in enumerate(places)}
        source = SwitchedSource(SOURCE, numbers)
        # main stands outside the namespace of the changes.
        return numbers, source, self.program(
            '#include "tests/mutation/changes.h"\nnamespace changes = rmlcell::changes;\n' + source.text, "switched")

    def test_every_change_is_the_one_that_is_made_in_the_source(self):
        numbers, source, switched = self.switched()
        self.assertEqual(self.output(switched), self.output(self.program(SOURCE, "plain")))
        self.assertEqual(source.switched, set(numbers.values()))
        # Text has no minus: a change that is no C++ does nothing.
        tried = {place: number for place, number in numbers.items() if '"at "' not in place.text or place.kind != "sign"}
        self.assertEqual({place.kind for place in tried}, {"comparison", "bound", "sign", "constant",
                                                           "dropped statement", "exchanged argument", "error code"})
        changed = self.program(all_of([place.applied(SOURCE) for place in tried]), "changed")
        for which, (place, number) in enumerate(tried.items()):
            with self.subTest(change=f"{place.line}: {place.before} => {place.after}"):
                self.assertEqual(self.output(switched, MUTATION_CHANGE=str(number)), self.output(changed, str(which)))

    def test_a_run_tells_what_it_came_by(self):
        numbers, _, switched = self.switched()
        reached = self.folder / "reached"
        self.output(switched, MUTATION_REACHED=str(reached))
        came_by = {n for n, byte in enumerate(reached.read_bytes()) if byte}
        self.assertLessEqual(came_by, set(numbers.values()))
        for place, number in numbers.items():
            if "sum += Take" in place.text:
                self.assertIn(number, came_by, place)


class NumbersTest(unittest.TestCase):
    def test_there_are_enough_for_all_sources(self):
        header = (ROOT / "tests/mutation/changes.h").read_text(encoding="utf-8")
        self.assertIn(f"kMost = 1U << {NUMBERS_MAX.bit_length() - 1};", header)
        with tempfile.TemporaryDirectory() as folder:
            tree = SwitchedTree(ROOT, folder, [])
        self.assertLess((len(tree.sources) + 1) * ROOM, NUMBERS_MAX)


if __name__ == "__main__":
    unittest.main()
