#!/usr/bin/env python3
"""The web port of a real server, driven by clients that others wrote: connect-web, grpc-web, event streams.

RMLCELL_NODE_MODULES names the folder with their packages; tests/run.sh fills it.
"""
import os
import pathlib
import shutil
import subprocess
import unittest

from cell import SQUARE, Cell, inline_job, submit, wait_for_end

HERE = pathlib.Path(__file__).resolve().parent


class IndependentClients(unittest.TestCase):
    def test_they_all_agree_with_the_contract(self):
        if not os.environ.get("RMLCELL_NODE_MODULES") or not shutil.which("node"):
            self.skipTest("Node or its packages are not here (RMLCELL_NODE_MODULES)")
        cell = Cell()
        self.addCleanup(cell.close)
        cell.start()
        job = submit(cell.jobs(), inline_job("mill-1", "square.rml", SQUARE))
        wait_for_end(cell.jobs(), job.name)
        done = subprocess.run(
            ["node", "run.js"], cwd=HERE / "web", capture_output=True, text=True, timeout=300,
            env={**os.environ, "RMLCELL_WEB_URL": f"http://127.0.0.1:{cell.web_port}", "RMLCELL_WEB_JOB": job.name})
        print(done.stdout, done.stderr, sep="\n")
        self.assertEqual(done.returncode, 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
