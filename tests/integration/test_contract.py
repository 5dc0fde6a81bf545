#!/usr/bin/env python3
"""The contract is linted by buf, with the rules of proto/buf.yaml."""
import os
import pathlib
import subprocess
import tempfile
import unittest

PROTO = pathlib.Path(__file__).resolve().parents[2] / "proto"
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


if __name__ == "__main__":
    unittest.main(verbosity=2)
