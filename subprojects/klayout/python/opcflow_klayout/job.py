# SPDX-License-Identifier: BSD-3-Clause
"""A run of opcflow as a process of its own. No function waits for the end of the run."""
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile

try:
    import pty
except ImportError:  # Windows: messages, but no progress
    pty = None

HERE = os.path.dirname(os.path.realpath(__file__))
INSTALLED = os.path.join(HERE, *[".."] * 5, "bin", "opcflow")
# Settings of a simulation of the drawn mask.
SIMULATE = ("mask.max_iterations=0", "mask.guard=off")
# Status line of the program: [STEP NUMBER/STEPS] STEP  DONE/TOTAL  worst VALUE.
STATUS = re.compile(r"\[(\d+)/(\d+)\] (\S+)(?:  ([\d.e+]+)/([\d.e+]+))?(?:  (worst .*?))?(?:  |$)")


class Failed(RuntimeError):
    """The program cannot start, or ended without results."""


def program():
    """Return the path of the program: OPCFLOW_COMMAND, the program that was installed with this
    package, or the one in the PATH."""
    chosen = os.environ.get("OPCFLOW_COMMAND")
    for path in [chosen] if chosen else [INSTALLED, shutil.which("opcflow")]:
        if path and os.path.isfile(path) and os.access(path, os.X_OK):
            return os.path.normpath(path)
    if chosen:
        raise Failed("OPCFLOW_COMMAND: '%s' is not a program." % chosen)
    raise Failed("The program opcflow is not in the PATH (set OPCFLOW_COMMAND).")


def ending(code):
    """Return how a process ended, from its exit code."""
    if code >= 0:
        return "opcflow ended with exit code %d." % code
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = "signal %d" % -code
    return "opcflow crashed or was ended by another program (%s)." % name


def ask(words, folder=None):
    """Execute a short command. Returns exit code and all messages."""
    done = subprocess.run([program(), *words], cwd=folder, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout.strip()


def processes():
    """Return the names of the processes that the program knows."""
    with tempfile.TemporaryDirectory(prefix="opcflow-klayout-") as folder:
        open(os.path.join(folder, "none.gds"), "w").close()
        _, text = ask(["new", "flow", "--process", "?", "none.gds"], folder)
    known = re.search(r"known: (.*)", text)
    return known[1].split(", ") if known else []


class Job:
    """A run of the flow of a process on the layout `file`. Call poll() until it returns True.

    folder    the run folder, if the run has results
    status    step and progress, such as "mask 3/100, worst 0.8 %"
    fraction  progress from 0 to 1, or None if unknown
    messages  warnings and errors
    code      exit code, None while the process runs
    """

    def __init__(self, file, process, simulate=False, settings=()):
        place = os.path.dirname(os.path.abspath(file))
        self.folder = os.path.join(place, "run")
        self.status, self.fraction, self.messages, self.code = "", None, [], None
        self.document, self.rest, self.cancelled = {}, "", False
        code, text = ask(["new", "flow", "--process", process, os.path.basename(file)], place)
        if code:
            raise Failed(text)
        words = [program(), "run", "flow.yaml", "--json", "--output", self.folder]
        for setting in (*(SIMULATE if simulate else ()), *settings):
            words += ["--set", setting]
        self.output = tempfile.TemporaryFile("w+")
        if pty:
            self.terminal, messages = pty.openpty()
            os.set_blocking(self.terminal, False)
        else:
            messages = open(os.path.join(place, "messages"), "wb")
            self.terminal = os.open(os.path.join(place, "messages"), os.O_RDONLY)
        try:
            self.process = subprocess.Popen(
                words, cwd=place, stdin=subprocess.DEVNULL, stdout=self.output, stderr=messages,
                env={**os.environ, "NO_COLOR": "1"})
        finally:
            os.close(messages) if pty else messages.close()

    def read(self):
        """Take the new output of the process."""
        parts = []
        while True:
            try:
                part = os.read(self.terminal, 1 << 16)
            except OSError:  # nothing to read, or closed by the process
                break
            if not part:
                break
            parts.append(part)
        text = self.rest + b"".join(parts).decode(errors="replace").replace("\x1b[K", "")
        *lines, self.rest = re.split(r"[\r\n]+", text)
        for line in lines:
            self.take(line)
        if self.rest.startswith("["):  # the program ends a status line when it writes the next
            self.take(self.rest)

    def take(self, line):
        """Interpret a line of the program."""
        status = STATUS.match(line)
        if not status:
            # Times of steps are no messages; a finding repeats a warning.
            self.messages += [line] if line and not line.startswith(("[", "finding: ")) else []
            return
        number, count, step, done, total, worst = status.groups()
        part = float(done) / float(total) if total and float(total) > 0 else 0
        self.fraction = max(self.fraction or 0, (int(number) - 1 + min(part, 1)) / int(count))
        self.status = step + (" %s/%s" % (done, total) if total else "")
        self.status += ", " + worst if worst else ""

    def poll(self):
        """Take new output. Returns True if the process ended; Failed if there are no results."""
        if self.code is not None:
            return True
        code = self.process.poll()
        self.read()
        if code is None:
            return False
        self.code = code
        os.close(self.terminal)
        with self.output as f:
            f.seek(0)
            text = f.read()
        try:
            self.document = json.loads(text) if text.strip() else {}
        except ValueError:  # incomplete, because the process ended early
            self.document = {}
        if self.cancelled:
            raise Failed("The run was cancelled.")
        if not os.path.isfile(os.path.join(self.folder, "manifest.json")) or code not in (0, 1):
            problems = [p["message"] for p in self.document.get("problems", ())]
            said = problems or self.messages
            raise Failed("\n".join([*said, *([] if said and code >= 0 else [ending(code)])]))
        return True

    def cancel(self):
        """Ask the process to end; poll() returns the end. The program leaves no files."""
        if self.code is None:
            self.cancelled = True
            self.process.terminate()

    def close(self):
        """End the process at once."""
        if self.code is None:
            self.cancelled = True
            self.process.kill()
            self.process.wait()
            os.close(self.terminal)
            self.output.close()
            self.code = -1
