#!/usr/bin/env python3
"""The contract is linted by buf, with the rules of proto/buf.yaml, and held still (decision 0028)."""
import hashlib
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROTO = ROOT / "proto"
IMAGE = ROOT / "tests/conformance/held_still/contract.binpb.zst"
BUF = os.environ.get("RMLCELL_BUF")


@unittest.skipUnless(BUF, "buf is not here (RMLCELL_BUF)")
class Lint(unittest.TestCase):
    def lint(self, folder):
        return subprocess.run([BUF, "lint", folder], capture_output=True, text=True, timeout=120)

    def test_the_contract_passes(self):
        done = self.lint(PROTO)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_field_without_a_comment_would_be_found(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            (copy / "rmlcell/v1").mkdir(parents=True)
            (copy / "buf.yaml").write_text((PROTO / "buf.yaml").read_text())
            (copy / "rmlcell/v1/bad.proto").write_text(
                'syntax = "proto3";\npackage rmlcell.v1;\n// A thing.\nmessage Thing {\n  int32 length = 1;\n}\n')
            done = self.lint(copy)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("length", done.stdout)


class HeldStill(unittest.TestCase):
    def breaks(self, folder):
        return subprocess.run([BUF, "breaking", folder, "--against", IMAGE], capture_output=True, text=True, timeout=120)

    @unittest.skipUnless(BUF, "buf is not here (RMLCELL_BUF)")
    def test_nothing_that_was_there_has_changed(self):
        done = self.breaks(PROTO)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @unittest.skipUnless(BUF, "buf is not here (RMLCELL_BUF)")
    def test_a_change_would_be_found(self):
        for was, is_now, told in (("bool cancel_requested = 14", "bool cancelled = 14", "cancel_requested"),
                                  ("int32 attempts_max = 10;", "", "attempts_max"),
                                  ("STATE_CANCELLED = 5;", "STATE_CANCELLED = 9;", 'enum value "5"')):
            with tempfile.TemporaryDirectory() as folder:
                copy = shutil.copytree(PROTO, pathlib.Path(folder) / "proto")
                changed = 0
                for file in copy.rglob("*.proto"):
                    text = file.read_text()
                    changed += was in text
                    file.write_text(text.replace(was, is_now))
                self.assertGreater(changed, 0, was)
                done = self.breaks(copy)
                self.assertNotEqual(done.returncode, 0, was)
                self.assertIn(told, done.stdout)

    def test_a_decision_names_what_is_held_still(self):
        decisions = "".join(file.read_text() for file in (ROOT / "docs/decisions").glob("*.md"))
        held = [file for file in IMAGE.parent.iterdir() if file.name != "README.md"]
        self.assertEqual(sorted(file.name for file in held), ["answers.json", "cell.db.xz", "contract.binpb.zst", "records.db.zst"])
        for file in held:
            self.assertIn(hashlib.sha256(file.read_bytes()).hexdigest(), decisions, f"{file.name}: decision 0028")


if __name__ == "__main__":
    unittest.main(verbosity=2)
