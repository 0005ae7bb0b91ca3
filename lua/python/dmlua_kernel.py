"""A Jupyter kernel for dmlua: it drives `dmlua --machine`.

Cells go to the child as frames of JSON, one a line, on two descriptors of their own; what the
child and its own children print comes by its stdout and stderr. The protocol stands in
lua/dm/notebook/machine.lua. Installed by `dmlua --jupyter`.
"""

import glob
import json
import os
import selectors
import signal
import subprocess
import sys

# Python is not what cells are debugged in: its debugger would take a third of the start and warn.
sys.modules.setdefault("debugpy", None)

from ipykernel.kernelapp import IPKernelApp
from ipykernel.kernelbase import Kernel


class Died(Exception):
    """The child is gone: with what status."""


class Child:
    """A dmlua process and its four pipes."""

    def __init__(self, program):
        to_child, self.requests = os.pipe()
        self.answers, from_child = os.pipe()
        self.process = subprocess.Popen(
            [program, "--machine=%d,%d" % (to_child, from_child)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            pass_fds=(to_child, from_child),
            start_new_session=True,  # the kernel alone hands interrupts on
        )
        os.close(to_child)
        os.close(from_child)
        self.streams = {self.process.stdout.fileno(): "stdout", self.process.stderr.fileno(): "stderr"}
        self.selector = selectors.DefaultSelector()
        for descriptor in (self.answers, *self.streams):
            os.set_blocking(descriptor, False)
            self.selector.register(descriptor, selectors.EVENT_READ)
        self.rest = b""

    def send(self, **frame):
        data = json.dumps(frame).encode() + b"\n"
        try:
            while data:
                data = data[os.write(self.requests, data):]
        except BrokenPipeError:
            raise Died from None

    def read(self, descriptor):
        """What is there now; b"" at the end, None when there is nothing."""
        try:
            return os.read(descriptor, 1 << 16)
        except BlockingIOError:
            return None

    def frames(self):
        """Whole frames that have come."""
        data = self.read(self.answers)
        if data == b"":
            raise Died
        *lines, self.rest = (self.rest + (data or b"")).split(b"\n")
        return [json.loads(line) for line in lines]

    def close(self):
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(2)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self.selector.close()
        for descriptor in (self.requests, self.answers):
            os.close(descriptor)
        self.process.stdout.close()
        self.process.stderr.close()


class DmluaKernel(Kernel):
    implementation = "dmlua"
    implementation_version = "0.1"
    language_info = {"name": "lua", "mimetype": "text/x-lua", "file_extension": ".lua"}
    banner = "dmlua: discrete mechanics in Lua"
    help_links = []

    def __init__(self, **given):
        super().__init__(**given)
        self.program = os.environ.get("DMLUA", "dmlua")
        self.child = None

    # ---- the child ----

    def ready(self):
        """A child that lives; says so when another had to be started."""
        if self.child and self.child.process.poll() is not None:
            self.lost()
        if not self.child:
            self.child = Child(self.program)
        return self.child

    def lost(self):
        """The child died: the next request starts another."""
        try:
            code = self.child.process.wait(2)
        except subprocess.TimeoutExpired:
            code = 0
        how = "by signal %d" % -code if code < 0 else "with status %d" % code
        self.child.close()
        self.child = None
        self.say("stderr", "dmlua died %s; another is started, without the variables\n" % how)

    def say(self, stream, text):
        self.send_response(self.iopub_socket, "stream", {"name": stream, "text": text})

    def pass_on(self):
        """What was printed until now."""
        for descriptor, name in self.child.streams.items():
            while data := self.child.read(descriptor):
                if not self.silent:
                    self.say(name, data.decode(errors="replace"))
            if data == b"" and descriptor in self.child.selector.get_map():
                self.child.selector.unregister(descriptor)

    def interrupt(self):
        """Ctrl-C, once a cell: a second one would kill."""
        if not self.interrupted:
            self.child.process.send_signal(signal.SIGINT)
        self.interrupted = True

    def answers(self):
        """Frames until one says that the request is done."""
        while True:
            try:
                self.child.selector.select()
                frames = self.child.frames()
                self.pass_on()
            except KeyboardInterrupt:
                self.interrupt()
                continue
            for frame in frames:
                yield frame
                if frame["event"] == "done":
                    return

    def ask(self, **request):
        """The last frame of a request that shows nothing."""
        self.interrupted, self.silent = False, False
        try:
            self.ready().send(**request)
            for frame in self.answers():
                pass
            return frame
        except Died:
            self.lost()
            return {}

    # ---- cells ----

    def read_line(self):
        try:
            return self.raw_input("")
        except KeyboardInterrupt:
            self.interrupt()
        except Exception:  # a front end without input
            pass
        return None

    def show(self, frame):
        """One answer of a cell; the error it tells, if any."""
        event = frame["event"]
        if event == "input":
            self.child.send(op="input", text=self.read_line())
        elif event == "display" and not self.silent:
            data = {frame["type"]: frame["content"], "text/plain": "[%s]" % frame["type"]}
            if frame["type"] == "text/html":
                data["text/html"] = framed(frame["content"])
            self.send_response(self.iopub_socket, "display_data", {"data": data, "metadata": {}})
        elif event == "result" and not self.silent:
            content = {"execution_count": self.execution_count, "data": {"text/plain": frame["text"]}}
            self.send_response(self.iopub_socket, "execute_result", {**content, "metadata": {}})
        elif event == "error":
            return {"ename": frame["name"], "evalue": frame["text"], "traceback": frame["lines"]}
        return None

    def run(self, code):
        self.ready().send(op="execute", code=code)
        error = None
        for frame in self.answers():
            error = self.show(frame) or error
        return error

    def do_execute(self, code, silent, store_history=True, user_expressions=None, allow_stdin=False, **_):
        self.silent, self.interrupted, self._allow_stdin = silent, False, allow_stdin
        if not code.strip():
            error = None
        else:
            try:
                error = self.run(code)
            except Died:
                self.lost()
                error = {"ename": "died", "evalue": "dmlua died in this cell", "traceback": ["dmlua died in this cell"]}
        if not error:
            return {"status": "ok", "execution_count": self.execution_count, "payload": [], "user_expressions": {}}
        if not silent:
            self.send_response(self.iopub_socket, "error", error)
        return {"status": "error", "execution_count": self.execution_count, **error}

    # ---- what the front end asks ----

    def do_complete(self, code, cursor_pos):
        before = code[:cursor_pos]
        got = self.ask(op="complete", code=before)
        first = len(before.encode()[: got.get("first", len(before))].decode(errors="ignore"))
        words = got.get("words", [])
        if got.get("files"):
            words = sorted(glob.glob(glob.escape(before[first:]) + "*"))
        return {"matches": words, "cursor_start": first, "cursor_end": cursor_pos, "metadata": {}, "status": "ok"}

    def do_inspect(self, code, cursor_pos, detail_level=0, omit_sections=()):
        at = len(code[:cursor_pos].encode())
        got = self.ask(op="inspect", code=code, at=at)
        data = {"text/plain": got.get("text", "")} if got.get("found") else {}
        return {"status": "ok", "found": bool(data), "data": data, "metadata": {}}

    def do_is_complete(self, code):
        status = self.ask(op="whole", code=code).get("status", "unknown")
        return {"status": status, "indent": ""} if status == "incomplete" else {"status": status}

    def do_shutdown(self, restart):
        if self.child:
            self.child.close()
            self.child = None
        return {"status": "ok", "restart": restart}


def framed(page):
    """A page of its own inside of the notebook's."""
    source = page.replace("&", "&amp;").replace('"', "&quot;")
    return '<iframe srcdoc="%s" width="100%%" height="620" style="border: 0"></iframe>' % source


if __name__ == "__main__":
    IPKernelApp.launch_instance(kernel_class=DmluaKernel)
