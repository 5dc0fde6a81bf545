"""The cell as its clients meet it: jobs and kills."""
import os
import pathlib
import signal
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.request
import uuid

from cell import (COMPLETED, ENDLESS, FAILED, LONG, SQUARE, Cell, WithCell, awaited, cell_pb2, common_pb2, detail_of, endless_job,
                  eventually, grpc, inline_job, job_pb2, machine_status_pb2, machine_pb2, program_pb2, submit, wait_for_end,
                  wait_until_an_attempt_counts, wait_until_it_runs)
from command import run
from runs import RunTestCase


# Of what is to be seen on its way: a busy machine may come too late for the first of them.
LONGER_AND_LONGER_S = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0)


def jobs_request(jobs=None, **wanted):
    """A watch of these jobs, of all without."""
    jobs = jobs if jobs is not None else cell_pb2.JobsSubscription()
    return cell_pb2.WatchCellRequest(subscriptions=[cell_pb2.Subscription(id="jobs", jobs=jobs)], **wanted)


def first_of(stub, request):
    """The first message of a watch of the cell."""
    watch = stub.WatchCell(request, timeout=60)
    message = next(watch)
    watch.cancel()
    return message


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
        artifact = stub.GetJobArtifact(job_pb2.GetJobArtifactRequest(name=job.name, artifact="picture.svg"))
        self.assertEqual((artifact.content, artifact.media_type), (picture.content, "image/svg+xml"))
        self.assertIn(b"<svg", picture.content)
        first, *blocks = stub.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name=job.name))
        self.assertGreater(len(blocks), 0)
        self.assertEqual((first.header.points, first.header.complete, first.header.tip_box),
                         (report.toolpath.records, True, report.tip_box))
        self.assertAlmostEqual(first.header.duration_ns / 1e9, report.total.times.cycle_s, places=6)
        self.assertEqual(first.header.bytes, sum(4 + len(one.block) for one in blocks))
        # The same file as the job's comes out of the command without a server: docs/toolpath.md.
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "square.rml")
            source.write_text(SQUARE)
            path = pathlib.Path(folder, "square.path")
            run("simulate", source, "--profile", "srm-20", "--toolpath", path)
            framed = b"".join(len(one.block).to_bytes(4, "little") + one.block for one in blocks)
            self.assertEqual(path.read_bytes(), framed)

    def test_the_verdict_stands_beside_the_outcome(self):
        # docs/verdict.md: lost work is BAD although the job succeeded; the same in job, event and report.
        stub = self.cell.jobs()
        source = "VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD90000,100;PU0,0;!MC0;"
        job = submit(stub, inline_job("mill-1", "beyond.rml", source))
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual(ended.kind, COMPLETED)
        done = stub.GetJob(job_pb2.GetJobRequest(name=job.name))
        self.assertEqual(done.state, job_pb2.Job.STATE_SUCCEEDED)
        report = stub.GetJobReport(job_pb2.GetJobReportRequest(name=job.name))
        for outcome in (ended, done.outcome, report.outcome):
            self.assertEqual(outcome.verdict, common_pb2.VERDICT_BAD)
            self.assertEqual([reason.code for reason in outcome.reasons], ["RML1-E8002", "RML1-E8002"])
            # X ends at 203.2 mm; from 1 mm on the work is 899 mm long.
            self.assertAlmostEqual(outcome.reasons[0].amount, 899.0 - 203.2, places=6)
            self.assertAlmostEqual(outcome.reasons[1].amount, 900.0 - 203.2, places=6)
        check = submit(stub, inline_job("mill-1", "beyond.rml", source, job_pb2.JOB_KIND_CHECK))
        self.assertEqual(wait_for_end(stub, check.name)[-1].ended.verdict, common_pb2.VERDICT_BAD)

    def test_a_deleted_job_is_gone_with_its_products(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        wait_for_end(stub, job.name)
        stub.DeleteJob(job_pb2.DeleteJobRequest(name=job.name))
        for call, request in ((stub.GetJob, job_pb2.GetJobRequest(name=job.name)),
                              (stub.DeleteJob, job_pb2.DeleteJobRequest(name=job.name)),
                              (stub.GetJobReport, job_pb2.GetJobReportRequest(name=job.name)),
                              (stub.GetJobArtifact, job_pb2.GetJobArtifactRequest(name=job.name, artifact="report"))):
            self.refused(call, request, grpc.StatusCode.NOT_FOUND, "CELL-E9004")
        self.refused(stub.DeleteJob, job_pb2.DeleteJobRequest(name="7"), grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")

    def test_a_job_runs_at_the_pace_of_the_machine(self):
        def live_on_the_way(delay_s):
            begin = time.monotonic()
            seen = self.progress_of_a_paced_job(f"DELAY {delay_s}\n")
            self.assertGreaterEqual(time.monotonic() - begin, delay_s)  # however slow the machine: less would be too fast
            return [one for one in seen if 0.0 < one.virtual_time_ns * 1e-9 < delay_s]
        self.assertTrue(next(filter(None, map(live_on_the_way, LONGER_AND_LONGER_S)), None))

    def progress_of_a_paced_job(self, source):
        stub = self.cell.jobs()
        job = inline_job("optimo-1", "paced.S", source)
        job.simulation.pace = 1.0
        return [m.progress for m in stub.WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name=submit(stub, job).name), timeout=300)
                if m.HasField("progress")]

    def test_paced_jobs_keep_no_check_waiting(self):
        stub = self.cell.jobs()
        paced = []
        for _ in range(3):  # one more than there are workers for them
            job = inline_job("mill-1", "slow.rml", "PA;VS1;!VZ1;PU0,0;Z0,0,-100;Z4000,0,-100;PU0,0;")
            job.simulation.pace = 1.0
            paced.append(submit(stub, job).name)
        for name in paced[:2]:
            wait_until_it_runs(stub, name)
        check = submit(stub, job_pb2.Job(kind=job_pb2.JOB_KIND_CHECK, machine="machines/mill-1",
                                         inline_program=common_pb2.ProgramText(file_name="p.rml", content=b"PA;PU0,0;")))
        wait_for_end(stub, check.name)
        states = [stub.GetJob(job_pb2.GetJobRequest(name=name)).state for name in paced]
        self.assertEqual(states, [job_pb2.Job.STATE_RUNNING] * 2 + [job_pb2.Job.STATE_QUEUED])
        for name in reversed(paced):
            stub.CancelJob(job_pb2.CancelJobRequest(name=name))
            wait_for_end(stub, name)

    def test_progress_of_a_paced_job_is_by_time(self):
        def known_on_the_way(delay_s):
            # One step that takes time and many that take none: by steps or bytes it would be nearly over at once.
            source = "".join(f"VR[{n}] = {n}.\n" for n in range(50)) + f"DELAY {delay_s}\n"
            known = [one for one in self.progress_of_a_paced_job(source) if one.HasField("planned_time_ns")]
            self.assertLessEqual({one.planned_time_ns for one in known}, {int(delay_s * 1e9)})
            for one in known:
                self.assertAlmostEqual(one.progress, one.virtual_time_ns / (delay_s * 1e9), delta=0.06)
            self.assertEqual([one.progress for one in known], sorted(one.progress for one in known))
            return known
        self.assertTrue(next(filter(None, map(known_on_the_way, LONGER_AND_LONGER_S)), None))

    def test_a_pace_has_its_bounds(self):
        stub = self.cell.jobs()
        job = inline_job("optimo-1", "slow.S", "DELAY 1.5\n")
        job.simulation.pace = 1001.0
        with self.assertRaises(grpc.RpcError) as caught:
            submit(stub, job)
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9003")

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
        # The numbers of a finding by name; those of the first one also with the job, which a store gives.
        self.assertEqual({a.name: a.text or a.number for a in report.diagnostics[1].arguments},
                         {"instruction": "MOVE", "values": 2, "needed": 5})
        told = stub.GetJob(job_pb2.GetJobRequest(name=job.name)).outcome
        self.assertTrue(told.arguments)
        self.assertEqual(told.arguments, report.diagnostics[0].arguments)
        self.assertEqual(told.arguments, ended.arguments)

    # OPT-E.7301: a job that only checks follows the motion, with the programs of its machine.
    def test_a_check_job_follows_the_motion(self):
        stub = self.cell.jobs()
        far = "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n"
        job = submit(stub, inline_job("optimo-1", "far.S", far, kind=job_pb2.JOB_KIND_CHECK))
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual((ended.kind, ended.code, ended.place.step), (FAILED, "OPT-E7301", 2))
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name="machines/optimo-1/programs/61",
            program=common_pb2.ProgramText(file_name="61.S", content=far.encode())))
        job = submit(stub, inline_job("optimo-1", "main.S", "CALL 61\n", kind=job_pb2.JOB_KIND_CHECK))
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual((ended.code, ended.place.program), ("OPT-E7301", 61))

    # motion.md 2.6: a simulation tells every violation and ends as failed.
    def test_a_simulation_tells_all_violations(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "far.S", "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n"
                                                          "MOVE (0.,0.,0.,13.,0.)\n"))
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual((ended.kind, ended.code), (FAILED, "OPT-E7301"))
        report = stub.GetJobReport(job_pb2.GetJobReportRequest(name=job.name))
        self.assertEqual([v.axis for v in report.violations], ["X", "A"])
        self.assertEqual(sum(d.code == "OPT-E7301" for d in report.diagnostics), 2)

    def test_the_same_request_id_gives_the_same_job(self):
        stub = self.cell.jobs()
        request_id = str(uuid.uuid4())
        first = submit(stub, inline_job("mill-1", "a.rml", SQUARE), request_id)
        again = submit(stub, inline_job("mill-1", "a.rml", SQUARE), request_id)
        self.assertEqual(first.name, again.name)
        self.refused(stub.SubmitJob, job_pb2.SubmitJobRequest(job=inline_job("mill-1", "b.rml", "PU;"), request_id=request_id),
                     grpc.StatusCode.ALREADY_EXISTS, "CELL-E9019")
        wait_for_end(stub, first.name)  # it is told of in no other test

    def test_a_repeated_request_has_its_job_also_when_the_program_is_gone(self):
        stub, name = self.cell.jobs(), "machines/mill-1/programs/51"
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=name, program=common_pb2.ProgramText(file_name="a.rml", content=SQUARE.encode())))
        job = job_pb2.Job(machine="machines/mill-1", kind=job_pb2.JOB_KIND_SIMULATE, program=name)
        request_id = str(uuid.uuid4())
        first = submit(stub, job, request_id)
        self.cell.programs().DeleteProgram(program_pb2.DeleteProgramRequest(name=name))
        self.assertEqual(submit(stub, job, request_id).name, first.name)
        self.refused(stub.SubmitJob, job_pb2.SubmitJobRequest(job=job, request_id=str(uuid.uuid4())),
                     grpc.StatusCode.NOT_FOUND, "CELL-E9004")
        wait_for_end(stub, first.name)  # it is told of in no other test

    def test_programs_of_a_job_leave_nothing_behind(self):
        stub, programs = self.cell.jobs(), self.cell.programs()
        for slot, text in ((71, "VR[0]=2.\n"), (72, "FUNCTION 71\nDELAY VR[0]\n")):
            programs.PutProgram(program_pb2.PutProgramRequest(
                name=f"machines/optimo-1/programs/{slot}",
                program=common_pb2.ProgramText(file_name=f"{slot}.S", content=text.encode())))
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
            halted = eventually(lambda: next((m.event.halted for m in self.events(stub, job.name)
                                              if m.event.HasField("halted")), None))
            # OPT-4.17: in REMOTE a HOLD is a STOP.
            self.assertEqual((halted.reason, halted.message), (machine_status_pb2.HOLD_REASON_STOP, "STOP"))
            stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
            self.assertEqual(wait_for_end(stub, job.name)[-1].ended.code, "CELL-E9307")

    def events(self, stub, name):
        last = stub.GetJob(job_pb2.GetJobRequest(name=name)).last_sequence
        for message in stub.WatchJob(job_pb2.WatchJobRequest(name=name, after_sequence=max(0, last - 100),
                                                             events_only=True), timeout=60):
            if message.HasField("event"):
                yield message
                if message.event.sequence >= last:
                    return

    def test_a_job_is_cancelled_while_it_runs(self):
        stub = self.cell.jobs()
        job = submit(stub, endless_job())
        wait_until_it_runs(stub, job.name)
        stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
        self.assertEqual(wait_for_end(stub, job.name)[-1].ended.code, "CELL-E9307")

    def test_a_watcher_comes_back_without_gap_or_repeat(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("optimo-1", "long.S", LONG.format(rounds=3000)))
        whole = wait_for_end(stub, job.name)
        for cut in range(len(whole)):
            rest = [m.event.sequence for m in stub.WatchJob(
                job_pb2.WatchJobRequest(name=job.name, after_sequence=cut, events_only=True)) if m.HasField("event")]
            self.assertEqual(rest, list(range(cut + 1, len(whole) + 1)))
        with self.assertRaises(grpc.RpcError) as caught:  # of another cell, or mistyped: it would wait for ever
            list(stub.WatchJob(job_pb2.WatchJobRequest(name=job.name, after_sequence=len(whole) + 1), timeout=60))
        self.assertEqual(caught.exception.code(), grpc.StatusCode.INVALID_ARGUMENT)

    def test_a_watcher_of_all_jobs_is_never_set_elsewhere_in_silence(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        wait_for_end(stub, job.name)
        cell = self.cell.cell_service()
        first = first_of(cell, jobs_request())
        last, log = first.sequence, first.log_id
        self.assertGreater(last, 0)
        # The last number itself is good: nothing has come since.
        self.assertTrue(first_of(cell, jobs_request(after_sequence=last, log_id=log)).HasField("bookmark"))
        # One that this log has not come to yet, or that is of another log: begin anew.
        for after, of in ((last + 1_000_000, log), (last, "0198c5b2-0000-7000-8000-000000000000"), (last + 1_000_000, "")):
            watch = cell.WatchCell(jobs_request(after_sequence=after, log_id=of), timeout=60)
            told = [next(watch), next(watch)]
            watch.cancel()
            self.assertEqual(told[0].gap.reason, cell_pb2.Gap.REASON_OTHER_LOG)
            self.assertTrue(told[1].HasField("snapshot"))
        with self.assertRaises(grpc.RpcError) as caught:
            list(cell.WatchCell(jobs_request(after_sequence=-1), timeout=60))
        self.assertEqual(caught.exception.code(), grpc.StatusCode.INVALID_ARGUMENT)
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9003")
        # Over the web port, too.
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.CellService/WatchCell", None,
                                         {"Accept": "text/event-stream", "Last-Event-ID": f"{last + 1_000_000}.{log}"})
        with urllib.request.urlopen(request, timeout=60) as answer:
            self.assertEqual(answer.readline().decode(), f"id: {last}.{log}\n")
            self.assertIn("REASON_OTHER_LOG", answer.readline().decode())

    def test_a_watcher_of_all_jobs_sees_them_run(self):
        stub = self.cell.jobs()
        job = inline_job("optimo-1", "slow.S", "DELAY 1000\n")
        job.simulation.pace = 1.0
        job = submit(stub, job)
        ended = {}

        def follow(key, request):
            seen = ended.setdefault(key, [])
            for message in self.cell.cell_service().WatchCell(request, timeout=120):
                seen.append(message)
                if message.event.job.HasField("ended"):
                    return

        def times(key):
            return [m.progress.virtual_time_ns for m in list(ended.get(key, ())) if m.HasField("progress")]

        watchers = [threading.Thread(target=follow, args=(key, request)) for key, request in (
            ("all", jobs_request()),
            ("named", jobs_request(cell_pb2.JobsSubscription(names=[job.name]))),
            ("another", jobs_request(cell_pb2.JobsSubscription(names=[job.name, "jobs/999999"], events_only=True))))]
        for watcher in watchers:
            watcher.start()
        try:
            # Live on the way: again and again another time.
            self.assertTrue(eventually(lambda: all(len(set(times(key))) > 2 for key in ("all", "named"))))
        finally:
            stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
            for watcher in watchers:
                watcher.join()
        for key, messages in ended.items():
            self.assertTrue(messages[0].HasField("snapshot"), key)
            self.assertEqual(len({m.instance_id for m in messages} - {""}), 1, key)
            self.assertTrue(all(m.instance_id for m in messages), key)
            self.assertEqual({m.progress.job for m in messages if m.HasField("progress")} - {job.name}, set(), key)
            self.assertEqual(times(key), sorted(times(key)), key)
        self.assertEqual(times("another"), [])
        with self.assertRaises(grpc.RpcError) as caught:
            list(self.cell.cell_service().WatchCell(jobs_request(cell_pb2.JobsSubscription(names=["17"])), timeout=60))
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9003")

    def test_budgets_end_a_job_with_their_own_codes(self):
        stub = self.cell.jobs()
        job = inline_job("optimo-1", "endless.S", ENDLESS)
        job.budget.steps = 1000
        self.assertEqual(wait_for_end(stub, submit(stub, job).name)[-1].ended.code, "OPT-E7901")
        job = inline_job("optimo-1", "wait.S", "WAIT IL[20]\n")
        job.budget.virtual_time_ns = 5_000_000_000
        self.assertEqual(wait_for_end(stub, submit(stub, job).name)[-1].ended.code, "OPT-E7902")
        job = inline_job("optimo-1", "endless.S", ENDLESS)
        job.budget.processor_ns = 200_000_000
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
        # So it is in a snapshot of the cell, and so are the machines; the counts are those of a list.
        watch = self.cell.cell_service().WatchCell(cell_pb2.WatchCellRequest(), timeout=60)
        jobs, machines = next(watch).snapshot, next(watch).snapshot
        watch.cancel()
        self.assertIn(one, jobs.jobs)
        listed = stub.ListJobs(job_pb2.ListJobsRequest(page_size=1, count=True)).counts
        self.assertEqual(list(jobs.counts), list(listed))
        self.assertEqual(sum(count.jobs for count in listed), len(stub.ListJobs(job_pb2.ListJobsRequest(page_size=1000)).jobs))
        self.assertEqual(list(machines.machines),
                         list(self.cell.machines().ListMachines(machine_pb2.ListMachinesRequest()).machines))
        self.refused(stub.ListJobs, job_pb2.ListJobsRequest(filter="colour = red"),
                     grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9107")


class Kills(unittest.TestCase):
    def setUp(self):
        self.cell = Cell("--workers.lease_ms", "2000")
        self.addCleanup(self.cell.close)
        self.cell.start()

    def test_a_job_survives_the_death_of_its_worker(self):
        stub = self.cell.jobs()
        job = submit(stub, endless_job())
        attempt = wait_until_an_attempt_counts(stub, job.name)
        for process in self.cell.worker_processes():
            os.kill(process, 9)
        other = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        self.assertEqual(wait_for_end(stub, other.name)[-1].ended.kind, COMPLETED)
        # The second attempt may have gone to a worker that was killed a moment later.
        if wait_until_an_attempt_counts(stub, job.name, behind=attempt):
            for process in self.cell.worker_processes():
                os.kill(process, 9)
        ended = wait_for_end(stub, job.name)[-1].ended
        self.assertEqual(ended.code, "CELL-E9301")  # two attempts, as the policy says
        self.assertEqual(stub.GetJob(job_pb2.GetJobRequest(name=job.name)).attempts, 2)

    def test_workers_are_replaced_whatever_the_server_was_started_by(self):
        self.cell.close()
        before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # the server inherits that
        try:
            self.cell = Cell().start()
        finally:
            signal.signal(signal.SIGCHLD, before)
        self.addCleanup(self.cell.close)
        self.assertTrue(eventually(lambda: len(self.cell.worker_processes()) >= 2))
        old = set(self.cell.worker_processes())
        for process in old:
            os.kill(process, signal.SIGKILL)
        self.assertTrue(eventually(lambda: len(set(self.cell.worker_processes()) - old) >= len(old)))

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
        for life in range(4):
            wanted = len(acknowledged) + 8
            self.assertTrue(eventually(lambda: len(acknowledged) >= wanted))
            if life < 3:
                self.cell.kill()
                self.cell.start()
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
        ended = False
        until = time.monotonic() + 120
        while not ended and time.monotonic() < until:
            try:
                watch = self.cell.jobs().WatchJob(job_pb2.WatchJobRequest(
                    name=job.name, after_sequence=seen[-1] if seen else 0, events_only=True), timeout=60)
                for message in watch:
                    if message.HasField("event"):
                        seen.append(message.event.sequence)
                        ended = message.event.HasField("ended")
                        if len(seen) == 2:
                            watch.cancel()
                            self.cell.kill()
                            self.cell.start()
            except grpc.RpcError:
                time.sleep(0.05)
        self.assertTrue(ended)
        self.assertEqual(seen, list(range(1, len(seen) + 1)))


class Stops(unittest.TestCase):
    def setUp(self):
        self.cell = Cell("--shutdown.timeout_s", "60")  # it needs a part of a second
        self.addCleanup(self.cell.close)
        self.cell.start()

    def test_the_server_stops_in_order(self):
        stub = self.cell.jobs()
        job = submit(stub, endless_job())
        wait_until_it_runs(stub, job.name)
        last = []
        cell = []
        one = stub.WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name=job.name))
        watchers = [threading.Thread(target=self.collect, args=(one, last)),
                    threading.Thread(target=self.collect, args=(self.cell.cell_service().WatchCell(jobs_request()), cell))]
        for watcher in watchers:
            watcher.start()
        self.assertTrue(eventually(lambda: last and cell))
        self.assertEqual(self.cell.stop(), 0)
        for watcher in watchers:
            watcher.join()
        for seen in (last, cell):
            self.assertTrue(seen[-1].HasField("reconnect"))
            self.assertEqual(seen[-1].instance_id, seen[0].instance_id)
            # Where to go on: behind the last event that was told, or the snapshot.
            told = max([seen[0].sequence] + [m.sequence for m in seen if m.HasField("event")])
            self.assertEqual(seen[-1].sequence, told)
            self.assertGreater(seen[-1].reconnect.after.nanos, 0)
        self.cell.start()
        again = self.cell.jobs().GetJob(job_pb2.GetJobRequest(name=job.name))
        self.assertIn(again.state, (job_pb2.Job.STATE_QUEUED, job_pb2.Job.STATE_RUNNING))
        self.assertLessEqual(again.attempts, 1)  # handed back: the attempt does not count
        watch = self.cell.jobs().WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name=job.name, events_only=True), timeout=60)
        told = [event for _, event in zip(range(again.last_sequence), (one.event for one in watch if one.HasField("event")))]
        queued = [one.state for one in told].count(job_pb2.Job.STATE_QUEUED)  # as it was submitted, and handed back: not lost
        self.assertEqual((queued, any(one.HasField("message") for one in told)), (2, False))
        self.cell.jobs().CancelJob(job_pb2.CancelJobRequest(name=job.name))

    # A number from before a restart is good in the store that goes on, and void when a backup was put back over it.
    def test_a_store_that_was_put_back_is_noticed(self):
        stub = self.cell.jobs()
        submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        before = first_of(self.cell.cell_service(), jobs_request())
        self.assertEqual(self.cell.stop(), 0)
        store = self.cell.folder / "store" / "cell.db"
        backup = store.read_bytes()
        self.cell.start()
        again = first_of(self.cell.cell_service(), jobs_request(after_sequence=before.sequence, log_id=before.log_id))
        self.assertTrue(again.HasField("bookmark"))
        self.assertNotEqual(again.log_id, before.log_id)
        for _ in range(3):
            wait_for_end(self.cell.jobs(), submit(self.cell.jobs(), inline_job("mill-1", "square.rml", SQUARE)).name)
        seen = first_of(self.cell.cell_service(), jobs_request())
        self.assertEqual(self.cell.stop(), 0)
        for path in store.parent.glob("cell.db*"):
            path.unlink()
        store.write_bytes(backup)
        self.cell.start()
        # As many events as before, and more: the numbers come again, for other events.
        for _ in range(4):
            wait_for_end(self.cell.jobs(), submit(self.cell.jobs(), inline_job("mill-1", "square.rml", SQUARE)).name)
        lost = first_of(self.cell.cell_service(), jobs_request(after_sequence=seen.sequence, log_id=seen.log_id))
        self.assertEqual(lost.gap.reason, cell_pb2.Gap.REASON_OTHER_LOG)
        kept = first_of(self.cell.cell_service(), jobs_request(after_sequence=before.sequence, log_id=before.log_id))
        self.assertTrue(kept.HasField("bookmark"))

    @staticmethod
    def collect(watch, messages):
        try:
            for message in watch:
                messages.append(message)
        except grpc.RpcError:
            pass


class Runs(RunTestCase):
    # LIVE-5.02, LIVE-5.08: it begins when its time has come, and its products come behind its end. Others: test_runs.py.
    def test_a_run_has_its_products(self):
        self.enable()
        name = self.submit(not_before_time={"seconds": int(time.time()) + 2})
        self.assertEqual(self.becomes(name, "SUCCEEDED", "FAILED"), "SUCCEEDED")
        awaited(lambda: self.events(name)[-1].HasField("products_made"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
