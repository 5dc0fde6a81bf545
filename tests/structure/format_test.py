#!/usr/bin/env python3
"""Every C++ source stands as .clang-format has it, and no function grows beyond what can be read at once."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

import check_structure as structure
import function_lengths

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KNOWN = HERE / "long_functions.txt"  # lines, path, name; none may grow, and a row goes when it is no longer true
CLANG_FORMAT = shutil.which("clang-format")


def sources():
    return [path for path in structure.files_under(ROOT) if path.endswith((".cc", ".h"))]


def known_long_functions():
    rows = [line.split(maxsplit=2) for line in KNOWN.read_text(encoding="utf-8").splitlines() if line]
    return {(path, name): int(lines) for lines, path, name in rows}


class Format(unittest.TestCase):
    maxDiff = None

    @unittest.skipUnless(CLANG_FORMAT, "clang-format is not installed: deploy/setup.sh --tests")
    def test_sources_stand_as_the_style_has_them(self):
        files = sources()
        self.assertGreater(len(files), 900)
        done = subprocess.run([CLANG_FORMAT, "--dry-run", *files], cwd=ROOT, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        wrong = sorted(set(re.findall(r"^(\S+?):\d+:\d+: warning: code should be clang-formatted", done.stderr,
                                      re.MULTILINE)))
        self.assertEqual(wrong, [], "bring them into shape with: clang-format -i " + " ".join(wrong))

    @unittest.skipUnless(CLANG_FORMAT, "clang-format is not installed: deploy/setup.sh --tests")
    def test_a_source_out_of_shape_is_seen(self):
        done = subprocess.run([CLANG_FORMAT, "--dry-run", f"--assume-filename={ROOT}/engine/a.cc"],
                              input="int  F( ){return 1;}\n", capture_output=True, text=True, check=False)
        self.assertIn("code should be clang-formatted", done.stderr)


class FunctionLengths(unittest.TestCase):
    maxDiff = None

    def test_none_is_longer_than_is_known(self):
        known = known_long_functions()
        found = function_lengths.long_functions(ROOT)
        grown = {key: lines for key, lines in found.items() if lines > known.get(key, 0)}
        self.assertEqual(grown, {}, f"more than {function_lengths.LINES_MAX} lines, or more than {KNOWN.name} knows")
        self.assertEqual(known, found, f"shorter now: write it into {KNOWN.name}")

    def test_functions_are_found_where_they_begin(self):
        text = """#include <a>
namespace a {
constexpr std::array kRows = {
    Row{"x", [](int v) {
          return v;
        }},
};
struct S : public Base<int> {
  S() : a_{1}, b_(2) {
    Do();
  }
  int a_{0}, b_;
};
template <class T>
T Far(std::span<const T> of = {},
      int more = 0) {
  const auto f = [&](int x) {
    if (x > 0) { return; }
  };  // }
  const char* text = "}";
}
bool operator==(const S& a, const S& b) { return true; }
TEST_F(Suite, Name) {
  Use(10'000);
}
int After() {
  return f("'", 2'0);
}
S::~S() {}
}  // namespace a
"""
        found = [(name, line, lines) for name, line, lines in function_lengths.functions_of_cpp(text)]
        self.assertEqual(found, [("S", 9, 3), ("Far", 16, 6), ("operator==", 22, 1), ("TEST_F(Suite,Name)", 23, 3),
                                 ("After", 26, 3), ("S::~S", 29, 1)])

    def test_python_counts_from_the_definition_to_its_end(self):
        self.assertEqual(function_lengths.functions_of_python("x = 1\ndef f():\n    a = 1\n    return a\n"),
                         [("f", 2, 3)])


if __name__ == "__main__":
    unittest.main()
