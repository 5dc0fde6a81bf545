"""The rmlcell command: remote verbs against a server."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from cell import BIN, SQUARE, Cell, endless_job, job_pb2, submit
from command import ask


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
            self.assertEqual(ask("put", "mill-1", 7, program, server=at).returncode, 0)
            done = ask("submit", "mill-1", "--slot", 7, "--watch", server=at)
            self.assertEqual(done.returncode, 0, done.stderr)
            job = done.stdout.splitlines()[0]
            self.assertIn("completed", done.stdout.splitlines()[-1])
            self.assertIn("completed", ask("report", job, server=at).stdout)
            self.assertEqual(ask("picture", job, "-o", picture, server=at).returncode, 0)
            self.assertIn("<svg", picture.read_text())
            self.assertIn("succeeded", ask("jobs", server=at).stdout)

    def test_what_reads_from_a_pipe_sees_each_event_when_it_happens(self):
        stub = self.cell.jobs()
        job = submit(stub, endless_job())
        watch = subprocess.Popen([BIN / "rmlcell", "watch", job.name], stdout=subprocess.PIPE, text=True,
                                 stderr=subprocess.DEVNULL, env={**os.environ, "RMLCELL_SERVER": self.cell.address})
        try:
            self.assertIn("queued", watch.stdout.readline())
        finally:
            stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
            watch.communicate(timeout=60)

    def test_a_check_job_reports_findings_and_no_figures(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "a.S"
            program.write_text("SPEED 20\nSPEED 101\n")
            at = self.cell.address
            done = ask("submit", "optimo-1", program, "--kind", "check", "--watch", server=at)
            report = ask("report", done.stdout.splitlines()[0], server=at).stdout
            self.assertIn("OPT-E7004", report)
            self.assertNotIn("cycle time", report)

    def test_a_report_says_of_which_file_it_is(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "left-door.rml"
            program.write_text(SQUARE)
            at = self.cell.address
            done = ask("submit", "mill-1", program, "--watch", server=at)
            report = json.loads(ask("report", done.stdout.splitlines()[0], "--json", server=at).stdout)
            self.assertEqual(report["title"], "left-door.rml")

    def test_a_project_is_made_of_a_folder(self):
        with tempfile.TemporaryDirectory() as name:
            folder, at = pathlib.Path(name), self.cell.address
            (folder / "31.S").write_text("SPEED 20\n")
            (folder / "32.SI").write_text("COORD ABSOL\nMOVE (1.0, 0.0, 0.0, 0.0, 0.0)\n")
            (folder / "notes.txt").write_text("no program")
            (folder / "project.json").write_text('{"title": "Door", "laserSchedules": [{"number": 11}]}')
            done = ask("projects", "create", "door", folder, server=at)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("door", ask("projects", "list", server=at).stdout)
            kept = json.loads(ask("projects", "show", "door", "--json", server=at).stdout)
            self.assertEqual([p["slot"] for p in kept["programs"]], [31, 32])
            self.assertEqual(kept["title"], "Door")
            self.assertEqual(ask("projects", "transfer", "door", "optimo-1", server=at).returncode, 0)
            self.assertIn("MOVE (1.0,", ask("get", "optimo-1", 32, server=at).stdout)  # his own text
            # Named in the file, and so the only program; its bytes lie beside the file.
            (folder / "project.json").write_text('{"programs": [{"slot": 40, "source": {"fileName": "31.S"}}]}')
            self.assertEqual(ask("projects", "update", "door", folder, server=at).returncode, 0)
            kept = json.loads(ask("projects", "show", "door", "--json", server=at).stdout)
            self.assertEqual([p["slot"] for p in kept["programs"]], [40])
            (folder / "project.json").write_text('{"programs": [{"slot": 40, "source": {"fileName": "none.S"}}]}')
            done = ask("projects", "update", "door", folder, server=at)
            self.assertEqual(done.returncode, 2)
            self.assertIn("none.S", done.stderr)
            self.assertEqual(ask("projects", "delete", "door", server=at).returncode, 0)
            self.assertNotIn("door", ask("projects", "list", server=at).stdout)
            for words in (("show", "door"), ("delete", "projects/door")):
                gone = ask("projects", *words, server=at)
                self.assertEqual(gone.returncode, 3)
                self.assertIn("CELL-E9004", gone.stderr)

    def test_a_job_that_is_held_is_shown_moved_and_cancelled(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "part.rml"
            program.write_text(SQUARE)
            at = self.cell.address

            def submitted():
                done = ask("submit", "--label", "order-1", "mill-1", program, "--hold", "--priority", 5, "--title", "mine",
                           "--request-id", "held-and-moved", server=at)
                self.assertEqual(done.returncode, 0, done.stderr)
                return done.stdout.strip()

            def seen():
                return json.loads(ask("job", job, "--json", server=at).stdout)

            job = submitted()
            self.assertEqual(submitted(), job)  # the same request gives the same job
            self.assertEqual([seen()[name] for name in ("title", "labels", "priority", "held")], ["mine", ["order-1"], 5, True])
            self.assertIn("waits     held\n", ask("job", job, server=at).stdout)
            listed = ask("jobs", "--order", "queue", "--filter", "label = order-1", server=at).stdout.splitlines()
            self.assertEqual([line.split()[0] for line in listed], ["JOB", job.split("/")[1]])
            self.assertEqual(ask("move", job, "--priority", -7, server=at).stdout, f"{job} queued\n")
            self.assertEqual(seen()["priority"], -7)
            self.assertEqual(ask("cancel", job, server=at).returncode, 0)
            self.assertEqual(seen()["state"], "STATE_CANCELLED")

    def test_programs_are_listed_got_and_deleted(self):
        with tempfile.TemporaryDirectory() as name:
            folder, at = pathlib.Path(name), self.cell.address
            program = folder / "square.rml"
            program.write_text(SQUARE)
            self.assertIn("mill-1", ask("machines", server=at).stdout)
            self.assertIn(" would be stored: ", ask("put", "mill-1", 41, program, "--check-only", server=at).stdout)
            self.assertEqual(ask("get", "mill-1", 41, server=at).returncode, 3)
            self.assertEqual(ask("put", "mill-1", 41, program, "--etag", "none", server=at).returncode, 0)
            self.assertNotEqual(ask("put", "mill-1", 41, program, "--etag", "none", server=at).returncode, 0)
            self.assertIn("\n41 ", ask("programs", "mill-1", server=at).stdout)
            self.assertEqual(ask("get", "mill-1", 41, server=at).stdout, SQUARE)
            self.assertEqual(ask("get", "mill-1", 41, "-o", folder / "got", server=at).stdout, "")
            self.assertEqual((folder / "got").read_text(), SQUARE)
            self.assertEqual(ask("stale", "optimo-1", server=at).stdout, "every executable is what a new link would give\n")
            self.assertEqual(ask("delete", "mill-1", 41, server=at).returncode, 0)
            self.assertEqual(ask("get", "mill-1", 41, server=at).returncode, 3)

    def test_products_of_a_job_and_what_came_after_an_event(self):
        with tempfile.TemporaryDirectory() as name:
            folder, at = pathlib.Path(name), self.cell.address
            program = folder / "square.rml"
            program.write_text(SQUARE)
            job = ask("submit", "mill-1", program, "--watch", server=at).stdout.splitlines()[0]
            products = [line.split()[1] for line in ask("job", job, server=at).stdout.splitlines() if line.startswith("product ")]
            self.assertGreater(len(products), 0)
            for product in products:
                self.assertEqual(ask("artifact", job, product, "-o", folder / "got", server=at).returncode, 0)
                self.assertGreater((folder / "got").stat().st_size, 0)
            told = [json.loads(line) for line in ask("watch", job, "--json", server=at).stdout.splitlines()]
            last = max(int(message["sequence"]) for message in told if "event" in message)
            done = ask("watch", job, "--after", last, server=at)
            self.assertEqual((done.returncode, done.stdout), (0, ""))


if __name__ == "__main__":
    unittest.main()
