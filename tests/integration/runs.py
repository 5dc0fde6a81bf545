"""RUN jobs, for the tests of them."""
from cell import awaited, eventually, job_pb2
from live import MILL, LiveTestCase, asked, new_id

# Some seconds, most of them the way down; much less at a hundred times the speed.
SHORT = "PA;PA;VS10;PU200,0;PU0,0;"


class RunTestCase(LiveTestCase):
    def submit(self, text=SHORT, machine=MILL, file_name="a.rml", **fields):
        return self.cell.jobs().SubmitJob(job_pb2.SubmitJobRequest(request_id=new_id(), job={
            "kind": "JOB_KIND_RUN", "machine": machine,
            "inline_program": {"file_name": file_name, "content": text.encode()}, **fields})).name

    def job(self, name):
        return self.cell.jobs().GetJob(job_pb2.GetJobRequest(name=name))

    def state(self, name):
        return job_pb2.Job.State.Name(self.job(name).state)[len("STATE_"):]

    def is_held(self, name):
        job = self.job(name)
        return job.state == job_pb2.Job.STATE_QUEUED and job.held

    def becomes(self, name, *states):
        """Its state, once it is one of these; where it never is, the test fails."""
        def state():
            now = self.state(name)
            if "SUCCEEDED" in states and now == "RUNNING":
                self.let_go_on(name)
            return now if now in states else None
        found = eventually(state)
        if not found:
            self.fail(f"{name} never becomes {states}: {self.job(name)}")
        return found

    def begins(self, name):
        """The store has its begin: a host that dies from here on leaves a run that was cut off. Before that nothing has moved, and
        the job waits again, though its machine may have been seen with it."""
        for message in self.cell.jobs().WatchJob(job_pb2.WatchJobRequest(name=name, after_sequence=0), timeout=60):
            if message.event.HasField("run_begun"):
                return
        self.fail(f"{name} never begins: {self.job(name)}")

    def awaited_of(self, name, holds):
        """What `holds` says as soon as it is true, while the job runs."""
        return awaited(lambda: holds() or self.let_go_on(name))

    def order(self, method, name, **fields):
        return asked(getattr(self.cell.jobs(), method), getattr(job_pb2, method + "Request")(
            name=name, request_id=new_id(), **fields))

    def events(self, name):
        return [one.event for one in self.cell.jobs().WatchJob(job_pb2.WatchJobRequest(name=name, after_sequence=0), timeout=60)
                if one.HasField("event")]

    def confirm(self):
        self.live.acquire(take_over=True, reason="a test")
        self.live.ask("SetFactor", factor=100.0)
        self.live.ask("ConfirmMachine", confirmations=[1])
        self.live.ask("ReleaseControl")

    def enable(self, live=None, factor=100.0):
        """Its time goes by a hundred times as fast."""
        live = live or self.live
        live.enable()
        live.acquire(take_over=True, reason="a test")
        live.ask("SetFactor", factor=factor)
        live.ask("ReleaseControl")
