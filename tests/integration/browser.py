"""A headless browser, by the protocol of its developer tools: one page, asked in JavaScript."""
import base64
import json
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import tempfile
import time
import urllib.request

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


class Browser:
    """Until close(). Only where CHROMIUM is there."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="browser-"))
        self.process = subprocess.Popen(
            [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0",
             f"--user-data-dir={self.folder}", "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.asked = 0
        told = self.folder / "DevToolsActivePort"
        self.eventually(told.exists)
        port = int(self.eventually(lambda: told.read_text().split("\n")[0]))
        page = self.eventually(lambda: next((one for one in json.load(
            urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=60)) if one["type"] == "page"), None))
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        path = page["webSocketDebuggerUrl"].split("/", 3)[3]
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET /{path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
                            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        self.answers = self.socket.makefile("rb")
        while self.answers.readline() != b"\r\n":
            pass

    def close(self):
        self.process.terminate()
        self.process.wait(timeout=60)
        shutil.rmtree(self.folder, ignore_errors=True)

    @staticmethod
    def eventually(look, seconds=60):
        until = time.monotonic() + seconds
        while not (seen := look()):
            if time.monotonic() > until:
                raise AssertionError("it never came")
            time.sleep(0.05)
        return seen

    def call(self, method, **arguments):
        self.asked += 1
        text = json.dumps({"id": self.asked, "method": method, "params": arguments}).encode()
        mask = os.urandom(4)
        size = bytes([0x80 | len(text)]) if len(text) < 126 else b"\xfe" + struct.pack(">H", len(text))
        self.socket.sendall(b"\x81" + size + mask + bytes(c ^ mask[i % 4] for i, c in enumerate(text)))
        while True:
            answer = json.loads(self.message())
            if answer.get("id") == self.asked:
                return answer["result"]

    def message(self):
        whole = b""
        while True:
            first, size = self.answers.read(2)
            size &= 0x7F
            if size >= 126:
                size = int.from_bytes(self.answers.read(2 if size == 126 else 8), "big")
            whole += self.answers.read(size)
            if first & 0x80:
                return whole

    def open(self, address, width, height):
        phone = width < 600
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        self.call("Page.navigate", url=address)

    def ask(self, script):
        return self.call("Runtime.evaluate", expression=script, returnByValue=True)["result"].get("value")

    def wait_for(self, script):
        return self.eventually(lambda: self.ask(script))
