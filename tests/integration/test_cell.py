"""The cell as its clients meet it: jobs, programs, projects, bad input, kills."""
import hashlib
import json
import os
import pathlib
import socket
import subprocess
import threading
import time
import unittest
import urllib.error
import urllib.parse
import urllib.request
import uuid

from cell import (BIN, ENDLESS, LONG, ROOT, SHARED, SQUARE, Cell, common_pb2, detail_of, grpc, inline_job, job_pb2,
                  machine_pb2, program_pb2, project_pb2, submit, wait_for_end, wait_until_it_runs)

COMPLETED = 1
FAILED = 3


class WithCell(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell().start()
        cls.addClassCleanup(cls.cell.close)

    def refused(self, call, request, code, our_code):
        with self.assertRaises(grpc.RpcError) as caught:
            call(request, timeout=60)
        self.assertEqual(caught.exception.code(), code, caught.exception.details())
        detail = detail_of(caught.exception)
        self.assertIsNotNone(detail, "no ErrorDetail")
        self.assertEqual(detail.code, our_code)
        return detail


class Jobs(WithCell):
    def test_a_mill_job_runs_to_its_end_and_leaves_its_products(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        events = wait_for_end(stub, job.name)
        self.assertEqual([event.sequence for event in events], list(range(1, len(events) + 1)))
        self.assertEqual(events[0].state, job_pb2.Job.STATE_QUEUED)
        self.assertEqual(events[-1].ended.kind, COMPLETED)
        done = stub.GetJob(job_pb2.GetJobRequest(name=job.name))
        self.assertEqual(done.state, job_pb2.Job.STATE_SUCCEEDED)
        self.assertLessEqual({"report", "toolpath", "picture.svg"}, {artifact.name for artifact in done.artifacts})
        report = stub.GetJobReport(job_pb2.GetJobReportRequest(name=job.name))
        # 10 mm and 10 mm in the work, and the plunge.
        self.assertAlmostEqual(report.total.cut_length_mm - report.total.plunge_length_mm, 20.0, places=3)
        picture = stub.GetJobPicture(job_pb2.GetJobPictureRequest(name=job.name))
        self.assertIn(b"<svg", picture.content)
        blocks = list(stub.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name=job.name)))
        self.assertGreater(len(blocks), 0)

    def test_a_laser_job_ends_with_the_machines_own_code(self):
        stub = self.cell.jobs()
        source = "COORD ABSOL\nVR[0] = 1.\nVR[1] = VR[0] / VR[2]\n"
        job = submit(stub, inline_job("optimo-1", "divide.S", source))
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual((ended.kind, ended.code, ended.place.step), (FAILED, "OPT-E7201", 3))

    def test_a_program_with_errors_is_a_failed_job_with_its_findings(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "wrong.S", "SPEED 101\nMOVE (1.,2.)\n", kind=job_pb2.JOB_KIND_CHECK))
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual(ended.code, "OPT-E7004")
        report = stub.GetJobReport(job_pb2.GetJobReportRequest(name=job.name))
        self.assertEqual([d.code for d in report.diagnostics][:2], ["OPT-E7004", "OPT-E7019"])

    def test_the_same_request_id_gives_the_same_job(self):
        stub = self.cell.jobs()
        request_id = str(uuid.uuid4())
        first = submit(stub, inline_job("mill-1", "a.rml", SQUARE), request_id)
        again = submit(stub, inline_job("mill-1", "a.rml", SQUARE), request_id)
        self.assertEqual(first.name, again.name)
        self.refused(stub.SubmitJob, job_pb2.SubmitJobRequest(job=inline_job("mill-1", "b.rml", "PU;"), request_id=request_id),
                     grpc.StatusCode.ALREADY_EXISTS, "CELL-E9019")

    def test_a_repeated_request_has_its_job_also_when_the_program_is_gone(self):
        stub, name = self.cell.jobs(), "machines/mill-1/programs/51"
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=name, program=program_pb2.ProgramText(file_name="a.rml", content=SQUARE.encode())))
        job = job_pb2.Job(machine="machines/mill-1", kind=job_pb2.JOB_KIND_SIMULATE, program=name)
        request_id = str(uuid.uuid4())
        first = submit(stub, job, request_id)
        self.cell.programs().DeleteProgram(program_pb2.DeleteProgramRequest(name=name))
        self.assertEqual(submit(stub, job, request_id).name, first.name)
        self.refused(stub.SubmitJob, job_pb2.SubmitJobRequest(job=job, request_id=str(uuid.uuid4())),
                     grpc.StatusCode.NOT_FOUND, "CELL-E9004")

    def test_programs_of_a_job_leave_nothing_behind(self):
        stub, programs = self.cell.jobs(), self.cell.programs()
        for slot, text in ((71, "VR[0]=2.\n"), (72, "FUNCTION 71\nDELAY VR[0]\n")):
            programs.PutProgram(program_pb2.PutProgramRequest(
                name=f"machines/optimo-1/programs/{slot}",
                program=program_pb2.ProgramText(file_name=f"{slot}.S", content=text.encode())))
        other = inline_job("optimo-1", "71.S", "IF VL[9] THEN 5\nVL[9]=ON\nCALL 72\nGOTO 6\n5 VR[0]=7.\n6 VI[5]=1\n")
        other.inline_slot = 71
        self.assertEqual(wait_for_end(stub, submit(stub, other).name)[-1].ended.kind, COMPLETED)
        stored = job_pb2.Job(machine="machines/optimo-1", kind=job_pb2.JOB_KIND_SIMULATE,
                             program="machines/optimo-1/programs/72")
        job = submit(stub, stored)
        wait_for_end(stub, job.name)
        report = stub.GetJobReport(job_pb2.GetJobReportRequest(name=job.name))
        self.assertAlmostEqual(report.total.times.dwell_s, 2.0, places=6)

    def test_orders_are_obeyed_while_the_job_tells_of_events(self):
        stub = self.cell.jobs()
        talk = "10 OL[20]=ON\nOL[20]=OFF\nDELAY 0.001\nGOTO 10\n"
        for _ in range(4):
            job = submit(stub, inline_job("optimo-1", "talk.S", talk))
            wait_until_it_runs(stub, job.name)
            stub.HoldJob(job_pb2.HoldJobRequest(name=job.name))
            until = time.monotonic() + 20
            held = False
            while not held and time.monotonic() < until:
                held = any(m.event.HasField("halted") for m in self.events(stub, job.name))
            self.assertTrue(held)
            stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
            self.assertEqual(wait_for_end(stub, job.name, 30)[-1].ended.code, "CELL-E9307")

    def events(self, stub, name):
        last = stub.GetJob(job_pb2.GetJobRequest(name=name)).last_sequence
        for message in stub.WatchJob(job_pb2.WatchJobRequest(name=name, after_sequence=max(0, last - 100),
                                                             events_only=True), timeout=30):
            if message.HasField("event"):
                yield message
                if message.event.sequence >= last:
                    return

    def test_a_job_is_cancelled_while_it_runs(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "endless.S", ENDLESS))
        wait_until_it_runs(stub, job.name)
        stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
        self.assertEqual(wait_for_end(stub, job.name, 30)[-1].ended.code, "CELL-E9307")

    def test_a_watcher_comes_back_without_gap_or_repeat(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "long.S", LONG.format(rounds=3000)))
        whole = wait_for_end(stub, job.name)
        for cut in range(len(whole)):
            rest = [m.event.sequence for m in stub.WatchJob(
                job_pb2.WatchJobRequest(name=job.name, after_sequence=cut, events_only=True)) if m.HasField("event")]
            self.assertEqual(rest, list(range(cut + 1, len(whole) + 1)))
        with self.assertRaises(grpc.RpcError) as caught:  # of another cell, or mistyped: it would wait for ever
            list(stub.WatchJob(job_pb2.WatchJobRequest(name=job.name, after_sequence=len(whole) + 1), timeout=20))
        self.assertEqual(caught.exception.code(), grpc.StatusCode.INVALID_ARGUMENT)

    def test_a_watcher_of_all_jobs_is_never_set_elsewhere_in_silence(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        wait_for_end(stub, job.name)
        watch = stub.WatchJobs(job_pb2.WatchJobsRequest(events_only=True), timeout=30)
        last = next(iter(watch)).snapshot.sequence
        watch.cancel()
        self.assertGreater(last, 0)
        for after in (last + 1_000_000, -1):
            with self.assertRaises(grpc.RpcError) as caught:
                list(stub.WatchJobs(job_pb2.WatchJobsRequest(after_sequence=after), timeout=20))
            self.assertEqual(caught.exception.code(), grpc.StatusCode.INVALID_ARGUMENT)
            self.assertEqual(detail_of(caught.exception).code, "CELL-E9003")
        # The last number itself is good: nothing has come since.
        watch = stub.WatchJobs(job_pb2.WatchJobsRequest(after_sequence=last, events_only=True), timeout=30)
        self.assertTrue(next(iter(watch)).HasField("snapshot"))
        watch.cancel()
        # Over the web port, too.
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.JobService/WatchJobs", None,
                                         {"Accept": "text/event-stream", "Last-Event-ID": str(last + 1_000_000)})
        try:
            with urllib.request.urlopen(request, timeout=20) as answer:
                told = answer.read().decode()
                self.assertIn("event: error", told)
        except urllib.error.HTTPError as error:
            self.assertEqual(error.code, 400)
            told = error.read().decode()
        self.assertIn("CELL-E9003", told)

    def test_budgets_end_a_job_with_their_own_codes(self):
        stub = self.cell.jobs()
        job = inline_job("optimo-1", "endless.S", ENDLESS)
        job.budget.steps = 1000
        self.assertEqual(wait_for_end(stub, submit(stub, job).name)[-1].ended.code, "OPT-E7901")
        job = inline_job("optimo-1", "wait.S", "WAIT IL[20]\n")
        job.budget.virtual_time_s = 5.0
        self.assertEqual(wait_for_end(stub, submit(stub, job).name)[-1].ended.code, "OPT-E7902")
        job = inline_job("optimo-1", "endless.S", ENDLESS)
        job.budget.processor_s = 0.2
        self.assertEqual(wait_for_end(stub, submit(stub, job).name)[-1].ended.code, "CELL-E9303")
        # Report and events count as output, too.
        job = inline_job("mill-1", "square.rml", SQUARE)
        job.budget.output_bytes = 200
        self.assertEqual(wait_for_end(stub, submit(stub, job).name)[-1].ended.code, "CELL-E9306")

    def test_lists_are_filtered_and_paged(self):
        stub = self.cell.jobs()
        names = [submit(stub, inline_job("mill-1", f"{n}.rml", SQUARE, title="paged")).name for n in range(5)]
        for name in names:
            wait_for_end(stub, name)
        token, seen = "", []
        while True:
            page = stub.ListJobs(job_pb2.ListJobsRequest(page_size=2, page_token=token,
                                                         filter="machine = machines/mill-1 AND finished = true"))
            seen += [job.name for job in page.jobs]
            token = page.next_page_token
            if not token:
                break
        self.assertEqual(len(seen), len(set(seen)))
        self.assertLessEqual(set(names), set(seen))

        # A job is the same resource wherever it is read.
        one = stub.GetJob(job_pb2.GetJobRequest(name=names[0]))
        self.assertLessEqual({"report", "toolpath", "picture.svg"}, {artifact.name for artifact in one.artifacts})
        listed = stub.ListJobs(job_pb2.ListJobsRequest(filter="machine = machines/mill-1", page_size=1000)).jobs
        self.assertIn(one, listed)
        watch = stub.WatchJobs(job_pb2.WatchJobsRequest(), timeout=30)
        snapshot = next(iter(watch)).snapshot
        watch.cancel()
        self.assertIn(one, snapshot.jobs)
        machines = self.cell.machines().ListMachines(machine_pb2.ListMachinesRequest()).machines
        self.assertEqual(list(snapshot.machines), list(machines))
        self.refused(stub.ListJobs, job_pb2.ListJobsRequest(filter="colour = red"),
                     grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9107")


class Machines(WithCell):
    def update(self, name, mask=None, **fields):
        request = machine_pb2.UpdateMachineRequest(machine=machine_pb2.Machine(name=f"machines/{name}", **fields))
        if mask is not None:
            request.update_mask.paths.extend(mask)
        return request

    def test_an_update_without_a_mask_changes_what_has_a_value(self):
        stub = self.cell.machines()
        before = stub.UpdateMachine(self.update("mill-1", profile="srm-20", parameters={"SPIN_UP": "3"}))
        after = stub.UpdateMachine(self.update("mill-1", title="By the door", etag=before.etag))
        self.assertEqual((after.title, after.profile, dict(after.parameters)), ("By the door", "srm-20", {"SPIN_UP": "3"}))
        self.refused(stub.UpdateMachine, self.update("mill-1", title="late", etag=before.etag),
                     grpc.StatusCode.ABORTED, "CELL-E9006")
        self.refused(stub.UpdateMachine, self.update("mill-1", ["colour"]), grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")
        self.assertEqual(stub.UpdateMachine(self.update("mill-1", ["profile"])).profile, "")
        emptied = stub.UpdateMachine(self.update("mill-1", ["*"], title="Mill"))
        self.assertEqual((emptied.title, dict(emptied.parameters)), ("Mill", {}))

    def test_a_title_has_two_hundred_characters_of_any_language(self):
        stub = self.cell.machines()
        self.assertEqual(stub.UpdateMachine(self.update("mill-1", title="\u5de5" * 200)).title, "\u5de5" * 200)
        self.refused(stub.UpdateMachine, self.update("mill-1", title="\u5de5" * 201), grpc.StatusCode.INVALID_ARGUMENT,
                     "CELL-E9003")

    def test_travels_that_end_before_they_begin_are_refused(self):
        stub = self.cell.machines()
        bad = grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9011"
        for name, family, low, high in (("optimo-1", "optimo", "TRAVEL_X_MIN", "TRAVEL_X_MAX"),
                                        ("mill-1", "rml1", "X_MIN", "X_MAX")):
            parameters = {low: "100", high: "50"}
            detail = self.refused(stub.UpdateMachine, self.update(name, parameters=parameters), *bad)
            self.assertIn(f"{low} is 100", detail.message)
            self.assertTrue(detail.advice)
            new = machine_pb2.Machine(family=family, parameters=parameters)
            self.refused(stub.CreateMachine, machine_pb2.CreateMachineRequest(machine_id=f"new-{family}", machine=new), *bad)
            self.assertEqual(dict(stub.GetMachine(machine_pb2.GetMachineRequest(name=f"machines/{name}")).parameters), {})


class Programs(WithCell):
    def put(self, machine, slot, file_name, content, **more):
        request = program_pb2.PutProgramRequest(name=f"machines/{machine}/programs/{slot}", **more)
        request.program.file_name = file_name
        request.program.content = content if isinstance(content, bytes) else content.encode()
        return request

    def test_a_program_comes_back_as_it_was_stored(self):
        stub = self.cell.programs()
        text = "; mine\n10   SPEED 20 ; slow\nENDTASK\n"
        stored = stub.PutProgram(self.put("optimo-1", 45, "part.S", text))
        self.assertEqual((stored.title, stored.file_name), ("part", "part.S"))
        content = stub.GetProgramContent(program_pb2.GetProgramContentRequest(name=stored.name))
        self.assertEqual(content.content.decode(), text)
        self.assertEqual(content.sha256, hashlib.sha256(text.encode()).hexdigest())
        # Another writer with an old etag is refused; the slot stays as it was.
        self.refused(stub.PutProgram, self.put("optimo-1", 45, "part.S", "SPEED 5\n", etag="999"),
                     grpc.StatusCode.ABORTED, "CELL-E9006")
        stub.DeleteProgram(program_pb2.DeleteProgramRequest(name=stored.name))
        self.refused(stub.GetProgram, program_pb2.GetProgramRequest(name=stored.name), grpc.StatusCode.NOT_FOUND,
                     "OPT-E7102")

    def test_a_program_with_errors_is_refused_with_place_and_advice(self):
        stub = self.cell.programs()
        detail = self.refused(stub.PutProgram, self.put("optimo-1", 46, "bad.S", "SPEED 20\nSPEED 101\n"),
                              grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7004")
        self.assertEqual((detail.place.line, detail.place.step), (2, 2))
        self.assertTrue(detail.advice)

    def test_ten_thousand_errors_are_answered_and_bounded(self):
        stub = self.cell.programs()
        detail = self.refused(stub.PutProgram, self.put("optimo-1", 46, "bad.S", "SPEED 101\n" * 10_000),
                              grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7004")
        self.assertGreater(detail.diagnostics_dropped, 8000)

    def test_slots_out_of_range_get_the_machines_code(self):
        stub = self.cell.programs()
        for slot in (0, 100, 200):
            self.refused(stub.PutProgram, self.put("optimo-1", slot, "a.S", "SPEED 5\n"),
                         grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7101")
        # 199 is the executable of 99, which needs its object (OPT-1.15).
        self.refused(stub.PutProgram, self.put("optimo-1", 199, "a.X", b"x"), grpc.StatusCode.NOT_FOUND, "OPT-E7102")

    def test_a_mill_has_no_code_for_slots_and_gets_that_of_the_cell(self):
        stub, jobs = self.cell.programs(), self.cell.jobs()
        invalid, missing = grpc.StatusCode.INVALID_ARGUMENT, grpc.StatusCode.NOT_FOUND
        for slot in (0, 100, 199, 200):
            name = f"machines/mill-1/programs/{slot}"
            job = job_pb2.Job(machine="machines/mill-1", kind=job_pb2.JOB_KIND_CHECK, program=name)
            for call, request in ((stub.PutProgram, self.put("mill-1", slot, "a.rml", "PU;")),
                                  (stub.GetProgram, program_pb2.GetProgramRequest(name=name)),
                                  (stub.DeleteProgram, program_pb2.DeleteProgramRequest(name=name)),
                                  (jobs.SubmitJob, job_pb2.SubmitJobRequest(job=job))):
                detail = self.refused(call, request, invalid, "CELL-E9003")
                self.assertIn(f"is {slot}; slots are 1 to 99", detail.message)
        name = "machines/mill-1/programs/88"
        job = job_pb2.Job(machine="machines/mill-1", kind=job_pb2.JOB_KIND_CHECK, program=name)
        for call, request in ((stub.GetProgram, program_pb2.GetProgramRequest(name=name)),
                              (stub.GetProgramContent, program_pb2.GetProgramContentRequest(name=name)),
                              (stub.DeleteProgram, program_pb2.DeleteProgramRequest(name=name)),
                              (jobs.SubmitJob, job_pb2.SubmitJobRequest(job=job))):
            detail = self.refused(call, request, missing, "CELL-E9004")
            self.assertIn(name, detail.message)
            self.assertNotIn("CALL", detail.message + detail.advice)
        for field in ({"inline_slot": 100}, {"simulation": job_pb2.SimulationOptions(programs=[job_pb2.SlotProgram()])}):
            job = inline_job("mill-1", "a.rml", "PU;", **field)
            self.refused(jobs.SubmitJob, job_pb2.SubmitJobRequest(job=job), invalid, "CELL-E9003")

    def test_bad_bytes_are_refused_and_the_server_goes_on(self):
        stub = self.cell.programs()
        self.refused(stub.PutProgram, self.put("optimo-1", 47, "empty.S", b""), grpc.StatusCode.INVALID_ARGUMENT,
                     "CELL-E9017")
        self.refused(stub.PutProgram, self.put("optimo-1", 47, "cut.S", "SPEED 5 ".encode() + b"\xc3"),
                     grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7001")
        self.refused(stub.PutProgram, self.put("optimo-1", 47, "binary.S", b"\x00\xff\xfe\x80" * 5_000),
                     grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7001")
        self.refused(stub.PutProgram, self.put("no-such", 47, "a.S", "SPEED 5\n"), grpc.StatusCode.NOT_FOUND,
                     "CELL-E9009")
        with self.assertRaises(grpc.RpcError) as caught:
            stub.PutProgram(self.put("optimo-1", 47, "big.S", b";" * 5_000_000))
        self.assertEqual(caught.exception.code(), grpc.StatusCode.RESOURCE_EXHAUSTED)
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9007")
        self.assertIn("UploadProgram", detail_of(caught.exception).message)
        self.refused(self.cell.jobs().GetJob, job_pb2.GetJobRequest(name="jobs/" + "9" * 1_000_000),
                     grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")
        self.refused(self.cell.jobs().SubmitJob,
                     job_pb2.SubmitJobRequest(job=inline_job("mill-1", "big.rml", b";" * 5_000_000)),
                     grpc.StatusCode.RESOURCE_EXHAUSTED, "CELL-E9007")
        self.assertEqual(self.cell.machines().GetCell(machine_pb2.GetCellRequest()).version, "0.1.0")

    def upload(self, name, file_name, data, sha256=None, size=None):
        def parts():
            header = program_pb2.UploadProgramRequest.Header(
                name=name, file_name=file_name, size=len(data) if size is None else size,
                sha256=hashlib.sha256(data).hexdigest() if sha256 is None else sha256)
            yield program_pb2.UploadProgramRequest(header=header)
            for at in range(0, len(data), 1 << 20):
                yield program_pb2.UploadProgramRequest(chunk=data[at:at + (1 << 20)])
        return self.cell.programs().UploadProgram(parts(), timeout=120)

    def test_large_programs_come_in_chunks_all_or_nothing(self):
        data = b"PU100,100;PD200,200;\n" * 500_000
        stored = self.upload("machines/mill-1/programs/9", "large.rml", data)
        self.assertEqual(stored.object_bytes, len(data))
        got = b"".join(part.chunk for part in self.cell.programs().DownloadProgram(
            program_pb2.DownloadProgramRequest(name=stored.name)))
        self.assertEqual(got, data)
        with self.assertRaises(grpc.RpcError) as caught:
            self.upload("machines/mill-1/programs/9", "large.rml", data, sha256="0" * 64)
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9016")
        self.assertEqual(self.cell.programs().GetProgram(program_pb2.GetProgramRequest(name=stored.name)).etag, stored.etag)

    def test_the_header_of_an_upload_is_told_what_is_wrong_with_it(self):
        data = b"PU100,100;"
        name = "machines/mill-1/programs/10"
        upper = hashlib.sha256(data).hexdigest().upper()
        self.assertEqual(self.upload(name, "a.rml", data, sha256=upper).object_bytes, len(data))
        limit = self.cell.machines().GetCell(machine_pb2.GetCellRequest()).program_bytes_max
        for sha256, size, code, words in (("junk", None, "CELL-E9003", "64 hexadecimal digits"),
                                          ("g" * 64, None, "CELL-E9003", "64 hexadecimal digits"),
                                          ("", None, "CELL-E9003", "sha256 is missing"),
                                          (None, -1, "CELL-E9003", "size is -1"),
                                          (None, 0, "CELL-E9003", "size is missing"),
                                          (None, limit + 1, "CELL-E9007", "limits.program_bytes")):
            with self.assertRaises(grpc.RpcError) as caught:
                self.upload(name, "a.rml", data, sha256=sha256, size=size)
            detail = detail_of(caught.exception)
            self.assertEqual(detail.code, code)
            self.assertIn(words, detail.message)
            self.assertNotIn("UploadProgram", caught.exception.details())
        with self.assertRaises(grpc.RpcError) as caught:  # a file with nothing in it
            self.upload(name, "a.rml", b"")
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9017")

    def test_a_hundred_megabytes_of_one_byte_are_answered(self):
        with self.assertRaises(grpc.RpcError) as caught:
            self.upload("machines/optimo-1/programs/9", "a.S", b"A" * 100_000_000)
        self.assertIn("OPT-E70", detail_of(caught.exception).code)


class Projects(WithCell):
    def project(self, *programs, processes=(), schedules=()):
        project = project_pb2.Project(title="test")
        for slot, name, text in programs:
            program = project.programs.add(slot=slot)
            program.source.file_name = name
            program.source.content = text.encode()
        for kind, process, values in processes:
            project.processes.add(kind=kind, process=process, values=values)
        for number in schedules:
            project.laser_schedules.add(number=number, power_percent=80.0)
        return project

    def test_transfer_converts_compiles_and_stores_all_or_nothing(self):
        stub = self.cell.projects()
        inch = "COORD ABSOL\nMOVE (1.0, 0.0, 0.0, 0.0, 0.0)\n"
        stub.CreateProject(project_pb2.CreateProjectRequest(
            project_id="good", project=self.project((20, "a.SI", inch), (21, "b.S", "SPEED 5\n"), schedules=(11,))))
        done = stub.TransferProject(project_pb2.TransferProjectRequest(name="projects/good", machine="machines/optimo-1"))
        self.assertEqual([p.name for p in done.programs], ["machines/optimo-1/programs/20", "machines/optimo-1/programs/21"])
        # The object is metric; the source is the programmer's own, under a name that says inch.
        name = "machines/optimo-1/programs/20"
        own = self.cell.programs().GetProgramContent(program_pb2.GetProgramContentRequest(name=name))
        self.assertEqual((own.content.decode(), own.file_name), (inch, "a.SI"))
        object_bytes = self.cell.programs().GetProgramContent(
            program_pb2.GetProgramContentRequest(name=name, form=program_pb2.PROGRAM_FORM_OBJECT)).content
        metric = self.cell.programs().DecompileProgram(program_pb2.DecompileProgramRequest(object=object_bytes))
        self.assertIn("MOVE (25.4, 0.0, 0.0, 0.0, 0.0)", metric.content.decode())
        stub.CreateProject(project_pb2.CreateProjectRequest(
            project_id="bad", project=self.project((22, "a.S", "SPEED 5\n"), (23, "b.S", "SPEED 101\n"))))
        self.refused(stub.TransferProject,
                     project_pb2.TransferProjectRequest(name="projects/bad", machine="machines/optimo-1"),
                     grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7004")
        self.refused(self.cell.programs().GetProgram, program_pb2.GetProgramRequest(name="machines/optimo-1/programs/22"),
                     grpc.StatusCode.NOT_FOUND, "OPT-E7102")

    def test_a_work_without_definition_is_refused_or_gets_one(self):
        stub = self.cell.projects()
        text = "WORK 1,0 /ON\nWORK 1,0 /OFF\n"
        stub.CreateProject(project_pb2.CreateProjectRequest(project_id="bare", project=self.project((24, "a.S", text))))
        self.refused(stub.TransferProject,
                     project_pb2.TransferProjectRequest(name="projects/bare", machine="machines/optimo-1"),
                     grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7401")
        stub.CreateProject(project_pb2.CreateProjectRequest(
            project_id="given", project=self.project((24, "a.S", text), processes=[(1, 0, [6.5, 80.0, 1.5, 95.0])])))
        stub.TransferProject(project_pb2.TransferProjectRequest(name="projects/given", machine="machines/optimo-1",
                                                                insert_missing_definitions=True))
        source = self.cell.programs().GetProgramContent(
            program_pb2.GetProgramContentRequest(name="machines/optimo-1/programs/24")).content.decode()
        self.assertIn("WORKDEF 1,0 (6.5, 80.0, 1.5, 95.0)", source)


class Web(WithCell):
    def post(self, method, body, **headers):
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}/{method}", json.dumps(body).encode(),
                                         {"Content-Type": "application/json", **headers})
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)

    def test_a_client_that_ends_its_sending_gets_its_answer(self):
        body = b"{}"
        head = ("POST /rmlcell.v1.MachineService/ListMachines HTTP/1.1\r\nHost: localhost\r\n"
                f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n").encode()
        for request in (head + body, b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"):
            for _ in range(10):
                with socket.create_connection(("127.0.0.1", self.cell.web_port), timeout=20) as connection:
                    connection.sendall(request)
                    connection.shutdown(socket.SHUT_WR)
                    answer = b""
                    while piece := connection.recv(65536):
                        answer += piece
                self.assertTrue(answer.startswith(b"HTTP/1.1 200"), answer[:80])

    def test_bytes_that_are_no_message_are_told_so(self):
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.MachineService/ListMachines", b"\xff\xff",
            {"Content-Type": "application/proto"})
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(request, timeout=30)
        self.assertEqual(caught.exception.code, 400)
        self.assertEqual(json.load(caught.exception)["code"], "invalid_argument")

    def test_json_by_post_answers_like_the_call(self):
        machines = self.post("rmlcell.v1.MachineService/ListMachines", {})["machines"]
        self.assertEqual([machine["name"] for machine in machines], ["machines/mill-1", "machines/optimo-1"])
        with self.assertRaises(urllib.error.HTTPError) as caught:
            self.post("rmlcell.v1.MachineService/GetMachine", {"name": "machines/none"})
        self.assertEqual(caught.exception.code, 404)
        self.assertEqual(json.load(caught.exception)["code"], "not_found")

    def test_events_of_a_job_stream_and_resume_by_last_event_id(self):
        job = self.post("rmlcell.v1.JobService/SubmitJob", {"job": {
            "kind": "JOB_KIND_SIMULATE", "machine": "machines/mill-1",
            "inlineProgram": {"fileName": "a.rml", "content": "UFUxMDAwLDEwMDA7SDs="}}})
        def ids(**headers):
            message = urllib.parse.quote(json.dumps({"name": job["name"], "eventsOnly": True}))
            request = urllib.request.Request(
                f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.JobService/WatchJob?message={message}", None,
                {"Accept": "text/event-stream", **headers})
            with urllib.request.urlopen(request, timeout=60) as answer:
                return [int(line[3:]) for line in answer.read().decode().splitlines() if line.startswith("id:")]
        whole = ids()
        self.assertEqual(whole, list(range(1, len(whole) + 1)))
        self.assertEqual(ids(**{"Last-Event-ID": "1"}), whole[1:])

    def test_products_have_stable_addresses_with_etag(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        wait_for_end(stub, job.name)
        url = f"http://127.0.0.1:{self.cell.web_port}/v1/{job.name}/artifacts/picture.svg"
        with urllib.request.urlopen(url) as answer:
            etag = answer.headers["ETag"]
            self.assertEqual(answer.headers["Content-Type"], "image/svg+xml")
            self.assertIn(b"<svg", answer.read())
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(urllib.request.Request(url, headers={"If-None-Match": etag}))
        self.assertEqual(caught.exception.code, 304)
        with urllib.request.urlopen(f"http://127.0.0.1:{self.cell.web_port}/v1/{job.name}/artifacts/report") as answer:
            self.assertEqual(json.load(answer)["outcome"]["kind"], "KIND_COMPLETED")
        with urllib.request.urlopen(f"http://127.0.0.1:{self.cell.web_port}/") as page:
            self.assertIn(b"<html", page.read())

    def test_a_form_that_is_none_is_refused(self):
        url = f"http://127.0.0.1:{self.cell.web_port}/v1/machines/optimo-1/programs/61/content"
        def ask(query, body=None):
            request = urllib.request.Request(url + query, body, {"Content-Type": "application/octet-stream"} if body else {})
            try:
                with urllib.request.urlopen(request, timeout=30) as answer:
                    return answer.status, answer.read().decode()
            except urllib.error.HTTPError as error:
                return error.code, error.read().decode()
        self.assertEqual(ask("?file_name=a.S", b"SPEED 5\n")[0], 200)
        for query in ("", "?form=", "?form=source"):
            self.assertEqual(ask(query), (200, "SPEED 5\n"))
        self.assertEqual(ask("?form=listing")[0], 200)
        for query, body in (("?form=bogus", None), ("?form=SOURCE", None), ("?file_name=a.S&form=bogus", b"SPEED 6\n"),
                            ("?file_name=a.S&form=listing", b"SPEED 6\n")):
            status, text = ask(query, body)
            self.assertEqual(status, 400, query)
            self.assertIn("CELL-E9003", text)
        self.assertEqual(ask("?form=source"), (200, "SPEED 5\n"))

    def test_reflection_alone_is_enough_for_a_client(self):
        buf = os.environ.get("RMLCELL_BUF")
        if not buf:
            self.skipTest("buf is not here (RMLCELL_BUF)")
        base = [buf, "curl", "--protocol", "grpc", "--http2-prior-knowledge"]
        url = f"http://127.0.0.1:{self.cell.grpc_port}"
        listed = subprocess.run([*base, "--list-methods", url], capture_output=True, text=True, timeout=60)
        self.assertIn("rmlcell.v1.JobService/SubmitJob", listed.stdout, listed.stderr)
        said = subprocess.run([*base, "-d", '{"code":"348"}', f"{url}/rmlcell.v1.ProgramService/ExplainError"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(json.loads(said.stdout)["errors"][0]["code"], "OPT-E348")


class Kills(unittest.TestCase):
    def setUp(self):
        self.cell = Cell("--workers.lease_ms", "2000")
        self.addCleanup(self.cell.close)
        self.cell.start()

    def test_a_job_survives_the_death_of_its_worker(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "endless.S", ENDLESS))
        wait_until_it_runs(stub, job.name)
        for process in self.cell.worker_processes():
            os.kill(process, 9)
        other = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        self.assertEqual(wait_for_end(stub, other.name, 60)[-1].ended.kind, COMPLETED)
        until = time.monotonic() + 60
        while (seen := stub.GetJob(job_pb2.GetJobRequest(name=job.name))).attempts < 2:
            self.assertLess(time.monotonic(), until, seen)
            time.sleep(0.05)
        # The second attempt may have gone to a worker that was killed a moment later.
        if seen.state != job_pb2.Job.STATE_FAILED:
            wait_until_it_runs(stub, job.name)
            for process in self.cell.worker_processes():
                os.kill(process, 9)
        ended = wait_for_end(stub, job.name, 60)[-1].ended
        self.assertEqual(ended.code, "CELL-E9301")  # two attempts, as the policy says

    def test_nothing_acknowledged_is_lost_when_the_server_is_killed(self):
        stop = threading.Event()
        acknowledged, tried = {}, set()
        lock = threading.Lock()

        def client(number):
            stub = self.cell.jobs()
            count = 0
            while not stop.is_set():
                request_id = f"{number}-{count}"
                with lock:
                    tried.add(request_id)
                while not stop.is_set():
                    try:
                        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE), request_id)
                        with lock:
                            acknowledged.setdefault(request_id, set()).add(job.name)
                        break
                    except grpc.RpcError:
                        time.sleep(0.05)  # repeated with the same id: also when it was done and the answer lost
                count += 1

        threads = [threading.Thread(target=client, args=(n,)) for n in range(4)]
        for thread in threads:
            thread.start()
        for _ in range(3):
            time.sleep(1.0)
            self.cell.kill()
            self.cell.start()
        time.sleep(1.0)
        stop.set()
        for thread in threads:
            thread.join()
        stub = self.cell.jobs()
        self.assertGreater(len(acknowledged), 20)
        names = set()
        for request_id, jobs in acknowledged.items():
            self.assertEqual(len(jobs), 1, f"{request_id} gave {jobs}")
            names |= jobs
        self.assertEqual(len(names), len(acknowledged), "two requests share a job")
        for name in names:
            self.assertEqual(stub.GetJob(job_pb2.GetJobRequest(name=name)).name, name)
        total, token = 0, ""
        while True:
            page = stub.ListJobs(job_pb2.ListJobsRequest(page_size=1000, page_token=token))
            total += len(page.jobs)
            token = page.next_page_token
            if not token:
                break
        self.assertLessEqual(total, len(tried), "a request made two jobs")

    def test_a_watcher_that_is_cut_off_goes_on_where_it_was(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "long.S", LONG.format(rounds=20000)))
        seen = []
        until = time.monotonic() + 90
        while time.monotonic() < until:
            try:
                watch = self.cell.jobs().WatchJob(job_pb2.WatchJobRequest(
                    name=job.name, after_sequence=seen[-1] if seen else 0, events_only=True), timeout=60)
                ended = False
                for message in watch:
                    if message.HasField("event"):
                        seen.append(message.event.sequence)
                        ended = message.event.HasField("ended")
                        if len(seen) == 2:
                            watch.cancel()
                            self.cell.kill()
                            self.cell.start()
                if ended:
                    break
            except grpc.RpcError:
                time.sleep(0.05)
        self.assertEqual(seen, list(range(1, len(seen) + 1)))

    def test_the_server_stops_in_order_within_five_seconds(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "endless.S", ENDLESS))
        wait_until_it_runs(stub, job.name)
        last = []
        watcher = threading.Thread(target=lambda: self.collect(stub, job.name, last))
        watcher.start()
        time.sleep(0.5)
        begin = time.monotonic()
        self.assertEqual(self.cell.stop(), 0)
        self.assertLess(time.monotonic() - begin, 5.0)
        watcher.join()
        self.assertTrue(last[-1].HasField("reconnect"))
        self.cell.start()
        again = self.cell.jobs().GetJob(job_pb2.GetJobRequest(name=job.name))
        self.assertIn(again.state, (job_pb2.Job.STATE_QUEUED, job_pb2.Job.STATE_RUNNING))
        self.assertLessEqual(again.attempts, 1)  # handed back: the attempt does not count
        self.cell.jobs().CancelJob(job_pb2.CancelJobRequest(name=job.name))

    @staticmethod
    def collect(stub, name, messages):
        try:
            for message in stub.WatchJob(job_pb2.WatchJobRequest(name=name)):
                messages.append(message)
        except grpc.RpcError:
            pass


if __name__ == "__main__":
    unittest.main(verbosity=2)
