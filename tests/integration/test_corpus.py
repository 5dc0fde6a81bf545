"""Real programs through the server, four at a time: figures agree with the references."""
import csv
import concurrent.futures
import unittest

from cell import SHARED, Cell, inline_job, job_pb2, submit, wait_for_end

COMPLETED = 1


class Corpus(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not (SHARED / "corpus").is_dir():
            raise unittest.SkipTest(f"the corpus is not here: {SHARED}")
        cls.cell = Cell(workers=4).start()
        cls.addClassCleanup(cls.cell.close)

    def run_job(self, job):
        stub = self.cell.jobs()
        made = submit(stub, job)
        ended = wait_for_end(stub, made.name, 300)[-1].ended
        return ended, stub.GetJobReport(job_pb2.GetJobReportRequest(name=made.name))

    def test_every_mill_program_meets_its_reference(self):
        rows = list(csv.DictReader((SHARED / "corpus/rml1/reference.csv").read_text().splitlines()))
        def one(row):
            content = (SHARED / "corpus/rml1" / row["file"]).read_bytes()
            return row, *self.run_job(inline_job("mill-1", row["file"], content))
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for row, ended, report in pool.map(one, rows):
                with self.subTest(row["file"]):
                    self.assertEqual(ended.kind, COMPLETED, ended)
                    if row["damaged"] == "yes":
                        continue
                    figures = {figure.name: figure.value for figure in report.figures}
                    self.assertEqual(figures["programmed.commands"], int(row["commands"]))
                    for name in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax"):
                        self.assertAlmostEqual(figures[f"programmed.{name}"], float(row[name]), places=3)
                    for name in ("cut_length", "travel_length"):
                        self.assertAlmostEqual(figures[f"programmed.{name}"], float(row[name]), delta=0.002)

    # Programs that the manual does not list: stand-ins of these tests, named as such.
    STAND_INS = {2: b"SYSDEF\nENDTASK ; stand-in for program 2\n", 46: b"ENDTASK ; stand-in for program 46\n",
                 90: b"TCP (0.0, 0.0, 0.0 / 0.0, 0.0, -5.0)\nENDTASK ; stand-in for program 90\n"}
    LASER = {"sample1.S": {}, "sample2-cylind.S": {2: None}, "ch02-lin.S": {}, "ch02-cir.S": {}, "ch02-hole.S": {},
             "ch02-fly.S": {}, "ch03-work1.S": {}, "ch03-work2.S": {}, "ch03-work3.S": {},
             "ch07-calling.S": {2: None, 45: "ch07-target45.S", 46: None}, "ch09-program32.S": {44: "ch09-program44.S"},
             "ch09-program68.S": {44: "ch09-program44.S"}, "ch09-param-caller.S": {44: "ch09-param-function44.S"},
             "ch09-formal.S": {}}

    def test_the_named_laser_programs_run_to_their_end(self):
        folder = SHARED / "corpus/optimo"
        def one(item):
            name, others = item
            job = inline_job("optimo-1", name, (folder / name).read_bytes(), inline_slot=32)
            for slot, other in others.items():
                program = job.simulation.programs.add(slot=slot)
                program.program.file_name = other or "stand-in.S"
                program.program.content = (folder / other).read_bytes() if other else self.STAND_INS[slot]
            if name == "ch02-hole.S":
                job.simulation.parameters["COORD_DEFAULT"] = "ABSOL"  # the example leaves COORD to the machine
            return name, *self.run_job(job)
        reports = {}
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for name, ended, report in pool.map(one, self.LASER.items()):
                reports[name] = report
                with self.subTest(name):
                    self.assertEqual(ended.kind, COMPLETED, ended)
        # OPT-10.01: where sample 1 ends; OPT-10.07: sample 2 switches the beam on three times.
        tip = reports["sample1.S"].final_position.tip
        for value, expected in zip((tip.x, tip.y, tip.z), (1034.7706, 1427.226, -569.722)):
            self.assertAlmostEqual(value, expected, places=3)
        self.assertEqual(reports["sample2-cylind.S"].total.beam_switches, 3)


if __name__ == "__main__":
    unittest.main(verbosity=2)
