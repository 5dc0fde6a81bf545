"""Grooves in a block, by the command and by jobs, for the tests of what a mill leaves."""
import urllib.request

from cell import Cell, job_pb2, submit, wait_for_end
from command import InFolder, ask

# A groove of 20 mm along X, 1 mm deep, with clearance on the way. 100 units a mm; along the middle of cells of 0.2 mm.
GROOVE = "VS10;!VZ10;!PZ-100,200;!MC1;PU2010,1510;PD4010,1510;PU0,0;!MC0;"
BLOCK = ("--stock", "60x30x5", "--tool", "flat:3", "--cell", "0.2")


class Material(InFolder):
    def setUp(self):
        super().setUp()
        self.groove = self.file("groove.rml", GROOVE)

    def simulate(self, *words, program=None):
        return ask("simulate", program or self.groove, "--profile", "t1", *words)

    def good(self, *words, **more):
        done = self.simulate(*BLOCK, *words, **more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def refused(self, code, text, *words):
        done = self.simulate(*words)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertIn(code, done.stderr)
        self.assertIn(text, done.stderr)

    def facts(self, *words, program=None):
        done = self.simulate(*BLOCK, *words, "--facts", program=program)
        return dict(line.split(": ", 1) for line in done.stdout.splitlines() if ": " in line)


class WithServer(Material):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell().start()
        cls.addClassCleanup(cls.cell.close)

    def fetched(self, job, name, **headers):
        url = f"http://127.0.0.1:{self.cell.web_port}/v1/{job}/artifacts/{name}"
        return urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=60)

    def products(self, job):
        listed = self.cell.command("job", job).stdout
        return {line.split()[1] for line in listed.splitlines() if line.startswith("product ")}

    def ended(self, stub, job):
        name = submit(stub, job).name
        wait_for_end(stub, name)
        return stub.GetJob(job_pb2.GetJobRequest(name=name))
