#!/usr/bin/env python3
"""Machines and their laser schedules as gRPC clients see them: every field, every refusal."""
import unittest

from cell import (Cell, WithCell, cell_pb2, common_pb2, detail_of, eventually, grpc, inline_job, job_pb2, machine_pb2,
                  program_pb2, submit, wait_for_end)

BAD = grpc.StatusCode.INVALID_ARGUMENT
UNKNOWN = grpc.StatusCode.NOT_FOUND


def create(machine_id, family="rml1", validate_only=False, **fields):
    return machine_pb2.CreateMachineRequest(machine_id=machine_id, validate_only=validate_only,
                                            machine=machine_pb2.Machine(family=family, **fields))


class Cells(WithCell):
    def test_a_cell_tells_what_it_is(self):
        stub = self.cell.cell_service()
        cell = eventually(lambda: next((cell for cell in [stub.GetCell(cell_pb2.GetCellRequest())]
                                        if cell.workers == 4), None))
        self.assertEqual((cell.jobs_queued, cell.jobs_running), (0, 0))
        self.assertEqual(cell.unary_program_bytes_max, 3 << 20)
        self.assertEqual(cell.program_bytes_max, 256 << 20)
        self.assertTrue(cell.instance_id)
        self.assertGreater(cell.started_at.seconds, 1_700_000_000)
        self.assertGreaterEqual(cell.server_time.ToNanoseconds(), cell.started_at.ToNanoseconds())
        self.assertFalse(cell.log_in_needed)

    def test_families_tell_what_they_are(self):
        families = {one.id: one for one in self.cell.machines().ListFamilies(machine_pb2.ListFamiliesRequest()).families}
        self.assertEqual(set(families), {"optimo", "rml1"})
        optimo, mill = families["optimo"], families["rml1"]
        self.assertEqual(list(optimo.axes), ["X", "Y", "Z", "A", "B"])
        self.assertTrue(optimo.has_executables and optimo.has_schedules)
        self.assertFalse(mill.has_executables or mill.has_schedules)
        self.assertIn(".S", optimo.extensions)
        self.assertTrue(optimo.title and mill.title)
        speed = next(one for one in optimo.parameters if one.name == "CYCLE")  # OPT-7.69
        self.assertEqual((speed.unit, speed.default_value, speed.minimum, speed.maximum), ("s", "0.048", 0.001, 1.0))
        self.assertTrue(speed.description)
        self.assertEqual(list(speed.choices), [])
        word = next(one for one in optimo.parameters if one.name == "COORD_DEFAULT")  # OPT-2.09
        self.assertEqual((list(word.choices), word.default_value), (["ROBOT", "ABSOL"], "ROBOT"))
        profiles = {one.id: one for one in optimo.profiles}
        self.assertEqual(dict(profiles["mc-1000ipm"].parameters), {"VMAX": "423.333"})
        self.assertEqual(dict(profiles["pw-1993"].parameters), {"COORD_DEFAULT": "ABSOL", "PATH_DEFAULT": "LIN"})
        self.assertTrue(profiles["standard"].title)


class Machines(WithCell):
    def test_a_machine_comes_back_as_it_was_made(self):
        stub = self.cell.machines()
        made = stub.CreateMachine(create("made", title="By the door", profile="srm-20", parameters={"SPIN_UP": "3"}))
        self.assertEqual((made.name, made.family, made.title, made.profile, dict(made.parameters)),
                         ("machines/made", "rml1", "By the door", "srm-20", {"SPIN_UP": "3"}))
        self.assertTrue(made.etag)
        self.assertEqual(made.connection.kind, machine_pb2.MachineConnection.KIND_VIRTUAL)
        self.assertEqual((made.status.machine, made.status.state),
                         ("machines/made", common_pb2.MACHINE_STATE_IDLE))
        self.assertEqual(made.create_time, made.update_time)
        self.assertGreater(made.create_time.seconds, 1_700_000_000)
        self.assertEqual(stub.GetMachine(machine_pb2.GetMachineRequest(name="machines/made")), made)
        self.refused(stub.CreateMachine, create("made"), grpc.StatusCode.ALREADY_EXISTS, "CELL-E9005")
        changed = stub.UpdateMachine(machine_pb2.UpdateMachineRequest(
            machine=machine_pb2.Machine(name="machines/made", title="At the window")))
        self.assertEqual(changed.create_time, made.create_time)
        self.assertNotEqual(changed.etag, made.etag)

    def test_what_is_only_validated_is_not_made(self):
        stub = self.cell.machines()
        shown = stub.CreateMachine(create("dry", validate_only=True, title="Dry"))
        self.assertEqual((shown.name, shown.title, shown.etag), ("machines/dry", "Dry", ""))
        self.refused(stub.GetMachine, machine_pb2.GetMachineRequest(name="machines/dry"), UNKNOWN, "CELL-E9009")
        before = stub.GetMachine(machine_pb2.GetMachineRequest(name="machines/mill-1"))
        request = machine_pb2.UpdateMachineRequest(validate_only=True, machine=machine_pb2.Machine(
            name="machines/mill-1", title="Dry"))
        self.assertEqual(stub.UpdateMachine(request).title, "Dry")
        self.assertEqual(stub.GetMachine(machine_pb2.GetMachineRequest(name="machines/mill-1")), before)

    def test_bad_machines_are_refused(self):
        stub = self.cell.machines()
        for request, code in ((create("Upper"), "CELL-E9003"), (create(""), "CELL-E9003"),
                              (create("m", family="lathe"), "CELL-E9008"), (create("m", title="t" * 201), "CELL-E9003"),
                              (create("m", parameters={"COLOUR": "1"}), "CELL-E9010"),
                              (create("m", parameters={"SPIN_UP": "-1"}), "CELL-E9011")):
            self.refused(stub.CreateMachine, request, BAD, code)
        # Of a text without end a thousand characters come back, at most.
        for length, shown in ((900, False), (2000, True)):
            detail = self.refused(stub.CreateMachine, create("m", family="x" * length), BAD, "CELL-E9008")
            self.assertEqual(detail.message.endswith("..."), shown)
            self.assertEqual(len(detail.message) == 1003, shown)
        lathe = self.refused(stub.CreateMachine, create("m", family="lathe"), BAD, "CELL-E9008")
        self.assertIn("there are optimo rml1", lathe.message)
        self.refused(stub.UpdateMachine, machine_pb2.UpdateMachineRequest(
            machine=machine_pb2.Machine(name="machines/mill-1", family="optimo")), BAD, "CELL-E9003")
        for name, status, code in (("machines/none", UNKNOWN, "CELL-E9009"), ("mill-1", BAD, "CELL-E9003")):
            self.refused(stub.GetMachine, machine_pb2.GetMachineRequest(name=name), status, code)
            self.refused(stub.UpdateMachine, machine_pb2.UpdateMachineRequest(
                machine=machine_pb2.Machine(name=name, title="x")), status, code)
        self.refused(stub.UpdateMachine, machine_pb2.UpdateMachineRequest(
            machine=machine_pb2.Machine(name="machines/mill-1", title="x", etag="odd")), grpc.StatusCode.ABORTED, "CELL-E9006")


class DeletedMachines(WithCell):
    def test_a_machine_goes_with_its_memory(self):
        stub = self.cell.machines()
        made = stub.CreateMachine(create("old"))
        text = common_pb2.ProgramText(file_name="p.rml", content=b"PA;VS5;!VZ5;PU0,0;Z0,0,-100;PU0,0;")
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(name="machines/old/programs/7", program=text))
        delete = machine_pb2.DeleteMachineRequest
        self.refused(stub.DeleteMachine, delete(name="machines/old", etag="99"), grpc.StatusCode.ABORTED, "CELL-E9006")
        self.refused(stub.DeleteMachine, delete(name="old"), BAD, "CELL-E9003")
        stub.DeleteMachine(delete(name="machines/old", etag=made.etag))
        self.refused(stub.DeleteMachine, delete(name="machines/old"), UNKNOWN, "CELL-E9009")
        self.assertNotIn("machines/old", [one.name for one in stub.ListMachines(machine_pb2.ListMachinesRequest()).machines])
        again = stub.CreateMachine(create("old"))
        self.assertNotEqual(again.etag, made.etag)
        programs = self.cell.programs().ListPrograms(program_pb2.ListProgramsRequest(parent="machines/old"))
        self.assertEqual(list(programs.programs), [])

    def test_a_machine_that_works_stays(self):
        stub = self.cell.machines()
        stub.CreateMachine(create("busy"))
        job = inline_job("busy", "p.rml", "PA;VS1;!VZ1;PU0,0;Z0,0,-100;Z4000,0,-100;PU0,0;")
        job.simulation.pace = 1.0
        name = submit(self.cell.jobs(), job).name
        delete = machine_pb2.DeleteMachineRequest(name="machines/busy")
        self.refused(stub.DeleteMachine, delete, grpc.StatusCode.FAILED_PRECONDITION, "CELL-E9015")
        self.refused(self.cell.jobs().DeleteJob, job_pb2.DeleteJobRequest(name=name),
                     grpc.StatusCode.FAILED_PRECONDITION, "CELL-E9015")
        self.cell.jobs().CancelJob(job_pb2.CancelJobRequest(name=name))
        wait_for_end(self.cell.jobs(), name)
        stub.DeleteMachine(delete)
        # What it did can still be read.
        self.assertEqual(self.cell.jobs().GetJob(job_pb2.GetJobRequest(name=name)).machine, "machines/busy")


class Pages(unittest.TestCase):
    """A page has a hundred machines when nothing is asked for, and a thousand at most."""
    MANY = 1002

    @classmethod
    def setUpClass(cls):
        cls.cell = Cell(workers=0).start()
        cls.addClassCleanup(cls.cell.close)
        stub = cls.cell.machines()
        made = [stub.CreateMachine.future(create(f"n-{k:04}")) for k in range(cls.MANY - 2)]
        for one in made:
            one.result()

    def page(self, size, token=""):
        return self.cell.machines().ListMachines(machine_pb2.ListMachinesRequest(page_size=size, page_token=token))

    def test_sizes(self):
        self.assertEqual(len(self.page(0).machines), 100)
        self.assertEqual(len(self.page(1).machines), 1)
        self.assertEqual(len(self.page(1000).machines), 1000)
        self.assertEqual(len(self.page(1001).machines), 1000)
        with self.assertRaises(grpc.RpcError) as caught:
            self.page(-1)
        self.assertEqual(caught.exception.code(), BAD)

    def test_all_come_once_and_in_order(self):
        names, token, pages = [], "", 0
        while pages == 0 or token:
            page = self.page(501, token)
            names += [machine.name for machine in page.machines]
            token, pages = page.next_page_token, pages + 1
        self.assertEqual(pages, 2)  # 1002 are two full pages, and no empty one
        self.assertEqual(names, sorted(names))
        self.assertEqual(len(set(names)), self.MANY)


class Schedules(WithCell):
    def put(self, number, machine="optimo-1", **fields):
        return machine_pb2.PutLaserScheduleRequest(laser_schedule=machine_pb2.LaserSchedule(
            name=f"machines/{machine}/laserSchedules/{number}", **fields))

    def listed(self, machine="optimo-1"):
        return list(self.cell.machines().ListLaserSchedules(machine_pb2.ListLaserSchedulesRequest(
            parent=f"machines/{machine}")).laser_schedules)

    def test_a_schedule_comes_back_as_it_was_put(self):
        stub = self.cell.machines()
        kept = stub.PutLaserSchedule(self.put(12, title="Steel 3 mm", mode=machine_pb2.LASER_MODE_PULSE, power_percent=62.5))
        self.assertEqual((kept.name, kept.title, kept.mode, kept.power_percent),
                         ("machines/optimo-1/laserSchedules/12", "Steel 3 mm", machine_pb2.LASER_MODE_PULSE, 62.5))
        self.assertIn(kept, self.listed())
        plain = stub.PutLaserSchedule(self.put(13, power_percent=100.0))
        self.assertEqual((plain.mode, plain.power_percent), (machine_pb2.LASER_MODE_CW, 100.0))
        self.assertEqual(stub.PutLaserSchedule(self.put(14, power_percent=0.0)).power_percent, 0.0)
        changed = stub.PutLaserSchedule(self.put(12, power_percent=10.0, etag=kept.etag))
        self.assertNotEqual(changed.etag, kept.etag)
        self.refused(stub.PutLaserSchedule, self.put(12, power_percent=20.0, etag=kept.etag),
                     grpc.StatusCode.ABORTED, "CELL-E9006")
        self.assertEqual(stub.GetLaserSchedule(machine_pb2.GetLaserScheduleRequest(name=kept.name)), changed)
        delete = machine_pb2.DeleteLaserScheduleRequest(name=kept.name)
        stub.DeleteLaserSchedule(delete)
        self.assertEqual([one.name.rsplit("/", 1)[1] for one in self.listed()], ["13", "14"])
        self.refused(stub.DeleteLaserSchedule, delete, UNKNOWN, "CELL-E9004")
        get = machine_pb2.GetLaserScheduleRequest
        self.refused(stub.GetLaserSchedule, get(name=kept.name), UNKNOWN, "CELL-E9004")
        self.refused(stub.GetLaserSchedule, get(name="machines/none/laserSchedules/1"), UNKNOWN, "CELL-E9009")
        self.refused(stub.GetLaserSchedule, get(name="none"), BAD, "CELL-E9003")

    def test_bad_schedules_are_refused(self):
        stub = self.cell.machines()
        for bad in (self.put(1, power_percent=100.01), self.put(1, power_percent=-0.01), self.put(1, mode=7),
                    self.put(1, title="t" * 201), self.put("x")):
            self.refused(stub.PutLaserSchedule, bad, BAD, "CELL-E9003")
        self.refused(stub.PutLaserSchedule, self.put(1, power_percent=float("nan")), BAD, "CELL-E9003")
        self.refused(stub.PutLaserSchedule, self.put(1, etag="odd"), grpc.StatusCode.ABORTED, "CELL-E9006")
        self.refused(stub.PutLaserSchedule, self.put(1, machine="none"), UNKNOWN, "CELL-E9009")
        self.refused(stub.PutLaserSchedule, self.put(1, machine="mill-1"), grpc.StatusCode.FAILED_PRECONDITION,
                     "CELL-E9015")
        for number in (0, 64):
            self.refused(stub.PutLaserSchedule, self.put(number), BAD, "OPT-E7403")
            self.refused(stub.DeleteLaserSchedule, machine_pb2.DeleteLaserScheduleRequest(
                name=f"machines/optimo-1/laserSchedules/{number}"), BAD, "OPT-E7403")
        self.refused(stub.ListLaserSchedules, machine_pb2.ListLaserSchedulesRequest(parent="machines/none"), UNKNOWN,
                     "CELL-E9009")
        self.refused(stub.ListLaserSchedules, machine_pb2.ListLaserSchedulesRequest(parent="none"), BAD, "CELL-E9003")
        self.refused(stub.DeleteLaserSchedule, machine_pb2.DeleteLaserScheduleRequest(name="none"), BAD, "CELL-E9003")
        self.assertEqual(self.listed("mill-1"), [])


class Workers(WithCell):
    def test_a_worker_says_hello_first(self):
        work = self.cell.channel().stream_stream("/rmlcell.v1.WorkerService/Work")
        with self.assertRaises(grpc.RpcError) as caught:
            list(work(iter([b""]), timeout=60))
        self.assertEqual(caught.exception.code(), BAD)
        detail = detail_of(caught.exception)
        self.assertEqual((detail.code, detail.message), ("CELL-E9003", "the first message must be hello"))


class Orders(WithCell):
    """Orders to jobs that cannot take them."""

    def test_orders_that_make_no_sense_are_refused(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "p.rml", "PA;VS5;!VZ5;PU0,0;Z0,0,-100;PU0,0;"))
        wait_for_end(stub, job.name)
        ended = grpc.StatusCode.FAILED_PRECONDITION, "CELL-E9015"
        self.refused(stub.HoldJob, job_pb2.HoldJobRequest(name=job.name), *ended)
        self.refused(stub.StopJob, job_pb2.StopJobRequest(name=job.name), *ended)
        self.refused(stub.ResumeJob, job_pb2.ResumeJobRequest(name=job.name), *ended)
        self.refused(stub.SetJobOverride, job_pb2.SetJobOverrideRequest(name=job.name, override_percent=145.0), *ended)
        self.assertEqual(stub.CancelJob(job_pb2.CancelJobRequest(name=job.name)).state, job_pb2.Job.STATE_SUCCEEDED)
        for percent in (0.0, -1.0, 145.01, float("nan")):
            self.refused(stub.SetJobOverride, job_pb2.SetJobOverrideRequest(name=job.name, override_percent=percent),
                         BAD, "CELL-E9003")
        calls = ((stub.GetJob, job_pb2.GetJobRequest), (stub.CancelJob, job_pb2.CancelJobRequest),
                 (stub.HoldJob, job_pb2.HoldJobRequest), (stub.StopJob, job_pb2.StopJobRequest), (stub.ResumeJob, job_pb2.ResumeJobRequest),
                 (stub.GetJobReport, job_pb2.GetJobReportRequest), (stub.GetJobPicture, job_pb2.GetJobPictureRequest))
        for call, request in calls:
            self.refused(call, request(name="jobs/999999"), UNKNOWN, "CELL-E9004")
            self.refused(call, request(name="job/1"), BAD, "CELL-E9003")


if __name__ == "__main__":
    unittest.main(verbosity=2)
