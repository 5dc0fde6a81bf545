"""The live page in a browser: what it tells of a job, on a desk and on a phone."""
import unittest

from browser import CHROMIUM, Browser
from cell import WithCell, machine_pb2
from command import InFolder
from test_shown import GOOD, STROKES

DESK, PHONE = (1300, 900), (390, 844)


@unittest.skipUnless(CHROMIUM, "no browser is here")
class Page(WithCell, InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        super().setUp()
        stub = self.cell.machines()
        machine = stub.GetMachine(machine_pb2.GetMachineRequest(name="machines/mill-1"))
        machine.parameters["CLAMP_HEIGHT"] = "4"
        stub.UpdateMachine(machine_pb2.UpdateMachineRequest(machine=machine))
        self.cell.command("submit", "mill-1", self.file("far.rml", STROKES), "--watch", check=False)
        self.cell.command("submit", "mill-1", self.file("good.rml", GOOD), "--title", "long " * 39, "--watch", check=False)

    def report_of(self, program):
        find = f"[...document.querySelectorAll('tbody tr')].find(row => row.textContent.includes('{program}'))"
        link = f"[...({find})?.querySelectorAll('.results a') ?? []].find(one => one.textContent === 'Report')"
        self.browser.wait_for(f"Boolean({link})")
        self.browser.ask(f"({link}).click()")
        self.browser.wait_for("Boolean(document.querySelector('#explain[open] dl.report'))")
        return self.browser.ask("document.querySelector('#explain').innerText")

    def test_a_job_shows_verdict_findings_profile_and_picture(self):
        for width, height in (DESK, PHONE):
            self.browser.open(f"http://127.0.0.1:{self.cell.web_port}/", width, height)
            report = self.report_of("far.rml")
            self.assertIn("Verdict Bad", report)
            self.assertIn("600.000 mm of the work lie beyond the travel and are not cut", report)
            self.assertIn("move the work origin", report)
            self.assertIn("rml1, srm-20", report)
            self.assertRegex(report, r"CLAMP_HEIGHT 4 \(profile: .*\); by machines/mill-1")
            # 20 places of one kind, once.
            self.assertRegex(report, r"RML1-E8002 Bad: the tool could not follow PD to its end\s+20 times, ")
            self.assertEqual(report.count("could not follow"), 1)
            self.assertTrue(self.browser.wait_for(
                "[...document.querySelectorAll('.look img')].some(one => one.complete && one.naturalWidth > 0)"))
            # Nothing sticks out.
            self.assertLessEqual(self.browser.ask("document.documentElement.scrollWidth"), width)
            self.assertLessEqual(self.browser.ask("document.querySelector('#explain').scrollWidth"), width)

    def test_a_check_that_fails_is_bad_with_advice(self):
        calls = self.file("calls.S", "COORD ABSOL\nPATH LIN\nSPEED 10\nCALL 77\n")
        done = self.cell.command("submit", "optimo-1", calls, "--kind", "check", "--watch", check=False)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.browser.open(f"http://127.0.0.1:{self.cell.web_port}/", *DESK)
        row = "[...document.querySelectorAll('tbody tr')].find(row => row.textContent.includes('calls'))"
        self.browser.wait_for(f"Boolean({row})")
        text = self.browser.ask(f"({row}).innerText")
        self.assertIn("Failed", text)
        self.assertRegex(text, r"OPT-E7102 program 77")
        self.assertRegex(text, r"Verdict Bad · program \d+, step 4 · store the program first")


if __name__ == "__main__":
    unittest.main(verbosity=2)
