#!/usr/bin/env python3
"""RUN jobs: from the queue to a machine that lives, over gRPC, held, cancelled, cut off and found again (live.md 5)."""
import os
import random
import signal
import subprocess
import time
import unittest

from cell import BIN, awaited, detail_of, grpc, job_pb2, machine_pb2, program_pb2
from live import MILL, SQUARE, Live, new_id
from rmlcell.v1.common_pb2 import MachineState, VERDICT_BAD  # noqa: E402
from rmlcell.v1.machine_status_pb2 import HoldReason  # noqa: E402
from runs import SHORT, RunTestCase  # noqa: E402

# The square five times: at ten times the speed its cuts take 40 s, however late somebody comes who wants to end its host.
AROUND = SQUARE.replace("PU0,0;", 4 * "PD3000,1000,3000,3000,1000,3000,1000,1000;" + "PU0,0;")
# Moves for some forty seconds; half a second of them at a hundred times the speed.
TO_AND_FRO = "PA;PA;VS10;" + 30 * "PU2000,0;PU0,0;"


class RunsTest(RunTestCase):
    # LIVE-5.07: what a run compiled is in the store behind its end, of a job and of nobody's.
    def test_executables_of_a_run_are_kept(self):
        live = Live(self, self.cell, "machines/optimo-1")
        live.enable()
        live.acquire(take_over=True, reason="a test")
        live.ask("SetFactor", factor=100.0)
        live.store(46, "CALL 47\nDELAY 0.1\n", "a.S")
        live.store(47, "DELAY 0.1\n", "b.S")
        live.store(48, "DELAY 0.1\n", "c.S")

        def kept():
            listed = self.cell.programs().ListPrograms(program_pb2.ListProgramsRequest(parent="machines/optimo-1"))
            return {int(one.name.split("/")[-1]) for one in listed.programs if one.HasField("executable_bytes")}

        self.assertEqual(kept(), set())
        live.ask("ReleaseControl")
        name = self.cell.jobs().SubmitJob(job_pb2.SubmitJobRequest(request_id=new_id(), job={
            "kind": "JOB_KIND_RUN", "machine": "machines/optimo-1", "program": "machines/optimo-1/programs/46"})).name
        self.assertEqual(self.becomes(name, "SUCCEEDED", "FAILED"), "SUCCEEDED", self.job(name).outcome)
        self.assertEqual(kept(), {46, 47})
        live.acquire()
        live.ask("StartMachine", program=48)
        awaited(lambda: kept() == {46, 47, 48})

    # LIVE-5.04, LIVE-5.07: RUNNING before it begins, then what happens, then its end, each once.
    def test_a_run_from_its_submission_to_its_end(self):
        self.enable()
        name = self.submit()
        self.assertEqual(self.becomes(name, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        events = self.events(name)
        self.assertEqual([one.sequence for one in events], list(range(1, len(events) + 1)))
        kinds = [one.WhichOneof("what") for one in events]
        self.assertEqual(kinds[:2], ["state", "state"])
        self.assertEqual(kinds.count("run_begun"), 1)
        self.assertEqual([one for one in kinds if one != "products_made"][-1], "ended")  # which may be made by then
        begun = next(one.run_begun for one in events if one.HasField("run_begun"))
        self.assertEqual((begun.job, begun.source), (name, 2))  # START_SOURCE_QUEUE
        job = self.job(name)
        self.assertEqual((job.attempts, job.attempts_max), (1, 1))
        self.assertGreater(job.outcome.cycle_time_ns, 3 * 10**8)
        self.assertEqual(MachineState.Name(self.live.status().state), "MACHINE_STATE_IDLE")

    # LIVE-3.41, LIVE-5.08: report, pictures and verdict come behind the end, made of what was recorded.
    def test_a_run_has_a_report_behind_its_end(self):
        self.enable()
        name = self.submit()
        self.assertEqual(self.becomes(name, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        awaited(lambda: self.events(name)[-1].HasField("products_made"))
        job = self.job(name)
        names = {one.name for one in job.artifacts}
        self.assertLessEqual({"recording", "report", "toolpath", "picture.svg"}, names)
        report = self.cell.jobs().GetJobReport(job_pb2.GetJobReportRequest(name=name))
        self.assertAlmostEqual(report.total.times.cycle_s, job.outcome.cycle_time_ns * 1e-9)
        self.assertEqual(report.outcome.verdict, job.outcome.verdict)
        self.assertEqual(report.outcome.verdict, self.events(name)[-1].products_made.verdict)
        # The same program as a simulation, which does not begin at the top of the travel as the machine did.
        simulated = self.cell.jobs().SubmitJob(job_pb2.SubmitJobRequest(request_id=new_id(), job={
            "kind": "JOB_KIND_SIMULATE", "machine": MILL,
            "inline_program": {"file_name": "a.rml", "content": SHORT.encode()}})).name
        self.assertEqual(self.becomes(simulated, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        other = self.cell.jobs().GetJobReport(job_pb2.GetJobReportRequest(name=simulated))
        self.assertEqual(other.total.cut_length_mm, report.total.cut_length_mm)
        self.assertGreater(report.total.travel_length_mm, other.total.travel_length_mm)
        picture = self.cell.jobs().GetJobPicture(job_pb2.GetJobPictureRequest(name=name))
        self.assertIn(b"<svg", picture.content)

    # LIVE-6.03, LIVE-6.04: a job begins at a step with what somebody has seen to, and not without; nor where no step is.
    def test_a_job_begins_at_a_step(self):
        self.enable()
        program = "PA;PA;VS10;PU200,0;PU400,0;PU0,0;"
        ended = {"SUCCEEDED", "FAILED"}
        seen = ["CONFIRMATION_TOOL", "CONFIRMATION_CLAMPS", "CONFIRMATION_ORIGIN_VALID"]
        unseen = self.submit(program, run={"step": {"step": 5}})
        self.assertEqual(self.becomes(unseen, *ended), "FAILED")
        self.assertIn("nobody has seen to", self.job(unseen).outcome.message)
        none = self.submit(program, run={"step": {"step": 50}, "confirmations": seen})
        self.assertEqual(self.becomes(none, *ended), "FAILED")
        self.assertEqual(self.job(none).outcome.code, "CELL-E9426")
        self.assertFalse(any(one.HasField("run_begun") for one in self.events(none)))
        name = self.submit(program, run={"step": {"step": 5}, "confirmations": seen})
        self.assertEqual(self.becomes(name, *ended), "SUCCEEDED", self.job(name).outcome)
        awaited(lambda: self.events(name)[-1].HasField("products_made"))
        # LIVE-6.09: what lies before the step was never run, and is not counted.
        report = self.cell.jobs().GetJobReport(job_pb2.GetJobReportRequest(name=name))
        self.assertAlmostEqual(report.total.times.cycle_s, self.job(name).outcome.cycle_time_ns * 1e-9)
        self.assertEqual(report.total.times.standstill_s, 0.0)
        given = subprocess.run([os.path.join(BIN, "rmlcell"), "submit", "mill-1", "--kind", "run", "--step", "x", "--slot", "7",
                                "--server", self.cell.address], capture_output=True, text=True, timeout=60)
        self.assertEqual(given.returncode, 2, given.stderr)
        self.assertIn("is no step", given.stderr)

    # LIVE-3.40, LIVE-9.16: what a machine has recorded comes as a file, and plays the same without a server.
    def test_a_recording_is_played_again(self):
        self.enable()
        name = self.submit()
        self.assertEqual(self.becomes(name, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        file = os.path.join(self.cell.folder, "run.rmlj")

        def replay(what, *more):
            return subprocess.run([os.path.join(BIN, "rmlcell"), "replay", what, "--server", self.cell.address, *more],
                                  capture_output=True, text=True, timeout=60)
        played = replay(name, "-o", file)
        self.assertEqual(played.returncode, 0, played.stderr)
        self.assertIn(f"{MILL}, {name}: played again, 1 inputs, 2 events", played.stdout)
        self.assertEqual(replay(MILL).stdout, played.stdout)
        self.assertEqual(subprocess.run([os.path.join(BIN, "rmlcell"), "replay", file], capture_output=True, text=True, timeout=60).stdout,
                         played.stdout)
        with open(file, "rb") as stream:
            bytes_there = bytearray(stream.read())
        bytes_there[len(bytes_there) // 2] ^= 1
        with open(file, "wb") as stream:
            stream.write(bytes_there)
        damaged = replay(file)
        self.assertEqual(damaged.returncode, 2)
        self.assertIn("CELL-E9024", damaged.stderr)
        self.assertIn("CELL-E9004", replay("jobs/999").stderr)

    # LIVE-3.40: one that ends at the instant at which it begins, too.
    def test_a_run_that_takes_no_time_is_played_again(self):
        live = Live(self, self.cell, "machines/optimo-1")
        self.enable(live)
        for text in ("STOP\n", "WORKDEF 2,0 (11)\nWORK 2,0/ON\nWORK 2,0/OFF\n"):
            name = self.submit(text, live.machine, "A.S")
            self.becomes(name, "SUCCEEDED", "FAILED")
            awaited(lambda name=name: "recording" in {one.name for one in self.job(name).artifacts})
            played = subprocess.run([os.path.join(BIN, "rmlcell"), "replay", name, "--server", self.cell.address],
                                    capture_output=True, text=True, timeout=60)
            self.assertEqual(played.returncode, 0, played.stderr)

    # LIVE-5.05: the same names on job and machine.
    def test_a_run_is_held_resumed_and_cancelled(self):
        self.live.enable()
        name = self.submit(SQUARE)
        self.live.wait("RUNNING")
        self.assertEqual(self.live.status().run.job, name)
        self.awaited_of(name, lambda: self.live.status().tip.z < -0.2)
        self.order("StopJob", name)
        held = self.live.wait("HELD")
        self.assertEqual(HoldReason.Name(held.hold_reason), "HOLD_REASON_STOP")
        self.assertEqual(self.state(name), "RUNNING")
        self.order("ResumeJob", name)
        awaited(lambda: self.live.status().tip != held.tip)
        self.order("SetJobOverride", name, override_percent=120.0)
        self.assertEqual(self.live.status().override_percent, 120.0)  # LIVE-3.16: told before it is answered
        with self.assertRaises(grpc.RpcError):
            self.order("SetJobOverride", name, override_percent=1e6)
        self.order("HoldJob", name)
        self.order("CancelJob", name)
        self.assertEqual(self.becomes(name, "CANCELLED", "FAILED"), "CANCELLED")
        self.assertEqual(self.job(name).outcome.code, "CELL-E9307")
        self.live.wait("IDLE")
        kinds = [one.WhichOneof("what") for one in self.events(name)]
        self.assertIn("halted", kinds)
        self.assertIn("resumed", kinds)
        # Whoever resumes it is told in its log.
        who = [one.input_applied for one in self.events(name) if one.HasField("input_applied")]
        self.assertTrue(all(one.caller for one in who), who)

    # LIVE-5.02: what keeps it in the queue.
    def test_a_run_waits_until_its_machine_can_start(self):
        name = self.submit()
        job = self.job(name)
        self.assertEqual(job_pb2.WaitReason.Name(job.wait_reason), "WAIT_REASON_MACHINE_NOT_READY")
        self.assertEqual(job.waits_for, MILL)
        self.assertEqual([one.code for one in job.start_blockers], ["CELL-E9424"])
        self.enable()
        self.becomes(name, "SUCCEEDED")
        other = Live(self, self.cell, "machines/optimo-1")
        self.enable(other)
        self.live.acquire(ttl={"seconds": 60})
        self.live.ask("SetMode", mode="OPERATING_MODE_MANUAL")
        # The queue goes by what the host has told, and may not have heard of it with the answer.
        awaited(lambda: "CELL-E9423" in [one.code for one in self.live.status().start_blockers])
        second = self.submit()
        third = self.submit(after_jobs=[second])
        self.runs_elsewhere(other)
        self.assertEqual((self.state(second), self.state(third)), ("QUEUED", "QUEUED"))
        self.assertIn("CELL-E9423", [one.code for one in self.live.status().start_blockers])
        self.assertIn("CELL-E9423", [one.code for one in self.job(second).start_blockers])
        self.assertIn("CELL-E9423", [one.code for one in self.job(third).start_blockers])
        self.live.ask("SetMode", mode="OPERATING_MODE_REMOTE")
        self.live.ask("ReleaseControl")
        self.becomes(second, "SUCCEEDED")
        self.becomes(third, "SUCCEEDED")

    def runs_elsewhere(self, other):
        """A job of another machine that is submitted now has come through the queue: what would have begun before it has begun."""
        self.assertEqual(self.becomes(self.submit("DELAY 0.1\n", other.machine, "A.S"), "SUCCEEDED", "FAILED"), "SUCCEEDED")

    # LIVE-5.02 (b), LIVE-5.08.
    def test_a_run_that_cannot_begin_or_is_stopped_by_its_program_fails(self):
        live = Live(self, self.cell, "machines/optimo-1")
        self.enable(live)
        wrong = self.submit("STOP\nNONSENSE\n", live.machine, "A.S")
        self.assertEqual(self.becomes(wrong, "FAILED"), "FAILED")
        self.assertTrue(self.job(wrong).outcome.code.startswith("OPT-E"))
        stopped = self.submit("STOP\n", live.machine, "A.S")
        self.becomes(stopped, "FAILED")
        self.assertEqual(self.job(stopped).outcome.code, "OPT-E7507")
        good = self.submit("DELAY 0.1\n", live.machine, "A.S")
        self.assertEqual(self.becomes(good, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        # OPT-3.44: one that is stored takes the place of its number, and no other goes.
        self.cell.machines().PutLaserSchedule(machine_pb2.PutLaserScheduleRequest(laser_schedule={
            "name": f"{live.machine}/laserSchedules/12", "power_percent": 40}))
        for kind in ("JOB_KIND_RUN", "JOB_KIND_SIMULATE"):
            other = self.submit("WORKDEF 2,0 (11)\nWORK 2,0/ON\nWORK 2,0/OFF\n", live.machine, "A.S", kind=kind)
            self.assertEqual(self.becomes(other, "SUCCEEDED", "FAILED"), "SUCCEEDED", kind)

    # LIVE-5.20, host killed: INTERRUPTED with its place, and the next waits until a person has looked.
    def test_a_host_that_is_killed_interrupts_its_job(self):
        other = Live(self, self.cell, "machines/optimo-1")
        self.enable(other)
        self.live.enable()
        name = self.submit(SQUARE)
        # A mark that was made on the way.
        self.awaited_of(name, lambda: (lambda mark: mark and mark.run_time_ns > 10**9)(self.live.newest_mark()))
        second = self.submit()
        os.kill(self.live.host(), signal.SIGKILL)
        self.becomes(name, "INTERRUPTED")
        outcome = self.job(name).outcome
        self.assertEqual(outcome.code, "CELL-E9411")
        self.assertGreater(outcome.place.byte_offset, 0)
        self.live.wait("INSPECT")
        # LIVE-3.40, 3.41: what it did up to there is played again, and its report is no good one.
        awaited(lambda: self.events(name)[-1].HasField("products_made"))
        report = self.cell.jobs().GetJobReport(job_pb2.GetJobReportRequest(name=name))
        self.assertEqual(report.outcome.kind, outcome.KIND_INTERRUPTED)
        self.assertEqual(report.outcome.code, "CELL-E9411")
        self.assertEqual(report.outcome.place.byte_offset, outcome.place.byte_offset)
        self.assertEqual(report.outcome.verdict, VERDICT_BAD)
        self.assertAlmostEqual(report.total.times.cycle_s, outcome.cycle_time_ns * 1e-9)
        self.assertGreater(report.total.travel_length_mm, 0)
        played = subprocess.run([os.path.join(BIN, "rmlcell"), "replay", name, "--server", self.cell.address],
                                capture_output=True, text=True, timeout=60)
        self.assertEqual((played.returncode, played.stderr), (0, ""))
        self.runs_elsewhere(other)
        self.assertEqual(self.state(second), "QUEUED")
        self.confirm()
        self.becomes(second, "SUCCEEDED")

    # LIVE-5.10: each decision by hand; the job that was cut off never changes.
    def test_what_becomes_of_a_run_that_was_cut_off(self):
        self.live.enable()
        name = self.submit(SQUARE, title="a square", labels=["order-7"])
        awaited(lambda: self.live.status().run.job == name)
        self.begins(name)

        def decide(decision, job=name, reason="looked at", request_id=None):
            return self.cell.jobs().DecideInterrupted(job_pb2.DecideInterruptedRequest(
                name=job, control_token=self.live.token, request_id=request_id or new_id(),
                decision=decision, reason=reason)).job

        def refused(code, *args, **fields):
            with self.assertRaises(grpc.RpcError) as caught:
                decide(*args, **fields)
            self.assertEqual(detail_of(caught.exception).code, code)

        refused("CELL-E9015", "DECISION_ABANDON")  # it runs
        os.kill(self.live.host(), signal.SIGKILL)
        self.becomes(name, "INTERRUPTED")
        self.live.wait("INSPECT")
        awaited(lambda: self.events(name)[-1].HasField("products_made"))
        last = self.job(name)
        refused("CELL-E9420", "DECISION_ABANDON")
        self.live.acquire(ttl={"seconds": 60})
        refused("CELL-E9003", "DECISION_ABANDON", reason="")
        refused("CELL-E9003", "DECISION_UNSPECIFIED")
        refused("CELL-E9003", "DECISION_RESUME_AT_STEP")  # no preview
        request_id = new_id()
        again = decide("DECISION_RESTART", request_id=request_id)
        self.live.ask("ReleaseControl")
        made = self.job(again)
        self.assertEqual((made.kind, made.title, list(made.labels)), (job_pb2.JOB_KIND_RUN, "a square", ["order-7"]))
        awaited(lambda: self.live.status().run.job == again)
        self.begins(again)
        self.assertEqual(self.job(name), last)
        os.kill(self.live.host(), signal.SIGKILL)
        self.becomes(again, "INTERRUPTED")
        self.live.wait("INSPECT")
        self.live.acquire()
        self.assertEqual(decide("DECISION_ABANDON", again), "")
        self.live.ask("ReleaseControl")
        self.live.wait("IDLE")
        self.assertEqual(self.state(again), "INTERRUPTED")
        refused("CELL-E9420", "DECISION_ABANDON", again)

    # LIVE-5.10, LIVE-6.01: a new job goes on where the old one was cut off, with the program that the old one brought; the old one
    # stays as it was.
    def test_a_run_that_was_cut_off_goes_on_at_a_step(self):
        self.enable(factor=10.0)
        name = self.submit(AROUND)
        self.awaited_of(name, lambda: (lambda mark: mark and mark.place.step >= 8)(self.live.newest_mark()))
        os.kill(self.live.host(), signal.SIGKILL)
        self.becomes(name, "INTERRUPTED")
        status = self.live.wait("INSPECT")
        self.assertEqual(status.cut_off_job, name)
        awaited(lambda: self.events(name)[-1].HasField("products_made"))
        old = self.job(name)

        def rmlcell(*words):
            done = subprocess.run([BIN / "rmlcell", *words, "--server", self.cell.address], capture_output=True, text=True, timeout=60)
            return done.returncode, done.stdout + done.stderr
        self.assertIn(f"{name} was cut off at ", rmlcell("machine", "status", "mill-1")[1])
        code, told = rmlcell("machine", "start-at", "mill-1", "--preview")
        self.assertEqual(code, 0, told)
        self.assertIn("approach", told)
        code, told = rmlcell("machine", "start-at", "mill-1")
        self.assertEqual(code, 1)
        self.assertIn("--seen ", told)
        self.assertIn("inspected", told)
        self.assertEqual(MachineState.Name(self.live.status().state), "MACHINE_STATE_INSPECT")
        code, told = rmlcell("machine", "start-at", "mill-1", "--seen", "inspected,tool,clamps,origin-valid", "--reason", "all is well")
        self.assertEqual(code, 0, told)
        new = told.strip().splitlines()[-1].split()[0]
        self.assertIn(f"{new} goes on with {name}", told)
        # LIVE-6.09: it halts where the step begins, and goes on when a person says so.
        self.assertEqual(self.live.wait("HELD").hold_reason, HoldReason.Value("HOLD_REASON_ENTRY"))
        code, told = rmlcell("resume", new)
        self.assertEqual(code, 0, told)
        self.live.acquire(take_over=True, reason="a test")
        self.live.ask("SetFactor", factor=100.0)
        self.live.ask("ReleaseControl")
        self.assertEqual(self.becomes(new, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        job = self.job(new)
        self.assertEqual((job.continues, job.kind), (name, job_pb2.JOB_KIND_RUN))
        self.assertEqual(self.job(name), old)
        begun = [one.run_begun for one in self.events(new) if one.HasField("run_begun")]
        self.assertEqual([one.job for one in begun], [new])

    # LIVE-5.10, LIVE-2.05: a job whose begin was refused has ended, and is never begun from its top by anybody.
    def test_a_refused_decision_begins_nothing(self):
        self.enable(factor=10.0)
        name = self.submit(AROUND)
        self.awaited_of(name, lambda: self.live.status().run.place.step >= 8)
        os.kill(self.live.host(), signal.SIGKILL)
        self.becomes(name, "INTERRUPTED")
        self.live.wait("INSPECT")
        self.live.acquire(ttl={"seconds": 60})
        request = job_pb2.DecideInterruptedRequest(
            name=name, control_token=self.live.token, request_id=new_id(), decision="DECISION_RESUME_AT_STEP", reason="why not",
            preview_token="none")
        for _ in range(2):  # asked again: the same answer
            with self.assertRaises(grpc.RpcError) as caught:
                self.cell.jobs().DecideInterrupted(request)
            self.assertEqual(detail_of(caught.exception).code, "CELL-E9428", detail_of(caught.exception))
        listed = self.cell.jobs().ListJobs(job_pb2.ListJobsRequest()).jobs
        self.assertEqual(sorted(job_pb2.Job.State.Name(one.state) for one in listed), ["STATE_FAILED", "STATE_INTERRUPTED"])
        with self.assertRaises(grpc.RpcError) as caught:
            self.live.ask("StartMachine", job=next(one.name for one in listed if one.continues))
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9428")
        self.assertEqual(MachineState.Name(self.live.status().state), "MACHINE_STATE_INSPECT")

    # LIVE-5.04, LIVE-9.13: jobs that a person starts, and jobs that their machine is armed for.
    def test_who_starts_a_job(self):
        self.enable()
        self.live.ask("DisableMachine")

        def lives_with(start):
            machine = self.cell.machines().GetMachine(machine_pb2.GetMachineRequest(name=MILL))
            machine.options.start = machine_pb2.MachineOptions.Start.Value(start)
            machine.options.enabled = True
            self.cell.machines().UpdateMachine(machine_pb2.UpdateMachineRequest(machine=machine, update_mask={"paths": ["options"]}))
            awaited(lambda: self.live.status().host)
            self.live.wait("IDLE")
            self.live.acquire(ttl={"seconds": 60})
            self.live.ask("SetFactor", factor=100.0)

        lives_with("START_PERSON")
        name = self.submit()
        self.assertIn("CELL-E9423", [one.code for one in self.live.status().start_blockers])
        self.assertEqual(self.live.ask("StartMachine", job=name).run.job, name)
        self.becomes(name, "SUCCEEDED")
        self.live.ask("DisableMachine")
        lives_with("START_ARMED")
        name = self.submit()
        self.refused("CELL-E9406", "StartMachine", job=name)
        self.assertEqual((self.state(name), self.job(name).held), ("QUEUED", True))  # nobody else begins it
        self.order("ResumeJob", name)
        seen = ["CONFIRMATION_TOOL", "CONFIRMATION_ORIGIN_VALID", "CONFIRMATION_CLAMPS", "CONFIRMATION_COVER"]
        armed = self.live.ask("ArmMachine", job=name, confirmations=seen)
        self.assertTrue(armed.arm_token)
        self.becomes(name, "SUCCEEDED")
        # The same by the command, in one go.
        self.live.ask("ReleaseControl")
        name = self.submit()

        def start(seen):
            return subprocess.run([BIN / "rmlcell", "machine", "start", "mill-1", "--job", name.split("/")[1], "--seen", seen, "--server",
                                   f"127.0.0.1:{self.cell.grpc_port}"], capture_output=True, text=True, timeout=60)

        refused = start("tool,origin-valid,clamps")
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("CELL-E9406", refused.stderr)
        self.assertEqual(start("tool,hat").returncode, 2)
        self.assertEqual(self.state(name), "QUEUED")
        begun = start("tool,origin-valid,clamps,cover")
        self.assertEqual(begun.returncode, 0, begun.stderr)
        self.assertIn(name, begun.stdout)
        self.becomes(name, "SUCCEEDED")

    # LIVE-3.31, server killed: the job stays RUNNING and held, and goes on when a person resumes it.
    def test_a_server_that_is_killed_holds_its_job(self):
        self.live.enable()
        name = self.submit(TO_AND_FRO)
        awaited(lambda: self.live.status().tip.x > 1.0)
        self.cell.kill()
        self.live.wait_until_held_by_itself(HoldReason.Value("HOLD_REASON_SERVER_LOST"))
        self.cell.start()
        held = self.live.wait("HELD")
        self.assertEqual(HoldReason.Name(held.hold_reason), "HOLD_REASON_SERVER_LOST")
        self.assertEqual((self.state(name), held.run.job), ("RUNNING", name))
        self.enable()
        self.order("ResumeJob", name)
        self.becomes(name, "SUCCEEDED")
        self.assertEqual([one.WhichOneof("what") for one in self.events(name)].count("run_begun"), 1)

    # The same by the command, which takes control for a moment and gives it back.
    def test_the_command_enables_starts_and_shows_a_machine(self):
        file, long = self.cell.folder / "a.rml", self.cell.folder / "long.rml"
        file.write_text(SHORT)
        long.write_text(TO_AND_FRO)

        def rmlcell(*words):
            done = subprocess.run([BIN / "rmlcell", *words, "--server", f"127.0.0.1:{self.cell.grpc_port}"],
                                  capture_output=True, text=True, timeout=60)
            return done.returncode, done.stdout + done.stderr

        self.assertIn("does not live", rmlcell("machine", "status", "mill-1")[1])
        self.assertEqual(rmlcell("machine", "stop", "mill-1")[0], 3)
        code, told = rmlcell("machine", "enable", "mill-1")
        self.assertEqual(code, 0, told)
        self.assertIn("IDLE in REMOTE", told)
        rmlcell("put", "mill-1", "7", str(long))
        # It is shown as it stands when the command looks again, a little later: not over by then.
        self.assertIn("RUNNING in REMOTE", rmlcell("machine", "start", "mill-1", "7")[1])
        code, told = rmlcell("machine", "factor", "mill-1", "100")
        self.assertIn("100.0 times as fast", told)
        self.assertNotIn("control", told)
        self.live.wait("IDLE")
        code, told = rmlcell("submit", "mill-1", "--slot", "7", "--kind", "run", "--watch")
        self.assertEqual(code, 0, told)
        self.assertIn("ended: completed", told)
        self.assertEqual(rmlcell("machine", "write", "mill-1", "X")[0], 2)
        self.assertEqual(rmlcell("machine", "read", "mill-1", "X"), (0, "X = 0\n"))
        self.assertIn("MANUAL", rmlcell("machine", "mode", "mill-1", "manual")[1])
        self.assertIn("CELL-E9423", rmlcell("machine", "status", "mill-1")[1])
        code, told = rmlcell("submit", "mill-1", str(file), "--kind", "run")
        self.assertIn("its machine cannot start", rmlcell("jobs", "--order", "queue")[1] + rmlcell("job", told.strip())[1])
        self.live.acquire()
        self.assertIn("CELL-E9408", rmlcell("machine", "mode", "mill-1", "remote")[1])
        self.assertEqual(rmlcell("machine", "mode", "mill-1", "remote", "--take-over", "shift change")[0], 0)
        self.becomes(told.strip(), "SUCCEEDED")
        self.assertIn("OFF", rmlcell("machine", "disable", "mill-1")[1])

    # LIVE-3.40: that of a run which was cut off, too.
    def every_recording_comes_out_the_same(self, names):
        cut_off = 0
        for name in names:
            if "recording" not in {one.name for one in self.job(name).artifacts}:
                continue
            played = subprocess.run([BIN / "rmlcell", "replay", name, "--server", f"127.0.0.1:{self.cell.grpc_port}"],
                                    capture_output=True, text=True, timeout=60)
            self.assertEqual((played.returncode, played.stderr), (0, ""), f"{name} {self.state(name)}: {played.stdout}")
            cut_off += self.state(name) == "INTERRUPTED"
        # One that is cut off in front of its first mark has none, and of the last few alone somebody looks after it.
        self.assertTrue(cut_off > 0 or len(names) < 100)

    # LIVE-10.04, LIVE-3.35: kill -9 of host, server or both, at random moments: no run is begun twice, each job ends once, as its
    # run did, and one that was never begun is done later.
    def test_crash_rounds(self):
        rounds = int(os.environ.get("LIVE_ROUNDS", "4"))
        seed = int(os.environ.get("LIVE_SEED", "1"))
        choose = random.Random(seed)
        self.enable()
        names = []
        for round_ in range(rounds):
            names += [self.submit() for _ in range(choose.randrange(1, 4))]
            time.sleep(choose.random() * 0.8)
            who = choose.choice(("host", "server", "both"))
            if who != "server":
                self.end_host()
            if who != "host":
                self.cell.kill()
                self.cell.start()
            # Whatever it is in, a person brings it back to work.
            until = time.monotonic() + 180  # of a failing test alone
            while time.monotonic() < until:
                time.sleep(0.1)
                status = self.live.status()
                state = MachineState.Name(status.state)[len("MACHINE_STATE_"):]
                if state == "INSPECT":
                    self.confirm()
                elif state == "OFF":  # too many of its hosts have died within a minute
                    self.enable()
                elif state == "HELD" and status.run.job:
                    self.order("ResumeJob", status.run.job)
                elif state == "IDLE" and any(self.is_held(one) for one in names):
                    for one in names:
                        if self.is_held(one):
                            self.order("ResumeJob", one)
                elif state == "IDLE" and all(self.state(one) not in ("QUEUED", "RUNNING") for one in names):
                    break
            else:
                self.fail(f"seed {seed}, round {round_}, {who}: {state}, {[(one, self.state(one)) for one in names]}")
        for name in names:
            kinds = [one.WhichOneof("what") for one in self.events(name)]
            told = f"seed {seed}: {name} {self.state(name)} {kinds}"
            self.assertIn(self.state(name), ("SUCCEEDED", "INTERRUPTED"), told)
            self.assertLessEqual(kinds.count("run_begun"), 1, told)
            self.assertEqual(kinds.count("ended"), 1, told)
            if self.state(name) == "SUCCEEDED":
                self.assertEqual(kinds.count("run_begun"), 1, told)
        self.every_recording_comes_out_the_same(names)
        self.live.disable()
        begun, over = [], []
        for event in self.log():
            if event.job.HasField("run_begun"):
                begun.append(event.resource)
            elif event.job.HasField("ended") and event.resource in begun:
                over.append(event.resource)
        self.assertGreater(len(begun), 0)
        # One whose begin the store did not have when its host died has moved nothing, and nothing is told of that.
        self.assertEqual(begun, over)
        self.assertEqual(len(over), len(set(over)))


if __name__ == "__main__":
    unittest.main()
