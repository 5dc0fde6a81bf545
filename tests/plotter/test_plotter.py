#!/usr/bin/env python3
"""A cell whose registry has a third family: a pen plotter. Nothing but its folder and that line knows it."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))
from cell import (BIN, COMPLETED, FAILED, WithCell, common_pb2, grpc, inline_job, job_pb2, machine_pb2, program_pb2, submit,  # noqa: E402
                  wait_for_end)

# A square of 40 mm; at 200 mm/s, 2,000 mm/s2 and 40,000 mm/s3.
SQUARE = "SP 1\nPU 10,10\nPD 50,10\nPD 50,50\nPD 10,50\nPD 10,10\nWT 0.5\nSP 0\nPU 0,0\n"


class OnALaptop(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_it(self, *words, text=SQUARE):
        (self.folder / "square.plt").write_text(text)
        return subprocess.run([BIN / "rmlcell", *words], cwd=self.folder, capture_output=True, text=True, timeout=60)

    def test_it_is_checked(self):
        good = self.run_it("check", "square.plt")
        self.assertEqual(good.returncode, 0, good.stderr)
        bad = self.run_it("check", "square.plt", text="SP 1\nPX 1,1\n")
        self.assertEqual(bad.returncode, 1)
        self.assertIn("square.plt:2:1", bad.stdout)
        self.assertIn("PLT-E1", bad.stdout)
        self.assertIn("write SP, PU, PD or WT", bad.stdout)

    def test_it_is_simulated_and_drawn(self):
        done = self.run_it("simulate", "square.plt", "--json", "--svg", "square.svg")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual((report["family"], report["outcome"]["kind"]), ("plotter", "KIND_COMPLETED"))
        self.assertAlmostEqual(report["total"]["cutLengthMm"], 160.0, places=6)
        self.assertAlmostEqual(report["total"]["times"]["dwellS"], 0.5, places=6)
        self.assertIn("<svg", (self.folder / "square.svg").read_text())

    def test_its_own_error_ends_a_run(self):
        done = self.run_it("simulate", "square.plt", "--json", text="PD 1,1\n")
        self.assertEqual(done.returncode, 1)
        outcome = json.loads(done.stdout)["outcome"]
        self.assertEqual((outcome["kind"], outcome["code"], outcome["symbol"]), ("KIND_FAILED", "PLT-E2", "PLOTTER_NO_PEN"))

    def test_what_leaves_the_paper_is_bad(self):
        # The paper has 300 mm: 500 is 200 beyond, -1 is 1.
        for to, beyond in (("500,10", "X by 200 mm"), ("10,500", "Y by 200 mm"), ("-1,0", "X by 1 mm")):
            text = f"SP 1\nPD 300,300\nPD {to}\n"
            checked = self.run_it("check", "square.plt", text=text)
            self.assertEqual(checked.returncode, 1, checked.stdout)
            self.assertIn("square.plt:3", checked.stdout)
            self.assertIn("PLT-E3", checked.stdout)
            self.assertIn(beyond, checked.stdout)
            self.assertIn("BAD", checked.stdout)
            report = json.loads(self.run_it("simulate", "square.plt", "--json", text=text).stdout)
            outcome = report["outcome"]
            self.assertEqual((outcome["verdict"], outcome["code"]), ("VERDICT_BAD", "PLT-E3"))
            self.assertEqual([(one["code"], one["message"]) for one in outcome["reasons"]], [("PLT-E3", beyond)])
            self.assertEqual(len(report["violations"]), 1)
        self.assertEqual(self.run_it("check", "square.plt", text="SP 1\nPD 300,300\nPD 0,0\n").returncode, 0)

    def test_it_has_nothing_to_fix(self):
        refused = self.run_it("check", "--fix", "square.plt")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("has nothing to fix", refused.stderr)

    def test_help_names_it(self):
        self.assertIn("optimo, rml1 or plotter", " ".join(self.run_it("parameters", "--help").stdout.split()))

    def test_its_codes_are_explained(self):
        said = self.run_it("explain", "PLT-E2")
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertIn("take a pen with SP first", said.stdout)

    def test_the_override_has_its_own_range(self):
        self.assertEqual(self.run_it("simulate", "square.plt", "--override", "120").returncode, 0)
        refused = self.run_it("simulate", "square.plt", "--override", "121")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("above 0 to 120 %", refused.stderr)

    def test_it_has_no_tools(self):
        refused = self.run_it("format", "square.plt")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("Pen plotter", refused.stderr)


class InACell(WithCell):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cell.machines().CreateMachine(machine_pb2.CreateMachineRequest(
            machine_id="plotter-1", machine=machine_pb2.Machine(family="plotter", parameters={"SIZE": "500"})))

    def test_the_family_is_listed(self):
        families = {one.id: one for one in self.cell.machines().ListFamilies(machine_pb2.ListFamiliesRequest()).families}
        self.assertEqual(families["plotter"].title, "Pen plotter")
        self.assertEqual([one.name for one in families["plotter"].parameters], ["SIZE"])

    def test_the_machine_is_shown(self):
        shown = self.cell.machines().GetMachine(machine_pb2.GetMachineRequest(name="machines/plotter-1"))
        self.assertEqual((shown.family, shown.parameters["SIZE"]), ("plotter", "500"))
        page = self.cell.command("machines")
        self.assertIn("plotter-1", page.stdout)

    def test_a_job_that_runs_shows_where_it_is(self):
        stub = self.cell.jobs()
        job = inline_job("plotter-1", "corner.plt", "SP 1\nPD 200,0\nPD 200,200\n")
        job.simulation.pace = 10.0
        seen = [message.progress.position.tip for message in
                stub.WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name=submit(stub, job).name), timeout=60)
                if message.HasField("progress")]
        self.assertTrue(seen)
        for tip in seen:  # along the first move, or along the second
            self.assertTrue(abs(tip.y) < 1e-6 or abs(tip.x - 200.0) < 1e-6, tip)

    def put(self, slot, text):
        return program_pb2.PutProgramRequest(
            name=f"machines/plotter-1/programs/{slot}",
            program=common_pb2.ProgramText(file_name="square.plt", content=text.encode()))

    def test_programs_are_stored_and_run(self):
        self.cell.programs().PutProgram(self.put(7, SQUARE))
        stub = self.cell.jobs()
        job = submit(stub, job_pb2.Job(kind=job_pb2.JOB_KIND_SIMULATE, machine="machines/plotter-1",
                                       program="machines/plotter-1/programs/7"))
        events = wait_for_end(stub, job.name)
        self.assertTrue(events)
        ended = stub.GetJob(job_pb2.GetJobRequest(name=job.name))
        self.assertEqual(ended.outcome.kind, COMPLETED)
        report = stub.GetJobReport(job_pb2.GetJobReportRequest(name=job.name))
        self.assertAlmostEqual(report.total.cut_length_mm, 160.0, places=6)
        self.assertLessEqual({"report", "toolpath", "picture.svg"}, {artifact.name for artifact in ended.artifacts})

    def test_a_job_that_fails_has_its_code(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("plotter-1", "none.plt", "PD 1,1\n"))
        wait_for_end(stub, job.name)
        outcome = stub.GetJob(job_pb2.GetJobRequest(name=job.name)).outcome
        self.assertEqual((outcome.kind, outcome.code), (FAILED, "PLT-E2"))

    def test_what_is_no_program_is_refused_with_its_code(self):
        detail = self.refused(self.cell.programs().PutProgram, self.put(8, "hello\n"),
                              grpc.StatusCode.INVALID_ARGUMENT, "PLT-E1")
        self.assertEqual(detail.symbol, "PLOTTER_SYNTAX")

    def test_its_override_has_its_own_range(self):
        job = inline_job("plotter-1", "square.plt", SQUARE)
        job.simulation.override_percent = 121
        self.refused(self.cell.jobs().SubmitJob, job_pb2.SubmitJobRequest(job=job),
                     grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")


if __name__ == "__main__":
    unittest.main()
