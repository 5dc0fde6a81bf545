"""A machine with a handbox that is and says what it is told to, and keeps what it is asked."""
import concurrent.futures
import os
import sys
import threading

sys.path.insert(0, os.environ["RMLCELL_STUBS"])

import grpc  # noqa: E402
from google.protobuf import json_format, message_factory  # noqa: E402
from rmlcell.v1 import cell_pb2, handbox_pb2, job_pb2, machine_pb2  # noqa: E402


def message_of(descriptor):
    return message_factory.MessageFactory().GetPrototype(descriptor)


class ToldMachine(grpc.GenericRpcHandler):
    """`answers` gives a method other fields than none; `refused` a code and a text."""

    def __init__(self):
        self.asked = []
        self.answers = {"AcquireControl": {"controlToken": "t"}, "CreateHandboxSession": {"name": "machines/m/handboxSessions/1"}}
        self.refused = {}
        self.lock = threading.Lock()
        self.changed = threading.Condition()
        self.streams = {}  # of a method: how often it said something, and what is true now; None: it ends
        self.status = {"machine": "machines/m", "state": "MACHINE_STATE_IDLE", "zeroed": True}
        self.methods = {f"/{service.full_name}/{method.name}": method for file in (cell_pb2, handbox_pb2, job_pb2, machine_pb2)
                        for service in file.DESCRIPTOR.services_by_name.values() for method in service.methods}
        self.server = grpc.server(concurrent.futures.ThreadPoolExecutor(16), handlers=[self])
        self.address = f"127.0.0.1:{self.server.add_insecure_port('127.0.0.1:0')}"
        self.server.start()

    def close(self):
        self.server.stop(None).wait()

    def service(self, details):
        method = self.methods.get(details.method)
        if method is None:
            return None
        request, response = message_of(method.input_type), message_of(method.output_type)

        def note(message, context):
            with self.lock:
                self.asked.append((method.name, json_format.MessageToDict(message)))
                code, text = self.refused.get(method.name, (None, ""))
            if code:
                context.abort(code, text)

        def answer(message, context):
            note(message, context)
            fields = {"status": self.status} if method.name == "GetMachine" else self.answers.get(method.name, {})
            return json_format.ParseDict(fields, response())

        def stream(message, context):
            note(message, context)
            said = 0
            while context.is_active():
                with self.changed:
                    self.changed.wait_for(lambda: self.streams.get(method.name, (0,))[0] != said, 0.1)
                    times, fields = self.streams.get(method.name, (0, None))
                if times == said:
                    continue
                said = times
                if fields is None:
                    return
                yield json_format.ParseDict(fields, response())

        kind = grpc.unary_stream_rpc_method_handler if method.server_streaming else grpc.unary_unary_rpc_method_handler
        return kind(stream if method.server_streaming else answer,
                    request_deserializer=request.FromString, response_serializer=response.SerializeToString)

    def say(self, method, fields):
        with self.changed:
            self.streams[method] = (self.streams.get(method, (0,))[0] + 1, fields)
            self.changed.notify_all()

    def is_now(self, **fields):
        self.status = {**self.status, **fields}
        self.say("WatchMachine", {"status": self.status})

    def shows(self, display, **fields):
        self.say("WatchHandbox", {"panel": {"display": display, "mode": "OPERATING_MODE_MANUAL", **fields}})

    def all_of(self, method):
        with self.lock:
            return [fields for name, fields in self.asked if name == method]

    def pressed(self):
        """ "X+ PRESS, X+ RELEASE" in the order of their numbers."""
        keys = sorted(self.all_of("PressKey"), key=lambda fields: int(fields["sequence"]))
        return ", ".join(f"{fields['key']} {fields['action'].removeprefix('KEY_ACTION_')}" for fields in keys)
