#!/usr/bin/env python3
"""Every row of the specifications is named by a test or stands in docs/spec-exceptions.md, and nothing stands
there that has a test. Needs the specifications (RMLCELL_SHARED); skips without."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("RMLCELL_SHARED", ROOT.parent / "shared"))
TOOL = SHARED / "tools" / "spec-coverage"


def exceptions(text):
    """The patterns of the first table: a row, 'a row to number', a chapter with '.*', or a list of them."""
    patterns = []
    for line in text.split("\nRML-1:")[0].splitlines():
        row = re.match(r"\| ((?:OPT|RML1|MOT)-[^|]*) \|", line)
        for part in re.split(r", ", row.group(1)) if row else []:
            found = re.fullmatch(r"(\w+-\w+)\.(\d+|\*)(?: to \w+\.(\d+))?", part)
            assert found, f"'{part}' is no row, no range of rows and no chapter"
            patterns.append((part, found.group(1), found.group(2), found.group(3) or found.group(2)))
    return patterns


def matches(pattern, row):
    _, chapter, first, last = pattern
    of, number = row.split(".")
    return of == chapter and (first == "*" or int(first) <= int(re.match(r"\d+", number).group()) <= int(last))


class SpecRows(unittest.TestCase):
    def test_patterns(self):
        # '@' for the family: else this text would count as a test of these rows.
        def family(text):
            return text.replace("@", "OPT")

        table = "| @-1.22 | a |\n| @-9.32 to 9.38, @-4.* | b |\nRML-1: none\n| @-2.01 | c |\n"
        found = exceptions(family(table))
        self.assertEqual([pattern[0] for pattern in found],
                         [family(text) for text in ("@-1.22", "@-9.32 to 9.38", "@-4.*")])
        for row, wanted in [("@-1.22", True), ("@-9.31", False), ("@-9.32", True), ("@-9.38", True),
                            ("@-9.39", False), ("@-4.74", True), ("@-2.01", False), ("@-B.22", False)]:
            self.assertEqual(any(matches(pattern, family(row)) for pattern in found), wanted, row)

    @unittest.skipUnless(TOOL.exists(), "the specifications are not at hand")
    def test_every_row_has_a_test_or_a_reason(self):
        done = subprocess.run([sys.executable, TOOL, "--missing"], cwd=ROOT, capture_output=True, text=True, check=True)
        missing = [line.split()[0] for line in done.stdout.splitlines()]
        listed = exceptions((ROOT / "docs" / "spec-exceptions.md").read_text(encoding="utf-8"))
        without = [row for row in missing if not any(matches(pattern, row) for pattern in listed)]
        self.assertEqual(without, [], "rows that no test names and docs/spec-exceptions.md does not list")
        idle = [pattern[0] for pattern in listed if not any(matches(pattern, row) for row in missing)]
        self.assertEqual(idle, [], "exceptions whose rows all have tests")


if __name__ == "__main__":
    unittest.main()
