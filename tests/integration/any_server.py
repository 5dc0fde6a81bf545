"""A server of all services that keeps what it is asked, and answers with what it was told to."""
import concurrent.futures
import os
import sys

sys.path.insert(0, os.environ["RMLCELL_STUBS"])

import grpc  # noqa: E402
from google.protobuf import json_format, message_factory  # noqa: E402
from rmlcell.v1 import cell_pb2, host_pb2, job_pb2, language_pb2, machine_pb2, program_pb2, project_pb2  # noqa: E402

FILES = (cell_pb2, host_pb2, job_pb2, language_pb2, machine_pb2, program_pb2, project_pb2)


def message_of(descriptor):
    return message_factory.MessageFactory().GetPrototype(descriptor)


class AnyServer(grpc.GenericRpcHandler):
    """`asked` is a list of (method, fields) in order; `answers` gives a method other fields than none."""

    def __init__(self):
        self.asked = []
        self.answers = {}
        self.methods = {f"/{service.full_name}/{method.name}": method for file in FILES
                        for service in file.DESCRIPTOR.services_by_name.values() for method in service.methods}
        self.server = grpc.server(concurrent.futures.ThreadPoolExecutor(8), handlers=[self])
        self.address = f"127.0.0.1:{self.server.add_insecure_port('127.0.0.1:0')}"
        self.server.start()

    def close(self):
        self.server.stop(None).wait()

    def service(self, details):
        method = self.methods.get(details.method)
        if method is None:
            return None
        request, response = message_of(method.input_type), message_of(method.output_type)

        def answer(message):
            self.asked.append((method.name, json_format.MessageToDict(message)))
            return json_format.ParseDict(self.answers.get(method.name, {}), response())

        def of_many(messages):
            every = [json_format.MessageToDict(message) for message in messages]
            self.asked.append((method.name, every))
            return json_format.ParseDict(self.answers.get(method.name, {}), response())

        kind = grpc.stream_unary_rpc_method_handler if method.client_streaming else grpc.unary_unary_rpc_method_handler
        call = of_many if method.client_streaming else lambda message, context: answer(message)
        if method.server_streaming:
            kind, call = grpc.unary_stream_rpc_method_handler, lambda message, context: iter([answer(message)])
        elif method.client_streaming:
            call = lambda messages, context: of_many(messages)  # noqa: E731
        return kind(call, request_deserializer=request.FromString, response_serializer=response.SerializeToString)

    def take(self):
        asked, self.asked = self.asked, []
        return asked
