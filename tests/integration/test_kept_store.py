#!/usr/bin/env python3
"""A store that was written by an earlier build opens for ever: what a server gives of it is what it gave then.

tests/conformance/held_still/ has the database of a cell and what that cell answered. `test_kept_store.py --write`
makes both anew, with the binaries of RMLCELL_BIN; that is a decision (docs/decisions/0028-held-still.md).
"""
import hashlib
import json
import lzma
import sys
import unittest

from google.protobuf import json_format

from cell import (ROOT, Cell, eventually, inline_job, job_pb2, machine_pb2, program_pb2, project_pb2, submit,
                  wait_for_end)

KEPT = ROOT / "tests/conformance/held_still"
DATABASE = KEPT / "cell.db.xz"
ANSWERS = KEPT / "answers.json"

CONTOUR = """; a contour with its beam
WORKDEF 2,0 (15)
COORD ABSOL
PATH LIN
SPEED 20
MOVE (100., 100., 50., 0., 0.)
WORK 2,0/ON
MOVE (200., 100., 50., 0., 0.) /FLY
MOVE (200., 160., 50., 0., 0.)
WORK 2,0/OFF
VR[1] = 2.5
IF IL[3] THEN 20
VI[4] = 7
20 ENDTASK
"""
MILLED = "PA;PA;VS10;!VZ5;!PZ-100,300;!MC1;PU500,500;PD2500,500;PD2500,1500;PD500,1500;PD500,500;PU0,0;!MC0;"
SLOW = "PA;PA;VS1;!PZ0,200;PU0,0;" + "PD9000,100;PD100,9000;" * 50 + "PU0,0;"


def write(cell):
    """Something of all that a store keeps."""
    jobs, machines, programs, projects = cell.jobs(), cell.machines(), cell.programs(), cell.projects()
    machines.CreateMachine(machine_pb2.CreateMachineRequest(
        machine_id="laser-2", machine=machine_pb2.Machine(family="optimo", title="second",
                                                          parameters={"AXIS_SPEED_A": "5"})), timeout=60)
    for machine, slot, name, text in (("optimo-1", 12, "contour.S", CONTOUR), ("mill-1", 3, "milled.rml", MILLED),
                                      ("laser-2", 44, "other.S", "DELAY 1\n")):
        request = program_pb2.PutProgramRequest(name=f"machines/{machine}/programs/{slot}", title=name)
        request.program.file_name, request.program.content = name, text.encode()
        programs.PutProgram(request, timeout=60)
    machines.PutLaserSchedule(machine_pb2.PutLaserScheduleRequest(laser_schedule=machine_pb2.LaserSchedule(
        name="machines/optimo-1/laserSchedules/15", title="thin steel", mode=machine_pb2.LASER_MODE_PULSE,
        power_percent=62.5)), timeout=60)
    projects.TransferProjectFromMachine(project_pb2.TransferProjectFromMachineRequest(
        machine="machines/optimo-1", project_id="kept"), timeout=60)

    def run(job):
        made = submit(jobs, job)
        wait_for_end(jobs, made.name)
        return made.name

    whole = job_pb2.Job(kind=job_pb2.JOB_KIND_SIMULATE, machine="machines/optimo-1",
                        program="machines/optimo-1/programs/12", title="with all products")
    whole.simulation.trace = whole.simulation.series = True
    whole.simulation.variables.extend(["VR[1]", "VI[4]", "OL[20]"])
    whole.simulation.parameters["AXIS_SPEED_X"] = "400"
    key = whole.simulation.inputs.add(virtual_time_ns=1_000_000_000)
    key.input.override_percent = 80.0
    first = run(whole)
    run(job_pb2.Job(kind=job_pb2.JOB_KIND_CHECK, machine="machines/optimo-1", program="machines/optimo-1/programs/12"))
    run(inline_job("optimo-1", "bad.S", "MOVE (1., 2.)\nGOTO 99\n"))  # fails, with findings
    milled = inline_job("mill-1", "milled.rml", MILLED, title="a block")
    stock, tool = milled.simulation.milling.stock, milled.simulation.milling.tool
    stock.size_x_mm, stock.size_y_mm, stock.size_z_mm = 40.0, 30.0, 5.0
    tool.shape, tool.diameter_mm, milled.simulation.milling.cell_mm = 1, 3.0, 0.5
    run(milled)
    paced = inline_job("mill-1", "slow.rml", SLOW, title="cancelled while it ran")
    paced.simulation.pace = 1.0
    name = submit(jobs, paced).name
    assert eventually(lambda: jobs.GetJob(job_pb2.GetJobRequest(name=name)).state == job_pb2.Job.STATE_RUNNING)
    jobs.StopJob(job_pb2.StopJobRequest(name=name))
    jobs.CancelJob(job_pb2.CancelJobRequest(name=name))
    wait_for_end(jobs, name)
    # These wait, and are released when the store is opened.
    waiting = inline_job("optimo-1", "waits.S", CONTOUR, title="held", held=True, priority=5)
    stop = waiting.simulation.breakpoints.add()
    stop.step.program, stop.step.step, stop.condition, stop.passes = 45, 5, "VR[1] = 0", 1
    waiting.inline_slot = 45
    waiting.simulation.inputs.add(virtual_time_ns=60_000_000_000).input.resume.source = 1
    held = submit(jobs, waiting).name
    after = inline_job("mill-1", "after.rml", MILLED, title="behind it")
    after.after_jobs.append(held)
    submit(jobs, after)
    later = inline_job("mill-1", "later.rml", MILLED, title="not before 2100")
    later.not_before_time.FromJsonString("2100-01-01T00:00:00Z")
    submit(jobs, later)
    assert first == "jobs/1"


def plain(message):
    return json_format.MessageToDict(message, including_default_value_fields=True)


def digest(parts):
    return hashlib.sha256(b"".join(parts)).hexdigest()


def answers(cell):
    """All that a server gives of its records, in a form that a text can keep."""
    jobs, machines, programs, projects = cell.jobs(), cell.machines(), cell.programs(), cell.projects()
    told = {"machines": [], "programs": [], "schedules": [], "projects": [], "jobs": {}}
    for machine in machines.ListMachines(machine_pb2.ListMachinesRequest(), timeout=60).machines:
        machine.ClearField("status")  # what it is now, and can do
        machine.ClearField("capabilities")
        told["machines"].append(plain(machine))
        for program in programs.ListPrograms(program_pb2.ListProgramsRequest(parent=machine.name), timeout=60).programs:
            content = programs.GetProgramContent(program_pb2.GetProgramContentRequest(name=program.name), timeout=60)
            told["programs"].append([plain(program), digest([content.content])])
        if machine.family == "optimo":
            schedules = machines.ListLaserSchedules(machine_pb2.ListLaserSchedulesRequest(parent=machine.name), timeout=60)
            told["schedules"].append(plain(schedules))
    for project in projects.ListProjects(project_pb2.ListProjectsRequest(), timeout=60).projects:
        told["projects"].append(plain(projects.GetProject(project_pb2.GetProjectRequest(name=project.name), timeout=60)))
        parts = projects.ExportProject(project_pb2.ExportProjectRequest(name=project.name), timeout=60)
        told["projects"].append(sum(len(part.chunk) for part in parts) > 0)
    for job in jobs.ListJobs(job_pb2.ListJobsRequest(page_size=100), timeout=60).jobs:
        of_job = told["jobs"][job.name] = {"job": plain(jobs.GetJob(job_pb2.GetJobRequest(name=job.name), timeout=60))}
        if not job.HasField("end_time"):
            continue
        of_job["events"] = [plain(event) for event in wait_for_end(jobs, job.name)]
        for artifact in job.artifacts:
            chunks = jobs.StreamJobArtifact(job_pb2.StreamJobArtifactRequest(name=job.name, artifact=artifact.name), timeout=60)
            of_job[artifact.name] = digest([chunk.chunk for chunk in chunks])
        if "report" in of_job:
            of_job["report"] = plain(jobs.GetJobReport(job_pb2.GetJobReportRequest(name=job.name), timeout=60))
            of_job["findings"] = plain(jobs.ListJobFindings(job_pb2.ListJobFindingsRequest(name=job.name), timeout=60))
        if "steps" in of_job:
            of_job["steps"] = plain(jobs.GetStepMap(job_pb2.GetStepMapRequest(name=job.name), timeout=60))
        if "toolpath" in of_job:
            path = list(jobs.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name=job.name), timeout=60))
            of_job["toolpath"] = [plain(path[0].header), digest([part.block for part in path[1:]])]
        if "trace" in of_job:
            records = jobs.StreamJobTrace(job_pb2.StreamJobTraceRequest(name=job.name), timeout=60)
            of_job["trace"] = [plain(record) for part in records for record in part.records]
        if "series" in of_job:
            of_job["series"] = plain(jobs.GetJobSeries(job_pb2.GetJobSeriesRequest(name=job.name, signals=["speed", "axis.X"], buckets=4), timeout=60))
    return json.loads(json.dumps(told, sort_keys=True))


def missing(then, now, place):
    """Where `now` does not have what `then` has; what has been added since then is no matter."""
    if isinstance(then, dict) and isinstance(now, dict):
        for key, value in then.items():
            yield from missing(value, now.get(key), f"{place}.{key}")
    elif isinstance(then, list) and isinstance(now, list) and len(then) == len(now):
        for number, (one, other) in enumerate(zip(then, now)):
            yield from missing(one, other, f"{place}[{number}]")
    elif then != now:
        yield f"{place}: {now!r}, was {then!r}"


class KeptStore(unittest.TestCase):
    maxDiff = 4000

    @classmethod
    def setUpClass(cls):
        cls.cell = Cell()
        cls.addClassCleanup(cls.cell.close)
        folder = cls.cell.folder / "store"
        folder.mkdir(mode=0o700)
        (folder / "cell.db").write_bytes(lzma.decompress(DATABASE.read_bytes()))
        cls.cell.start()

    def test_1_gives_what_it_gave(self):
        found = list(missing(json.loads(ANSWERS.read_text()), answers(self.cell), "answers"))
        self.assertEqual(found, [])

    def test_1_a_change_would_be_found(self):
        then = {"a": [{"b": 1}, 2.5], "c": "x"}
        self.assertEqual(list(missing(then, {"a": [{"b": 1, "new": 3}, 2.5], "c": "x", "d": 4}, "r")), [])
        for now in ({"a": [{"b": 2}, 2.5], "c": "x"}, {"a": [{"b": 1}], "c": "x"}, {"a": [{}, 2.5], "c": "x"},
                    {"a": [{"b": 1}, 2.5]}):
            self.assertEqual(len(list(missing(then, now, "r"))), 1, now)

    def test_2_what_waited_goes_on(self):
        jobs = self.cell.jobs()
        held = next(job for job in jobs.ListJobs(job_pb2.ListJobsRequest(), timeout=60).jobs if job.title == "held")
        self.assertEqual(held.wait_reason, job_pb2.WAIT_REASON_HELD)
        self.assertEqual(held.priority, 5)
        jobs.ResumeJob(job_pb2.ResumeJobRequest(name=held.name), timeout=60)
        told = wait_for_end(jobs, held.name)
        # Its breakpoint halted it, and its key let it go on.
        self.assertEqual([event.WhichOneof("what") for event in told if event.WhichOneof("what") in ("halted", "resumed")],
                         ["halted", "resumed"])
        behind = next(job for job in jobs.ListJobs(job_pb2.ListJobsRequest(), timeout=60).jobs if job.title == "behind it")
        wait_for_end(jobs, behind.name)
        done = [jobs.GetJob(job_pb2.GetJobRequest(name=name), timeout=60).state for name in (held.name, behind.name)]
        self.assertEqual(done, [job_pb2.Job.STATE_SUCCEEDED] * 2)


def make():
    cell = Cell()
    try:
        cell.start()
        write(cell)
        ANSWERS.write_text(json.dumps(answers(cell), indent=1, sort_keys=True) + "\n")
        cell.stop()
        DATABASE.write_bytes(lzma.compress((cell.folder / "store" / "cell.db").read_bytes(), preset=9))
    finally:
        cell.close()


if __name__ == "__main__":
    if "--write" in sys.argv:
        make()
    else:
        unittest.main(verbosity=2)
