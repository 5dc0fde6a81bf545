"""The rmlcell command: local verbs without a server, remote verbs against one."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from cell import BIN, SQUARE, Cell


def run(*words, server=None):
    environment = {**os.environ, "NO_COLOR": "1"}
    if server:
        environment["RMLCELL_SERVER"] = server
    return subprocess.run([BIN / "rmlcell", *map(str, words)], capture_output=True, text=True, timeout=120,
                          env=environment)


class Local(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def test_check_names_place_code_and_rule(self):
        done = run("check", self.file("a.S", "SPEED 20\nSPEED 101\n"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("a.S:2:", done.stdout)
        self.assertIn("OPT-E7004", done.stdout)

    def test_simulate_prints_the_report_as_json(self):
        done = run("simulate", self.file("square.rml", SQUARE), "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(report["outcome"]["kind"], "KIND_COMPLETED")

    def test_simulate_fills_the_memory_from_a_folder(self):
        self.file("12.S", "CALL 13\nVR[1] = VR[0] + 1.\n")
        self.file("13.S", "VR[0] = 41.\n")
        done = run("simulate", self.folder, "--main", 12, "--vars", "VR[0..1]", "--facts")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("variable.VR[1]: 42.0", done.stdout)

    def test_inputs_over_time_reach_the_program(self):
        inputs = self.file("inputs.txt", "# the operator\n2.5 IL[20] = 1\n")
        done = run("simulate", self.file("w.S", "WAIT IL[20]\nVI[2] = 7\n"), "--inputs", inputs, "--vars", "VI[2]",
                   "--json")
        report = json.loads(done.stdout)
        self.assertEqual(report["variables"], {"VI[2]": "7"})
        self.assertAlmostEqual(report["total"]["times"]["conditionS"], 2.5, places=6)

    def test_the_picture_goes_to_standard_output_and_the_run_keeps_its_exit_code(self):
        state = self.folder / "state"
        done = run("simulate", self.file("bad.S", "SPEED 20\nVR[0] = 1. / VR[1]\n"), "--svg", "-", "--state-out", state)
        self.assertTrue(done.stdout.lstrip().startswith("<"), done.stdout[:80])
        self.assertEqual(done.returncode, 1)
        self.assertGreater(state.stat().st_size, 0)

    def test_the_picture_is_written(self):
        picture = self.folder / "p.svg"
        self.assertEqual(run("simulate", self.file("square.rml", SQUARE), "--svg", picture).returncode, 0)
        self.assertIn("<svg", picture.read_text())

    def test_curves_over_time_are_written(self):
        plot = self.folder / "t.svg"
        done = run("simulate", "--plot", "axes,speed", plot, self.file("square.rml", SQUARE))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("tip speed", plot.read_text())
        self.assertEqual(run("simulate", "--plot", "torque", plot, self.file("square.rml", SQUARE)).returncode, 2)

    def test_wrong_use_and_missing_files_are_told_apart_from_program_errors(self):
        self.assertEqual(run("simulate", self.folder / "none.S").returncode, 2)
        self.assertEqual(run("nonsense").returncode, 2)
        self.assertEqual(run("explain", "OPT-E348").returncode, 0)
        self.assertEqual(run("jobs", server="127.0.0.1:1").returncode, 3)


class Remote(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell().start()
        cls.addClassCleanup(cls.cell.close)

    def test_put_submit_watch_report_and_picture(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "square.rml"
            program.write_text(SQUARE)
            picture = pathlib.Path(folder) / "p.svg"
            at = self.cell.address
            self.assertEqual(run("put", "mill-1", 7, program, server=at).returncode, 0)
            done = run("submit", "mill-1", "--slot", 7, "--watch", server=at)
            self.assertEqual(done.returncode, 0, done.stderr)
            job = done.stdout.splitlines()[0]
            self.assertIn("completed", done.stdout.splitlines()[-1])
            self.assertIn("completed", run("report", job, server=at).stdout)
            self.assertEqual(run("picture", job, "-o", picture, server=at).returncode, 0)
            self.assertIn("<svg", picture.read_text())
            self.assertIn("succeeded", run("jobs", server=at).stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
