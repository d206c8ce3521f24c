"""The program under test, run again and again: by a fork server (fork_server.cpp) where it is given, else by exec."""
import os
import pathlib
import resource
import select
import signal
import struct
import subprocess
import tempfile

TIMEOUT = 30  # seconds of processor time; a sleeper gets ten minutes
MEMORY = 8 << 30
RESULT = struct.Struct("<qqq")


def limits():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
    if MEMORY:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (TIMEOUT, TIMEOUT))


def run(program, words, folder):
    """Exit code (None: it did not end), standard output and error, seconds of processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run([program, *words], cwd=folder, capture_output=True, timeout=20 * TIMEOUT,
                              stdin=subprocess.DEVNULL, preexec_fn=limits, check=False)
        code, out, err = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired as slow:
        code, out, err = None, slow.stdout or b"", slow.stderr or b""
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code, out, err, now.ru_utime + now.ru_stime - before.ru_utime - before.ru_stime


class Server:
    """Runs as `run` does; the libraries are loaded once."""

    def __init__(self, program, shim, scratch):
        self.program, self.shim = program, shim
        self.texts = [pathlib.Path(tempfile.mkstemp(dir=scratch)[1]) for _ in range(2)]
        self.server = None

    def start(self):
        commands, self.to = os.pipe()
        self.back, results = os.pipe()
        environment = dict(os.environ, LD_PRELOAD=self.shim, LIBCHAR_FORK_SERVER=f"{commands},{results}")
        self.server = subprocess.Popen([self.program], env=environment, pass_fds=(commands, results),
                                       stdin=subprocess.DEVNULL, preexec_fn=limits, start_new_session=True)
        os.close(commands)
        os.close(results)

    def stop(self):
        if self.server is None:
            return
        os.killpg(self.server.pid, signal.SIGKILL)
        self.server.wait()
        os.close(self.to)
        os.close(self.back)
        self.server = None

    def run(self, words, folder):
        if self.server is None:
            self.start()
        command = b"".join(os.fsencode(word) + b"\0" for word in (folder, *self.texts, *words))
        os.write(self.to, struct.pack("<I", len(command)) + command)
        ended = select.select([self.back], [], [], 20 * TIMEOUT)[0]
        result = os.read(self.back, RESULT.size) if ended else b""
        if len(result) < RESULT.size:
            self.stop()
        out, err = (text.read_bytes() for text in self.texts)
        if len(result) < RESULT.size:
            return None, out, err, float("inf")
        status, microseconds, _ = RESULT.unpack(result)
        return os.waitstatus_to_exitcode(status), out, err, microseconds / 1e6
