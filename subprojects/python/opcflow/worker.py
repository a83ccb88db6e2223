# SPDX-License-Identifier: BSD-3-Clause
"""The process that executes one plugin instance. The host starts the process with a socket at
descriptor 3, and a second socket at descriptor 4 whose other end closes with the host."""
import faulthandler
import fcntl
import importlib.util
import json
import mmap
import os
import signal
import socket
import sys
import traceback

import numpy as np

from .data import TYPES, copied, decode
from .plugins import Plugin

TALK, LIFE = 3, 4
HERE = os.path.dirname(os.path.abspath(__file__))


def follow_host():
    """End with the host: the kernel sends SIGIO, whose default action ends the process, when
    the other end of the socket closes."""
    fcntl.fcntl(LIFE, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(LIFE, fcntl.F_SETFL, fcntl.fcntl(LIFE, fcntl.F_GETFL) | os.O_ASYNC)


def load(path, id):
    """Return the class of the plugin that the file defines."""
    spec = importlib.util.spec_from_file_location("opcflow_plugin_" + id.replace(".", "_"), path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    sys.path.insert(1, os.path.dirname(path))
    spec.loader.exec_module(module)
    found = [c for c in vars(module).values()
             if isinstance(c, type) and issubclass(c, Plugin) and c.__module__ == spec.name]
    if len(found) != 1:
        raise TypeError("expected one plugin class, found %d" % len(found))
    return found[0]


def sources(path):
    """Return the files that determine the results: the plugin, the modules beside the plugin,
    this package, the interpreter, and the version of NumPy."""
    beside = os.path.dirname(path) + os.sep
    files = {path, os.path.realpath(sys.executable), sys.modules["numpy.version"].__file__}
    for module in list(sys.modules.values()):
        file = getattr(module, "__file__", None)
        if file and (os.path.abspath(file).startswith(beside)):
            files.add(os.path.abspath(file))
    files.update(os.path.join(HERE, name) for name in os.listdir(HERE) if name.endswith(".py"))
    return sorted(files)


class Memory:
    """Files in memory that the host shares, by number: 0 for the arrays of a call, others for
    arrays of the host. Arrays are views without a copy."""

    def __init__(self):
        self.file, self.maps = -1, {}
        self.former = []  # mappings of file 0 that were too small for new arrays of the call

    def open(self, size, drop, numbers, files):
        """Close the files `drop`; map new files, and at least `size` bytes of file 0."""
        for number in drop:
            self.maps.pop(number)
        for number, file in zip(numbers, files):
            self.maps[number] = mmap.mmap(file, 0)
            if number:
                os.close(file)
            else:
                self.file, old = file, self.file
                os.close(old) if old >= 0 else None
        if len(self.maps[0]) < size:
            self.former.append(self.maps[0])
            self.maps[0] = mmap.mmap(self.file, size)

    def array(self, type, offset, count, width, number, writable):
        """Return an array of `count` rows; width 0: of one dimension."""
        size = count * max(width, 1)
        array = np.frombuffer(self.maps[number], TYPES[type], size, offset) if size \
            else np.zeros(0, TYPES[type])
        array.flags.writeable = writable
        return array.reshape(count, width) if width else array

    def kept(self):
        """Return the numbers of the files to which an array still refers."""
        idle = 2  # references: that of the container, and the argument of getrefcount
        found = {n for n in self.maps if sys.getrefcount(self.maps[n]) > idle}
        while self.former:
            if sys.getrefcount(self.former[-1]) > idle:
                found.add(0)
            self.former.pop()
        return sorted(found)

    def add(self, array, used):
        """Append an array after `used` bytes. Returns its description, and the bytes used."""
        type = {"f4": "f4", "i4": "i4"}.get(array.dtype.str[1:], "f8")
        used = (used + 63) // 64 * 64
        size = used + array.size * TYPES[type]().nbytes
        if size > len(self.maps[0]):
            os.ftruncate(self.file, 2 * size)
            self.open(2 * size, (), (), ())
        if array.size:
            np.frombuffer(self.maps[0], TYPES[type], array.size, used)[:] = array.ravel()
        return {"array": [type, used, array.size, 0]}, size


class Channel:
    """Lines of JSON on the socket, with the descriptors of files in memory."""

    def __init__(self, memory):
        self.socket = socket.socket(fileno=TALK)
        self.memory, self.input = memory, b""

    def receive(self):
        """Return the next message, and the descriptors that it brings."""
        files = []
        parts = [self.input]
        while b"\n" not in parts[-1]:
            part, new, _, _ = socket.recv_fds(self.socket, 1 << 16, 253)
            if not part:
                os._exit(0)
            files += new
            parts.append(part)
        line, self.input = b"".join(parts).split(b"\n", 1)
        return json.loads(line), files

    def send(self, message):
        self.socket.sendall(json.dumps(message).encode() + b"\n")

    def ask(self, what, **fields):
        """Send a message during a call, and return the answer of the host."""
        self.send({"ask": what, **fields})
        reply, _ = self.receive()
        if reply.get("error"):
            raise RuntimeError(reply["error"])
        return reply.get("answer")


def fault(path, error):
    """Describe an exception: message, place in the plugin's file, traceback."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if not f.filename.startswith((HERE, "<frozen"))]
    inside = [f for f in own if f.filename == path] or own
    place = "%s:%d" % (os.path.basename(inside[-1].filename), inside[-1].lineno) if inside else ""
    if isinstance(error, SyntaxError) and error.filename:
        place = "%s:%s" % (os.path.basename(error.filename), error.lineno)
    name = type(error).__name__
    out = {"message": "%s: %s" % (name, error) if str(error) else name, "place": place,
           "traceback": "".join(["Traceback (most recent call last):\n",
                                 *traceback.format_list(own),
                                 *traceback.format_exception_only(type(error), error)]).rstrip()}
    if hasattr(error, "parameter"):
        out.update(parameter=error.parameter, message=str(error), place="")
    return out


def call(request, plugin, path, memory):
    """Execute a request and return the values of the reply."""
    if request["call"] == "describe":
        return {**type(plugin).describe(), "files": sources(path), "python": sys.executable}
    values = request["values"]
    plugin.set_parameters(values.pop("parameters", {}))
    values = {name: decode(v, memory.array) for name, v in values.items()}
    for name in ("gates", "scanner"):
        if name in values:
            setattr(plugin, name, copied(values.pop(name)))
    reply = getattr(plugin, "call_" + request["call"])(**values) or {}
    used = request["used"]
    for name, value in reply.items():
        if isinstance(value, np.ndarray):
            reply[name], used = memory.add(value, used)
    return reply


def serve(path, channel, memory, make):
    """Answer requests until the host closes the socket."""
    plugin = None
    while True:
        request, files = channel.receive()
        memory.open(request["size"], request["drop"], request["files"], files)
        try:
            if plugin is None:
                plugin = make()()
                plugin.ask = channel.ask
            reply = {"values": call(request, plugin, path, memory)}
        except (Exception, KeyboardInterrupt) as error:
            reply = {"error": fault(path, error)}
        reply["kept"] = memory.kept()
        sys.stdout.flush()
        sys.stderr.flush()
        channel.send(reply)


def main(path, id):
    """Serve the plugin `id` in the file `path`."""
    follow_host()
    faulthandler.enable()
    faulthandler.register(signal.SIGUSR1)
    memory = Memory()
    serve(path, Channel(memory), memory, lambda: load(path, id))
