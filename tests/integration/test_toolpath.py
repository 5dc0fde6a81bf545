#!/usr/bin/env python3
"""The toolpath of a job, as docs/toolpath.md has it: at its levels of detail, and while the job runs."""
import math
import unittest

from cell import WithCell, awaited, detail_of, grpc, inline_job, job_pb2, submit, wait_for_end


class Toolpaths(WithCell):
    def test_a_toolpath_comes_in_levels_of_detail(self):
        stub = self.cell.jobs()
        # Forty chords of a circle of 20 mm: 40 lines, each 0.062 mm off the circle.
        points = [(20 * math.cos(k * math.pi / 20), 20 * math.sin(k * math.pi / 20)) for k in range(41)]
        source = "COORD ABSOL\nSPEED 10\n" + "".join(
            f"MOVE ({1000 + x:.3f},{1000 + y:.3f},0.,0.,0.)\n" for x, y in points)
        job = submit(stub, inline_job("optimo-1", "circle.S", source))
        wait_for_end(stub, job.name)

        def size(level):
            blocks = stub.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name=job.name, level=level))
            return sum(len(message.block) for message in blocks)
        sizes = [size(level) for level in range(6)]
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        self.assertLess(sizes[2], sizes[0] / 2)
        self.assertGreater(sizes[5], 0)
        for level in (-1, 6):
            with self.assertRaises(grpc.RpcError) as caught:
                size(level)
            self.assertEqual(detail_of(caught.exception).code, "CELL-E9003")

    # Who follows it has at the end what is stored, and saw the way grow before.
    def test_a_toolpath_is_followed_while_its_job_runs(self):
        stub = self.cell.jobs()
        job = inline_job("mill-1", "grows.rml", "PA;PA;VS5;!PZ0,200;PU0,0;" + "PD900,100;PD100,900;" * 3 + "PU0,0;")
        job.simulation.pace = 10.0

        def parts(name, follow):
            return list(stub.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name=name, follow=follow), timeout=60))

        def seen_growing():
            """Whoever is late to look at it, or between two looks, sees its end: then at another one."""
            name = submit(stub, job).name
            followed = parts(name, True)
            return (name, followed) if sum(p.HasField("open_block") for p in followed) > 1 else None
        name, followed = awaited(seen_growing)
        stored = parts(name, False)
        self.assertFalse(followed[0].header.complete)
        self.assertTrue(followed[-1].header.complete)
        self.assertEqual(followed[-1].header, stored[0].header)
        self.assertEqual([p.block for p in followed if p.HasField("block")], [p.block for p in stored[1:]])
        grown = [len(p.open_block) for p in followed if p.HasField("open_block")]
        self.assertEqual(grown, sorted(grown))
        # Of one that is over it is the same stream.
        self.assertEqual(parts(name, True), stored)
        self.refused(lambda request, timeout: list(stub.StreamJobToolpath(request, timeout=timeout)),
                     job_pb2.StreamJobToolpathRequest(name=name, follow=True, level=2),
                     grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")


if __name__ == "__main__":
    unittest.main(verbosity=2)
