"""What the cell keeps: machines, programs, projects."""
import hashlib
import json
import os
import signal
import unittest
import urllib.request

from cell import (WithCell, cell_pb2, common_pb2, detail_of, grpc, inline_job, job_pb2, machine_pb2, program_pb2, project_pb2)
from live import MILL, LiveTestCase


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

    def content(self, content, size=None, sha256=None, pieces=3):
        header = program_pb2.UploadContentRequest.Header(
            size=len(content) if size is None else size,
            sha256=hashlib.sha256(content).hexdigest() if sha256 is None else sha256)
        yield program_pb2.UploadContentRequest(header=header)
        step = max(1, len(content) // pieces)
        for at in range(0, len(content), step):
            yield program_pb2.UploadContentRequest(chunk=content[at:at + step])

    def test_bytes_without_a_slot_are_named_by_a_job(self):
        stub = self.cell.programs()
        content = b"; large\n" + b"DELAY 0.001\n" * 200_000
        kept = stub.UploadContent(self.content(content))
        self.assertEqual((kept.sha256, kept.size), (hashlib.sha256(content).hexdigest(), len(content)))
        bad, invalid = grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003"
        self.refused(stub.UploadContent, self.content(b"SPEED 20\n", sha256=""), bad, invalid)
        self.refused(stub.UploadContent, self.content(b"SPEED 20\n", sha256="no digest"), bad, invalid)
        self.refused(stub.UploadContent, self.content(b"SPEED 20\n", size=-1), bad, invalid)
        self.refused(stub.UploadContent, self.content(b"SPEED 20\n", size=8), bad, "CELL-E9016")
        self.refused(stub.UploadContent, self.content(b"SPEED 20\n", sha256="ab" * 32), bad, "CELL-E9016")
        job = job_pb2.Job(machine="machines/optimo-1", kind=job_pb2.JOB_KIND_CHECK)
        job.uploaded_program.file_name = "part.S"
        for wrong, code, ours in (("", bad, invalid), ("ab" * 32, grpc.StatusCode.NOT_FOUND, "CELL-E9004")):
            job.uploaded_program.sha256 = wrong
            self.refused(self.cell.jobs().SubmitJob, job_pb2.SubmitJobRequest(job=job), code, ours)
        job.uploaded_program.sha256 = kept.sha256
        self.assertEqual(self.cell.jobs().SubmitJob(job_pb2.SubmitJobRequest(job=job)).uploaded_program.sha256, kept.sha256)

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

    # OPT-E.7301: a check says it; the program can be stored all the same, as on the control.
    def test_a_check_follows_the_motion(self):
        stub = self.cell.programs()
        request = program_pb2.CheckProgramRequest(machine="machines/optimo-1")
        request.program.file_name = "far.S"
        request.program.content = b"COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n"
        findings = stub.CheckProgram(request).findings
        self.assertFalse(findings.ok)
        self.assertEqual([(d.code, d.place.step, d.virtual_time_ns) for d in findings.diagnostics], [("OPT-E7301", 2, 0)])
        stub.PutProgram(self.put("optimo-1", 46, "far.S", request.program.content))
        wide = machine_pb2.Machine(name="machines/optimo-1", parameters={"TRAVEL_X_MAX": "9500"})
        before = self.cell.machines().GetMachine(machine_pb2.GetMachineRequest(name=wide.name))
        self.cell.machines().UpdateMachine(machine_pb2.UpdateMachineRequest(machine=wide))
        self.assertTrue(stub.CheckProgram(request).findings.ok)
        restore = machine_pb2.UpdateMachineRequest(machine=machine_pb2.Machine(
            name=wide.name, parameters=dict(before.parameters)))
        restore.update_mask.paths.append("parameters")
        self.cell.machines().UpdateMachine(restore)

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
        self.assertEqual(self.cell.cell_service().GetCell(cell_pb2.GetCellRequest()).version, "0.1.0")

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
        limit = self.cell.cell_service().GetCell(cell_pb2.GetCellRequest()).program_bytes_max
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
        self.assertEqual([(item.name, item.change) for item in done.items],
                         [("machines/optimo-1/programs/20", project_pb2.TRANSFER_CHANGE_ADD),
                          ("machines/optimo-1/programs/21", project_pb2.TRANSFER_CHANGE_ADD),
                          ("machines/optimo-1/laserSchedules/11", project_pb2.TRANSFER_CHANGE_ADD)])
        # The object is metric; the source is the programmer's own, under a name that says inch.
        name = "machines/optimo-1/programs/20"
        own = self.cell.programs().GetProgramContent(program_pb2.GetProgramContentRequest(name=name))
        self.assertEqual((own.content.decode(), own.file_name), (inch, "a.SI"))
        object_bytes = self.cell.programs().GetProgramContent(
            program_pb2.GetProgramContentRequest(name=name, form=common_pb2.PROGRAM_FORM_OBJECT)).content
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

    # An answer may be longer than the 4 MiB that gRPC takes by itself: also behind the web port.
    def test_a_long_list_comes_through_the_web_port(self):
        names = [f"long-{number}" for number in range(70)]
        for name in names:
            self.cell.projects().CreateProject(project_pb2.CreateProjectRequest(project_id=name, project={"notes": 65_000 * "n"}))
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.ProjectService/ListProjects", b"{}",
                                         {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=60) as answer:
            listed = {project["name"] for project in json.load(answer)["projects"]}
        self.assertLessEqual({f"projects/{name}" for name in names}, listed)


class Hosted(LiveTestCase):
    # LIVE-2.03: the server says where it hears nothing of a host.
    def test_a_host_that_falls_silent_is_lost(self):
        self.live.enable()
        host = self.live.host()
        os.kill(host, signal.SIGSTOP)
        self.live.wait("LOST")
        os.kill(host, signal.SIGCONT)

    # LIVE-5.03: what is stored is in the machine before its next order; what a run is in stays, and nothing else does.
    def test_a_program_that_runs_stays(self):
        self.live.enable()
        self.live.acquire()
        self.live.store(5)
        self.live.ask("StartMachine", program=5)
        self.live.store(6)
        delete = self.cell.programs().DeleteProgram
        with self.assertRaises(grpc.RpcError) as in_use:
            delete(program_pb2.DeleteProgramRequest(name=f"{MILL}/programs/5"))
        self.assertEqual(detail_of(in_use.exception).code, "CELL-E9421")
        delete(program_pb2.DeleteProgramRequest(name=f"{MILL}/programs/6"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
