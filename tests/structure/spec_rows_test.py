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
    """The rows of the first table. One row a line: what stands for several hides those that have a test due."""
    rows = []
    for line in text.split("\nRML-1:")[0].splitlines():
        cells = re.match(r"\| ((?:OPT|RML1|MOT)-[^|]*) \|(.*)\|", line)
        if not cells:
            continue
        row, reason = cells.groups()
        assert re.fullmatch(r"\w+-\w+\.\d+[a-z]?", row), f"'{row}' is not the ID of one row"
        assert reason.strip(), f"{row} has no reason"
        assert row not in rows, f"{row} stands there twice"
        rows.append(row)
    return rows


class SpecRows(unittest.TestCase):
    def test_rows(self):
        # '@' for the family: else this text would count as a test of these rows.
        def family(text):
            return text.replace("@", "OPT")

        table = "| ID | reason |\n|---|---|\n| @-1.22 | a |\n| @-E.7601 | b |\nRML-1: none\n| @-2.01 | c |\n"
        self.assertEqual(exceptions(family(table)), [family(row) for row in ("@-1.22", "@-E.7601")])
        for several in ("@-9.32 to 9.38", "@-9.32 to @-9.38", "@-4.*", "@-4.01, @-4.02", "@-4.01, 4.02", "@-4"):
            with self.assertRaises(AssertionError, msg=several):
                exceptions(family(f"| {several} | a |\n"))
        for wrong in ("| @-1.22 | |\n", "| @-1.22 | a |\n| @-1.22 | b |\n"):
            with self.assertRaises(AssertionError, msg=wrong):
                exceptions(family(wrong))

    @unittest.skipUnless(TOOL.exists(), "the specifications are not at hand")
    def test_every_row_of_live_machines_has_a_test(self):
        done = subprocess.run([sys.executable, TOOL, "--missing", "LIVE-"], cwd=ROOT, capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, "")

    @unittest.skipUnless(TOOL.exists(), "the specifications are not at hand")
    def test_every_row_has_a_test_or_a_reason(self):
        done = subprocess.run([sys.executable, TOOL, "--missing"], cwd=ROOT, capture_output=True, text=True, check=True)
        missing = [line.split()[0] for line in done.stdout.splitlines()]
        listed = exceptions((ROOT / "docs" / "spec-exceptions.md").read_text(encoding="utf-8"))
        without = [row for row in missing if row not in listed]
        self.assertEqual(without, [], "rows that no test names and docs/spec-exceptions.md does not list")
        idle = [row for row in listed if row not in missing]
        self.assertEqual(idle, [], "exceptions whose rows all have tests")


if __name__ == "__main__":
    unittest.main()
