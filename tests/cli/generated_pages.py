"""Man pages, completions and examples, which the program makes of its own table of verbs and options.

usage: generated_pages.py PROGRAM man|bash|zsh|fish|examples    exits with 77 where the shell or man is not installed

man        every page renders without a warning and has every verb, argument and option
bash…      the completion is loaded by that shell and asked: every verb, every option of every verb, words,
files, folders
examples   every command in the help of a verb runs
"""
import json
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time

program, what = os.path.abspath(sys.argv[1]), sys.argv[2]
root = pathlib.Path(__file__).resolve().parent.parent.parent
usage = json.loads(subprocess.run([program, "--generate", "json"], check=True, capture_output=True).stdout)
verbs = {verb["name"]: verb for verb in usage["verbs"]}
scratch = pathlib.Path(tempfile.mkdtemp())
faults = []


def need(tool):
    if not shutil.which(tool):
        print(f"SKIPPED: {tool} is not installed")
        sys.exit(77)


def generated(*words):
    path = scratch / "-".join(words)
    path.write_bytes(subprocess.run([program, "--generate", *words], check=True, capture_output=True).stdout)
    return path


def expect(condition, sentence):
    if not condition:
        faults.append(sentence)


def all_flags(verb):
    return [flag for option in verb["options"] for flag in option["flags"]]


def man():
    need("man")
    environment = dict(os.environ, LC_ALL="C.UTF-8", MANROFFSEQ="", MANWIDTH="80")
    for words in [["man"]] + [["man", name] for name in verbs]:
        page = generated(*words)
        ran = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", str(page)], env=environment,
                             capture_output=True, text=True)
        expect(ran.returncode == 0 and not ran.stderr, f"{page.name}: {ran.stderr}")
        text = re.sub(".\b", "", ran.stdout)
        wanted = [f"sensorchar-{name}" for name in verbs] if len(words) == 1 else all_flags(verbs[words[1]])
        for word in wanted:
            expect(re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", text), f"{page.name} does not have {word}")
        if shutil.which("mandoc"):
            lint = subprocess.run(["mandoc", "-Tlint", "-Werror", str(page)], capture_output=True, text=True)
            expect(lint.returncode == 0, lint.stdout)


def questions():
    """(words of a command line, what must be among the answers, what must not)"""
    yield ["al"], ["allan"], ["psd"]
    yield [""], [*verbs, "help"], []
    yield ["help", "co"], [name for name in verbs if name.startswith("co")], ["allan"]
    for name, verb in verbs.items():
        yield [name, "--"], [flag for flag in all_flags(verb) if flag.startswith("--")], []
        for option in verb["options"]:
            if option["kind"] == "words":
                yield [name, option["flags"][-1], ""], option["words"], ["imu.csv"]
    yield ["allan", "im"], ["imu.csv"], []
    yield ["characterize", "-o", "fol"], ["folder"], ["folder.csv"]
    if "replay" in verbs:
        yield ["replay", "--algorithms", "mean,medi"], ["mean,median"], []


def place():
    (scratch / "place" / "folder").mkdir(parents=True)
    for name in ("imu.csv", "folder.csv"):
        (scratch / "place" / name).write_text("x\n")
    return scratch / "place"


def hold(words, answers, wanted, unwanted):
    answers = {answer.rstrip("/ ") for answer in answers}
    for word in wanted:
        expect(word in answers, f"{what}: {' '.join(words)!r} does not offer {word}, but {sorted(answers)[:20]}")
    for word in unwanted:
        expect(word not in answers, f"{what}: {' '.join(words)!r} offers {word}")


def bash():
    need("bash")
    script = f"""source {generated("bash")}
while IFS=$'\\x1f' read -r -a COMP_WORDS; do
  [[ ${{COMP_WORDS[-1]}} == @ ]] && COMP_WORDS[-1]=""
  COMP_CWORD=$(( ${{#COMP_WORDS[@]}} - 1 ))
  _sensorchar
  (IFS=$'\\x1f'; echo "${{COMPREPLY[*]}}")
done"""
    asked = list(questions())
    equals = (["allan", "--type", "=", "oa"], ["oadev"], ["mdev"])  # as bash splits --type=oa
    lines = "".join("\x1f".join(["sensorchar", *words[:-1], words[-1] or "@"]) + "\n" for words, _,
                    _ in [*asked, equals])
    ran = subprocess.run(["bash", "--norc", "-c", script], input=lines, cwd=place(), capture_output=True, text=True)
    expect(not re.sub(r".*compopt.*\n", "", ran.stderr), ran.stderr)
    answers = ran.stdout.split("\n")
    for (words, wanted, unwanted), answer in zip([*asked, equals], answers):
        hold(words, answer.split("\x1f"), wanted, unwanted)


def fish():
    need("fish")
    asked = list(questions())
    script = f"source {generated('fish')}\n" + "".join(
        f"complete -C {json.dumps(' '.join(['sensorchar', *words]))}\necho ======\n" for words, _, _ in asked)
    ran = subprocess.run(["fish", "--no-config", "-c", script], cwd=place(), capture_output=True, text=True,
                         env=dict(os.environ, HOME=str(scratch)))
    expect(not ran.stderr, ran.stderr)
    for (words, wanted, unwanted), answer in zip(asked, ran.stdout.split("======\n")):
        hold(words, [line.split("\t")[0] for line in answer.split("\n")], wanted, unwanted)


class Typed:
    """A shell in a terminal."""

    def __init__(self, words, folder):
        self.child, self.terminal = pty.fork()
        if self.child == 0:
            os.chdir(folder)
            os.environ.update(TERM="dumb", HOME=str(scratch), COLUMNS="200", LINES="200", LC_ALL="C.UTF-8")
            os.execvp(words[0], words)

    def ask(self, text, until, seconds=20):
        """Types, and reads until a word was shown."""
        os.write(self.terminal, text.encode())
        shown, end = "", time.monotonic() + seconds
        while time.monotonic() < end and until not in shown:
            if select.select([self.terminal], [], [], 0.02)[0]:
                shown += os.read(self.terminal, 65536).decode(errors="replace")
        return shown


def zsh():
    """Through a terminal, as its completion needs one: the matches are taken where zsh adds them."""
    need("zsh")
    answers = scratch / "answers"
    setup = f"""PS1='ready> '; autoload -Uz compinit; compinit -u -D; zstyle ':completion:*' verbose no
source {generated("zsh")}
compadd() {{
  builtin compadd "$@"
  local -a found
  (( argv[(I)-O] || argv[(I)-A] || argv[(I)-D] )) && return
  builtin compadd -A found "$@"
  print -rl -- $found >> {answers}
}}
answer() {{ : > {answers}; _main_complete; compstate[insert]=; compstate[list]=; print -r DONE >> {answers} }}
zle -C answer complete-word answer; bindkey '^T' answer
print SET''UP
"""
    (scratch / "setup.zsh").write_text(setup)
    shell = Typed(["zsh", "-f", "-i"], place())
    expect("SETUP" in shell.ask(f" source {scratch / 'setup.zsh'}\n", "SETUP"), "zsh does not start")
    for words, wanted, unwanted in questions():
        answers.write_text("")
        shell.ask("\x15" + " ".join(["sensorchar", *words]) + "\x14", "\x00", 0.05)
        end = time.monotonic() + 60
        while "DONE" not in answers.read_text() and time.monotonic() < end:
            shell.ask("", "\x00", 0.05)
        # Of a list, zsh replaces the word behind the last comma.
        hold(words, [line.split(":")[0] for line in answers.read_text().split("\n")],
             [word.split(",")[-1] for word in wanted], unwanted)
    os.close(shell.terminal)
    os.waitpid(shell.child, 0)


def run(command, folder):
    environment = dict(os.environ, PATH=f"{scratch}/bin:{os.environ['PATH']}", TERM="dumb")
    return subprocess.run(["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)


LONG = {"sensorchar bench --quick"}  # half a minute: that it is understood is enough


def examples():
    """In the order of the help, so that one may use what another wrote."""
    (scratch / "bin").mkdir()
    (scratch / "bin" / "sensorchar").symlink_to(program)
    shutil.copy(root / "fixtures/imu_at_rest.csv", scratch / "imu.csv")
    (scratch / "curve.csv").write_text("tau,adev\n" + "".join(f"{0.1 * 1.5 ** k},{0.02 / 1.5 ** (k / 2) + 0.001}\n"
                                                              for k in range(20)))
    shutil.copy(root / "fixtures/npy/c_order.npy", scratch / "counts.npy")
    cut = [f"sensorchar convert imu.csv -o logs/a0{k}.npy --from {100 * k} --to {100 * k + 100}" for k in range(4)]
    (scratch / "line7.yaml").write_text("format: fleet-manifest\nversion: 1\ndefaults: {options: "
                                        "{reading: {rate_hz: 50}}}\ndevices:\n" + "".join(
        f"  - {{log: logs/a0{k}.npy, batch: '2026-1{1 + k % 2}'}}\n" for k in range(4)))
    before = {"compare": [*(f"cp imu.csv {name}.csv" for name in "ABC"),
                          "cp -r report monday", "cp -r report friday", "cp -r array-replay new-replay"],
              "fleet-plan": ["mkdir logs", *cut, "cd logs && sha256sum *.npy > SHA256SUMS"],
              "fleet-merge": ["sensorchar fleet plan logs/a00.npy logs/a01.npy --rate 50 -o april && sensorchar "
                              "fleet run april",
                              "sensorchar fleet plan logs/a02.npy logs/a03.npy --rate 50 -o may && sensorchar fleet "
                              "run may"],
              "fleet-compare": ["cp -r may march"]}
    for verb in usage["verbs"]:
        expect(len(verb["examples"]) >= 2, f"{verb['name']} has fewer than two examples")
        for command in before.get(verb["name"], []):
            ran = run(command, scratch)
            expect(ran.returncode == 0, f"{command}: {ran.stderr}")
        for example in verb["examples"]:
            command = example["command"]
            words = (f"sensorchar {verb['name']} ", f"sensorchar {verb['name'].replace('-', ' ')} ")
            expect(f"{command} ".startswith(words), f"{command} is no example of {verb['name']}")
            if command in LONG:
                continue
            ran = run(command, scratch)
            expect(ran.returncode == 0, f"{command}: code {ran.returncode}: {ran.stderr}")


try:
    {"man": man, "bash": bash, "zsh": zsh, "fish": fish, "examples": examples}[what]()
finally:
    shutil.rmtree(scratch, ignore_errors=True)
print("\n".join(faults[:40]) or f"{what}: as the program says of itself")
sys.exit(bool(faults))
