"""What each verb of the rmlcell command asks its server for: all of its options, and none of them."""
import base64
import os
import subprocess
import unittest

from any_server import AnyServer
from command import BIN, InFolder, ask

STREAM = "PU;"
CONTENT = base64.b64encode(STREAM.encode()).decode()
INLINE = {"fileName": "part.rml", "content": CONTENT}
BLOCK = {"stock": {"sizeXMm": 10.0, "sizeYMm": 20.0, "sizeZMm": 30.0}, "tool": {"shape": "SHAPE_FLAT", "diameterMm": 3.0}}
END = {"snapshot": {"endTime": "2026-11-25T10:00:00Z", "lastSequence": "0",
                    "outcome": {"kind": "KIND_COMPLETED", "verdict": "VERDICT_DOUBTFUL"}}}

PROGRAMS = [
    ("machines", ("ListMachines", {})),
    ("programs m", ("ListPrograms", {"parent": "machines/m"})),
    ("put m 7 @part.rml", ("PutProgram", {"name": "machines/m/programs/7", "program": INLINE})),
    ("put m 107 @part.rml --etag 3 --check-only",
     ("PutProgram", {"name": "machines/m/programs/107", "program": INLINE, "etag": "3", "validateOnly": True})),
    ("put m 7 @part.rml --force", ("PutProgram", {"name": "machines/m/programs/7", "program": INLINE, "force": True})),
    ("get m 44", ("DownloadProgram", {"name": "machines/m/programs/44", "form": "PROGRAM_FORM_SOURCE"})),
    ("get m 44 --form listing", ("DownloadProgram", {"name": "machines/m/programs/44", "form": "PROGRAM_FORM_LISTING"})),
    ("get m 44 -o @44.O", ("DownloadProgram", {"name": "machines/m/programs/44", "form": "PROGRAM_FORM_OBJECT"})),
    ("get m 144 --form executable --output @144.X",
     ("DownloadProgram", {"name": "machines/m/programs/144", "form": "PROGRAM_FORM_EXECUTABLE"})),
    ("delete m 44", ("DeleteProgram", {"name": "machines/m/programs/44"})),
    ("stale m", ("ListStaleExecutables", {"parent": "machines/m"})),
    ("special m", ("StoreSpecialPrograms", {"parent": "machines/m"})),
]
PROJECTS = [
    ("projects", ("ListProjects", {})),
    ("projects list", ("ListProjects", {})),
    ("projects show door", ("GetProject", {"name": "projects/door"})),
    ("projects create door @door.json", ("CreateProject", {"projectId": "door", "project": {"title": "Door"}})),
    ("projects update door @door.json",
     ("UpdateProject", {"project": {"name": "projects/door", "title": "Door"}, "updateMask": "*"})),
    ("projects delete door", ("DeleteProject", {"name": "projects/door"})),
    ("projects transfer door m", ("TransferProject", {"name": "projects/door", "machine": "machines/m"})),
    ("projects transfer door m --insert",
     ("TransferProject", {"name": "projects/door", "machine": "machines/m", "insertMissingDefinitions": True})),
    ("projects transfer door m --check-only",
     ("TransferProject", {"name": "projects/door", "machine": "machines/m", "validateOnly": True})),
    ("projects take door m", ("TransferProjectFromMachine", {"machine": "machines/m", "projectId": "door"})),
    ("projects take door m --slots 12 44 --inch",
     ("TransferProjectFromMachine", {"machine": "machines/m", "projectId": "door", "slots": [12, 44], "units": "UNITS_INCH"})),
    ("projects export door -o @door.zip", ("ExportProject", {"name": "projects/door"})),
    ("projects import door-2 @part.rml", ("ImportProject", [{"projectId": "door-2"}, {"chunk": CONTENT}])),
]
JOBS = [
    ("jobs", ("ListJobs", {"pageSize": 20})),
    ("jobs --order oldest --filter x --limit 1000", ("ListJobs", {"pageSize": 1000, "filter": "x", "orderBy": "create_time"})),
    ("jobs --order queue --limit 1", ("ListJobs", {"pageSize": 1, "orderBy": "queue"})),
    ("jobs --order newest", ("ListJobs", {"pageSize": 20})),
    ("job 17", ("GetJob", {"name": "jobs/17"})),
    ("cancel jobs/17", ("CancelJob", {"name": "jobs/17"})),
    ("hold 17", ("HoldJob", {"name": "jobs/17"})),
    ("resume 17", ("ResumeJob", {"name": "jobs/17"})),
    ("move 17", ("MoveJob", {"name": "jobs/17"})),
    ("move 17 --before 12", ("MoveJob", {"name": "jobs/17", "before": "jobs/12"})),
    ("move 17 --priority -100", ("MoveJob", {"name": "jobs/17", "priority": -100})),
    ("move 17 --priority 100", ("MoveJob", {"name": "jobs/17", "priority": 100})),
    ("report 17", ("GetJobReport", {"name": "jobs/17"})),
    ("picture 17", ("GetJobPicture", {"name": "jobs/17"})),
    ("artifact 17 relief.png", ("StreamJobArtifact", {"name": "jobs/17", "artifact": "relief.png"})),
    ("watch 17", ("WatchJob", {"name": "jobs/17", "afterSequence": "0"})),
    ("watch 17 --after 120", ("WatchJob", {"name": "jobs/17", "afterSequence": "120"})),
]
# The words behind `submit m`, and the job that comes of them.
SUBMITTED = [
    ("@part.rml", {"kind": "JOB_KIND_SIMULATE", "inlineProgram": INLINE, "title": "part.rml", "simulation": {}}),
    ("--slot 1", {"kind": "JOB_KIND_SIMULATE", "program": "machines/m/programs/1", "simulation": {}}),
    ("--slot 99", {"kind": "JOB_KIND_SIMULATE", "program": "machines/m/programs/99", "simulation": {}}),
    ("@part.rml --slot 7 --title Mine --label a --label b --override 55 --pace 1000 --trace --priority -100 --hold"
     " --not-before 2026-11-25T10:00:00Z --after-job 3 --after-job jobs/4",
     {"kind": "JOB_KIND_SIMULATE", "inlineProgram": INLINE, "inlineSlot": 7, "title": "Mine", "labels": ["a", "b"],
      "simulation": {"overridePercent": 55.0, "pace": 1000.0, "trace": True}, "priority": -100, "held": True,
      "notBeforeTime": "2026-11-25T10:00:00Z", "afterJobs": ["jobs/3", "jobs/4"]}),
    ("@part.rml --kind check --priority 100 --inputs @keys.txt",
     {"kind": "JOB_KIND_CHECK", "inlineProgram": INLINE, "title": "part.rml", "priority": 100,
      "simulation": {"inputs": [{"virtualTimeNs": "500000000", "input": {"overridePercent": 40.0}}]}}),
    ("--slot 45 --kind run --unzeroed --ticket 17 --step 45/10 --occurrence 2 --off-until-work-on --seen clamps,tool",
     {"kind": "JOB_KIND_RUN", "program": "machines/m/programs/45",
      "run": {"unzeroed": True, "ticket": "jobs/17", "step": {"program": 45, "step": 10}, "occurrence": "2",
              "offUntilWorkOn": True, "confirmations": ["CONFIRMATION_CLAMPS", "CONFIRMATION_TOOL"]}}),
    ("@part.rml --stock 10x20x30 --tool flat:3",
     {"kind": "JOB_KIND_SIMULATE", "inlineProgram": INLINE, "title": "part.rml",
      "simulation": {"milling": {**BLOCK, "relief": True, "stlToleranceMm": 0.01}}}),
    ("--slot 5 --stock 10x20x30 --tool flat:3:flutes=2 --target-slot 9 --products height-map --products height-grid,stl"
     " --stl-tolerance 0.5 --target-tolerance 0.25 --cell 0.125 --material wax --rpm 5000",
     {"kind": "JOB_KIND_SIMULATE", "program": "machines/m/programs/5",
      "simulation": {"milling": {**BLOCK, "tool": {**BLOCK["tool"], "flutes": 2}, "heightMap": True, "heightGrid": True,
                                 "stl": True, "stlToleranceMm": 0.5, "cellMm": 0.125, "material": "wax", "rpm": 5000.0,
                                 "target": {"slot": 9, "toleranceMm": 0.25}}}}),
    ("@part.rml --project door",
     {"kind": "JOB_KIND_SIMULATE", "inlineProgram": INLINE, "title": "part.rml",
      "simulation": {"millingProject": "projects/door"}}),
]
REFUSED = [
    ("submit m", "rmlcell: submit: give a FILE or --slot (rmlcell submit --help)"),
    ("submit m --slot 0", "--slot"),
    ("submit m --slot 100", "--slot"),
    ("submit m @part.rml --priority -101", "--priority"),
    ("submit m @part.rml --priority 101", "--priority"),
    ("submit m @part.rml --pace -0.5", "--pace"),
    ("submit m @part.rml --pace 1000.5", "--pace"),
    ("submit m @part.rml --kind mill", "--kind: 'mill' is none of simulate, check, run"),
    ("submit m @part.rml --strict", "--watch"),
    ("submit m --slot 7 --kind run --occurrence 2", "--step"),
    ("submit m @part.rml --seen gloves", "'gloves' is nothing to look at"),
    ("submit m @part.rml --not-before tomorrow", "--not-before tomorrow is no time"),
    ("submit m @part.rml --stock 10x20x30 --tool flat:3 --products target", "--products target needs --target or --target-slot"),
    ("submit m @part.rml --stock 10x20x30 --tool flat:3 --target-tolerance 1", "--target-tolerance needs --target"),
    ("submit m @part.rml --stock 10x20 --tool flat:3", "'10x20' is no block"),
    ("submit m @part.rml --stock 10x20x30 --tool flat:3 --project door", "--stock"),
    ("jobs --limit 0", "--limit"),
    ("jobs --limit 1001", "--limit"),
    ("jobs --order first", "--order: 'first' is none of newest, oldest, queue"),
    ("move 17 --priority -101", "--priority"),
    ("move 17 --priority 101", "--priority"),
    ("get m 44 --form text", "--form: 'text' is none of source, object, executable, listing"),
    ("projects list show door", "projects list does not know what to do with 'show'"),
]


class Requests(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.server = AnyServer()
        cls.addClassCleanup(cls.server.close)

    def setUp(self):
        super().setUp()
        self.server.take()
        self.server.answers = {"WatchJob": END}
        self.file("part.rml", STREAM)
        self.file("door.json", '{"title": "Door"}')
        self.file("keys.txt", "0.5 override = 40\n")

    def ask(self, line, **more):
        words = [word.replace("@", f"{self.folder}/") for word in line.split()]
        return ask(*words, **{"server": self.server.address, "cwd": self.folder, **more})

    def asks(self, line, *expected, code=0):
        with self.subTest(line):
            done = self.ask(line)
            self.assertEqual((done.returncode, done.stderr), (code, ""))
            self.assertEqual(self.server.take(), list(expected))

    def test_of_programs_and_projects(self):
        for line, expected in PROGRAMS + PROJECTS:
            self.asks(line, expected)

    def test_of_jobs(self):
        for line, expected in JOBS:
            self.asks(line, expected)

    def test_of_submissions(self):
        for line, job in SUBMITTED:
            with self.subTest(line):
                self.assertEqual(self.ask(f"submit m {line} --request-id r1").stderr, "")
                asked = {"job": {"machine": "machines/m", **job}, "requestId": "r1"}
                self.assertEqual(self.server.take(), [("SubmitJob", asked)])
        job = {"kind": "JOB_KIND_SIMULATE", "machine": "machines/m", "inlineProgram": INLINE, "title": "part.rml", "simulation": {}}
        for option, fields in (("--label a", {"labels": ["a"]}), ("--after-job 3", {"afterJobs": ["jobs/3"]})):
            self.asks(f"submit --request-id r1 {option} m @part.rml", ("SubmitJob", {"job": {**job, **fields}, "requestId": "r1"}))
        self.ask("submit m --slot 7")
        self.ask("submit m --slot 7")
        first, second = (request["requestId"] for _, request in self.server.take())
        self.assertNotEqual(first, second)

    # One that is watched ends as its job does; with --strict a DOUBTFUL verdict is none that is good.
    def test_of_what_is_watched(self):
        self.server.answers["SubmitJob"] = {"name": "jobs/5"}
        watched = ("WatchJob", {"name": "jobs/5", "afterSequence": "0"})
        for words, code in (("", 0), (" --strict", 1)):
            done = self.ask("submit m --slot 7 --watch" + words)
            self.assertEqual((done.returncode, done.stdout), (code, "jobs/5\n"))
            self.assertEqual(self.server.take()[1:], [watched])
            self.asks("watch 5" + words, watched, code=code)

    def test_of_what_is_refused(self):
        for line, said in REFUSED:
            with self.subTest(line):
                done = self.ask(line)
                self.assertEqual((done.returncode, done.stdout, self.server.take()), (2, "", []))
                self.assertIn(said, done.stderr)
                self.assertTrue(done.stderr.startswith("rmlcell: "))

    # What comes goes to standard output, or into the file alone.
    def test_where_products_go(self):
        self.server.answers = {"GetJobPicture": {"content": CONTENT},
                               "StreamJobArtifact": {"chunk": CONTENT},
                               "DownloadProgram": {"chunk": CONTENT}}
        for line in ("picture 17", "artifact 17 left.stl", "get m 7"):
            with self.subTest(line):
                self.assertEqual(self.ask(line).stdout, STREAM)
                self.assertEqual(self.ask(line + " -o @product").stdout, "")
                self.assertEqual((self.folder / "product").read_text(), STREAM)
                (self.folder / "product").unlink()

    def test_a_report_has_the_positions_that_are_wanted(self):
        self.server.answers = {"GetJobReport": {"family": "rml1", "total": {}, "workOrigin": {"x": 10.0},
                                                "finalPosition": {"tip": {"x": 11.0}}}}
        self.assertIn("final tip     1.000, 0.000, 0.000\n", self.ask("report 17").stdout)
        self.assertIn("final tip     11.000, 0.000, 0.000\n", self.ask("report 17 --machine-coordinates").stdout)

    # The flag goes before the environment, and nothing in that is nothing.
    def test_which_server_is_asked(self):
        nobody = f"unix:{self.folder}/nobody"
        for words in ("machines", "projects list", "replay 17", "job 17"):
            with self.subTest(words):
                done = self.ask(f"{words} --server {self.server.address}", server=nobody)
                self.assertNotIn("no server answers", done.stderr)
                self.assertNotEqual(self.server.take(), [])
                done = self.ask(f"{words} --server {nobody}")
                self.assertEqual((done.returncode, self.server.take()), (3, []))
                self.assertIn(f"no server answers at {nobody} ", done.stderr)
        environment = {name: value for name, value in os.environ.items() if name != "RMLCELL_SERVER"}
        for more in ({}, {"RMLCELL_SERVER": ""}):
            done = subprocess.run([BIN / "rmlcell", "machines"], env={**environment, **more}, capture_output=True, text=True,
                                  timeout=60, check=False)
            self.assertEqual(self.server.take(), [])
            self.assertIn(done.returncode, (0, 3))
            if done.returncode == 3:
                self.assertIn("no server answers at 127.0.0.1:50051 ", done.stderr)

    def test_each_is_told_as_json(self):
        for line, member in (("machines", ""), ("job 17", '"name":""'), ("cancel 17", '"name":""'), ("report 17", '"family":""'),
                             ("submit m --slot 7", '"name":""'), ("put m 7 @part.rml", '"etag":""')):
            with self.subTest(line):
                done = self.ask(line + " --json")
                self.assertEqual(done.returncode, 0)
                self.assertIn(member, done.stdout)
                self.assertEqual(done.stdout.startswith("{"), member != "")


if __name__ == "__main__":
    unittest.main()
