#!/usr/bin/env python3
"""What the contract has and this version does not do stands in tests/conformance/later_methods.csv: these methods, and
no others, answer UNIMPLEMENTED."""
import csv
import unittest

from google.protobuf import descriptor_pb2

from cell import ROOT, WithCell, detail_of, grpc
from rmlcell.v1 import (account_pb2, cell_pb2, handbox_pb2, host_pb2, job_pb2, machine_pb2, program_pb2, project_pb2,
                        worker_pb2)

FILES = (account_pb2, cell_pb2, handbox_pb2, host_pb2, job_pb2, machine_pb2, program_pb2, project_pb2, worker_pb2)


def methods():
    """(service, method, whether the client streams, whether the server streams), of the whole contract."""
    for file in FILES:
        for service in file.DESCRIPTOR.services_by_name.values():
            for method in service.methods:
                proto = descriptor_pb2.MethodDescriptorProto()
                method.CopyToProto(proto)
                yield service.name, method.name, proto.client_streaming, proto.server_streaming


class Later(WithCell):
    def answer(self, service, name, client_streams, server_streams):
        """The error of a call with an empty request; None where its first answer comes."""
        kind = f"{'stream' if client_streams else 'unary'}_{'stream' if server_streams else 'unary'}"
        call = getattr(self.cell.channel(), kind)(f"/rmlcell.v1.{service}/{name}")
        try:
            done = call(iter([b""]) if client_streams else b"", timeout=60)
            if server_streams:
                next(done, None)
                done.cancel()
        except grpc.RpcError as error:
            return error
        return None

    def test_the_table_and_the_server_say_the_same(self):
        with open(ROOT / "tests/conformance/later_methods.csv", encoding="utf-8", newline="") as file:
            table = {(row["service"], row["method"]) for row in csv.DictReader(file)}
        found = set()
        for service, name, *streams in methods():
            error = self.answer(service, name, *streams)
            if error is not None and error.code() == grpc.StatusCode.UNIMPLEMENTED:
                detail = detail_of(error)
                self.assertEqual((detail.code, detail.message), ("CELL-E9014", f"{service}/{name}"))
                found.add((service, name))
        self.assertEqual(found - table, set(), "these say UNIMPLEMENTED and are not in the table")
        self.assertEqual(table - found, set(), "these are in the table and do not say UNIMPLEMENTED")


if __name__ == "__main__":
    unittest.main(verbosity=2)
