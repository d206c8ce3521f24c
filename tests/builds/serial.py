"""The platform without threads, OpenSSL and child processes (LIBCHAR_SERIAL: that of the web page), built natively with
the assertions of the standard library. The unit tests of an ordinary build run against it.

usage: serial.py BUILD [FLOOR…]
BUILD: an ordinary build whose tests are up to date; the library is built in its folder `serial`. FLOORS: those whose
tests run, default below: what the page has, but for what takes minutes."""
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from relinked import ARCHIVES, link_words  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLOORS = "core log allan spectrum fit model simulate export scene lot figure".split()


def run(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, errors="replace", **more)
    if done.returncode:
        sys.exit(f"{' '.join(str(word) for word in command)[:300]}\n{(done.stdout + done.stderr)[-4000:]}")
    return done.stdout


def build_library(folder):
    run("cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "--log-level=WARNING", "-DLIBCHAR_SERIAL=ON",
        "-DCMAKE_BUILD_TYPE=Gate", "-DCMAKE_CXX_FLAGS_GATE=-O1 -D_GLIBCXX_ASSERTIONS", "-DLIBCHAR_TESTS=OFF",
        "-DLIBCHAR_BENCH=OFF", "-DLIBCHAR_WERROR=ON")
    run("ninja", "-C", folder, *(f"libchar/{archive}" for archive in ARCHIVES))


def main():
    build, floors = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:] or FLOORS
    library = build / "serial"
    build_library(library)
    failed = []
    with tempfile.TemporaryDirectory() as scratch:
        for floor in floors:
            program = pathlib.Path(scratch) / f"test_{floor}"
            words = link_words(build, f"tests/test_{floor}", library, "tools/sensorchar")
            run(*(program if word == "PROGRAM" else word for word in words), cwd=build)
            begin = time.monotonic()
            done = subprocess.run([program], capture_output=True, text=True, errors="replace")
            said = done.stdout.strip().splitlines()
            print(f"{floor}: {said[-1] if said else done.returncode} ({time.monotonic() - begin:.0f} s)", flush=True)
            if done.returncode:
                print((done.stdout + done.stderr)[-4000:])
                failed.append(floor)
    sys.exit(f"with another library tests fail: {' '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
