#!/usr/bin/env python3
"""SubmitJobs: many jobs in one stream, each answered when it is durable (proto/rmlcell/v1/job.proto)."""
import itertools
import threading
import unittest

from cell import Cell, WithCell, awaited, eventually, grpc, inline_job, job_pb2

SQUARE = "PA;PU100,100;PD900,100,900,900;PU0,0;"


def submission(number, request_id="", source=SQUARE, machine="mill-1", **fields):
    job = inline_job(machine, "a.rml", source)
    job.held = True
    for name, value in fields.items():
        setattr(job, name, value)
    return job_pb2.SubmitJobsRequest(number=number, submission=job_pb2.SubmitJobRequest(job=job, request_id=request_id))


class Streams(WithCell):
    def test_each_is_answered_once_by_its_number(self):
        sent = 600  # more than may be under way at once
        answers = list(self.cell.jobs().SubmitJobs(submission(n) for n in range(1, sent + 1)))
        self.assertEqual(sorted(answer.number for answer in answers), list(range(1, sent + 1)))
        names = {answer.job for answer in answers}
        self.assertEqual(len(names), sent)
        stub = self.cell.jobs()
        for answer in itertools.islice(answers, 0, sent, 50):
            self.assertEqual(stub.GetJob(job_pb2.GetJobRequest(name=answer.job)).title, "")

    def test_what_cannot_be_is_refused_and_the_rest_goes_on(self):
        stub = self.cell.jobs()
        wrong = {2: submission(2, machine="none"), 4: submission(4, source=""), 6: submission(6, priority=1000)}
        answers = {answer.number: answer for answer in
                   stub.SubmitJobs(wrong.get(n, submission(n)) for n in range(1, 9))}
        self.assertEqual({n: answer.refusal.code for n, answer in answers.items() if answer.HasField("refusal")},
                         {2: "CELL-E9009", 4: "CELL-E9017", 6: "CELL-E9003"})
        self.assertIn("none", answers[2].refusal.message)
        self.assertTrue(all(answers[n].job for n in (1, 3, 5, 7, 8)))

    def test_a_request_that_is_repeated_gives_the_same_job(self):
        stub = self.cell.jobs()
        first = {answer.number: answer.job
                 for answer in stub.SubmitJobs(submission(n, f"again-{n}") for n in range(1, 6))}
        again = {answer.number: answer.job
                 for answer in stub.SubmitJobs(submission(n, f"again-{n}") for n in range(1, 6))}
        self.assertEqual(first, again)
        other = list(stub.SubmitJobs(iter([submission(1, "again-1", SQUARE + "PU0,0;")])))
        self.assertEqual(other[0].refusal.code, "CELL-E9019")

    def test_a_trial_makes_nothing(self):
        request = submission(7)
        request.submission.validate_only = True
        answers = list(self.cell.jobs().SubmitJobs(iter([request])))
        self.assertEqual([(answer.number, answer.job, answer.HasField("refusal")) for answer in answers],
                         [(7, "", False)])

    def test_answers_come_while_the_stream_is_open(self):
        more = threading.Event()

        def requests():
            yield submission(1)
            more.wait(60)
            yield submission(2)

        stream = self.cell.jobs().SubmitJobs(requests())
        self.assertEqual(next(stream).number, 1)
        more.set()
        self.assertEqual(next(stream).number, 2)
        self.assertRaises(StopIteration, next, stream)

    def test_a_client_that_reads_no_answers_is_read_no_further(self):
        sent = []

        def requests():
            for n in range(20_000):
                request = submission(n)
                request.submission.job.simulation.parameters[1000 * "A"] = "1"  # a long answer: windows fill
                sent.append(n)
                yield request

        stream = self.cell.jobs().SubmitJobs(requests())
        seen, stub = -1, self.cell.jobs()
        while len(sent) > seen:  # until no more goes out while hundreds of others are answered
            seen = len(sent)
            for _ in range(500):
                self.assertTrue(stub.SubmitJob(submission(0).submission, timeout=60).name)
        self.assertLess(seen, 20_000)
        self.assertEqual(sum(1 for answer in stream if answer.refusal.code), 20_000)

    def test_one_that_is_broken_off_keeps_what_was_answered(self):
        stub = self.cell.jobs()
        stream = stub.SubmitJobs(submission(n) for n in itertools.count(1))
        kept = [next(stream).job for _ in range(100)]
        stream.cancel()
        for name in kept[::20]:
            self.assertEqual(stub.GetJob(job_pb2.GetJobRequest(name=name)).name, name)
        self.assertEqual(len(list(stub.SubmitJobs(submission(n) for n in range(20)))), 20)


class Deaths(unittest.TestCase):
    def test_what_was_answered_outlives_the_server(self):
        cell = Cell(workers=0).start()
        self.addCleanup(cell.close)
        answered = {}
        try:
            for answer in cell.jobs().SubmitJobs(submission(n, f"r-{n}") for n in itertools.count(1)):
                answered[answer.number] = answer.job
                if len(answered) == 300:
                    cell.kill()
        except grpc.RpcError as broken:
            self.assertEqual(broken.code(), grpc.StatusCode.UNAVAILABLE)
        self.assertGreaterEqual(len(answered), 300)
        cell.start()
        stub = cell.jobs()
        awaited(lambda: stub.GetJob(job_pb2.GetJobRequest(name=answered[1])))
        again = {answer.number: answer.job
                 for answer in stub.SubmitJobs(submission(n, f"r-{n}") for n in answered)}
        self.assertEqual(again, answered)

    def test_a_server_that_stops_answers_what_it_took(self):
        cell = Cell(workers=0).start()
        self.addCleanup(cell.close)
        stream = cell.jobs().SubmitJobs(submission(n) for n in itertools.count(1))
        names = [next(stream).job for _ in range(50)]
        stopper = threading.Thread(target=cell.stop)
        stopper.start()
        try:
            names += [answer.job for answer in stream]
            self.fail("the stream came to a good end")
        except grpc.RpcError as ended:
            self.assertEqual(ended.code(), grpc.StatusCode.UNAVAILABLE)
        stopper.join()
        cell.start()
        stub = cell.jobs()
        for name in (names[0], names[-1]):
            self.assertEqual(eventually(lambda: stub.GetJob(job_pb2.GetJobRequest(name=name))).name, name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
