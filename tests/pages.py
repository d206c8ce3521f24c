"""Fails on names that do not exist: in the pages (README.md, docs/) and in comments of the sources. usage:
pages.py ROOT

- a file in `backticks` or in a link is in the repository (a bare name like `power_bins.cpp` anywhere in it);
  NAME, TARGET, FLOOR and other words in capitals stand for any name;
- a page that a comment names (docs/….md) is in the repository;
- in docs/dev/architecture.md and docs/dev/contributing.md every `function()` or `Type` in a row of a table that names
  files stands in one of them.
"""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
listed = subprocess.run(["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard"],
                        capture_output=True, text=True)
files = listed.stdout.split("\n") if listed.returncode == 0 and listed.stdout else [
    p.relative_to(root).as_posix() for p in root.rglob("*") if p.is_file()
    and not p.relative_to(root).parts[0].startswith("build")]
files = {f for f in files if f and (root / f).is_file()}
folders = {parent.as_posix() for f in files for parent in pathlib.PurePosixPath(f).parents}
names = {pathlib.PurePosixPath(f).name for f in files}
wrong = []

FOLDERS = "libchar|tools|tests|docs|fixtures|\\.ci"
SOURCE = r"[\w./{},*-]+\.(?:cpp|hpp|py|sh|md|cmake|txt|cmake\.in)"
# Files of the programs that our exports are for.
FOREIGN = {"report.md", "imu_params.cpp", "imu_err.py", "imu_config.py", "carla_imu.py", "ekf_params.txt"}


def alternatives(text):
    """a.{hpp,cpp} → a.hpp, a.cpp"""
    brace = re.search(r"\{([^{}]*)\}", text)
    if not brace:
        return [text]
    return [one for part in brace[1].split(",")
            for one in alternatives(text[:brace.start()] + part + text[brace.end():])]


def exists(name, page):
    if re.search(r"[A-Z]{4,}", re.sub(r"README|CMakeLists|INDEX|NOTICE|LICENSE|EXPECT", "", name)):
        return True  # a placeholder
    if re.search(r"\*", name):
        pattern = re.compile("(^|/)" + re.escape(name.rstrip("/")).replace(r"\*", "[^/]*") + "$")
        return any(pattern.search(f) for f in files | folders)
    clean = name.rstrip("/")
    here = pathlib.PurePosixPath(page).parent
    if clean in files or clean in folders or (here / clean).as_posix() in files | folders:
        return True
    normal = pathlib.PurePosixPath(*[p for p in (here / clean).parts if p != "."])
    while ".." in normal.parts:
        at = normal.parts.index("..")
        normal = pathlib.PurePosixPath(*normal.parts[:at - 1],
                                       *normal.parts[at + 1:]) if at else normal.relative_to("..")
    if normal.as_posix() in files | folders:
        return True
    # A path within libchar or a bare name.
    return any(f.endswith("/" + clean) for f in files)


def leads_to(link, page):
    """As a browser follows it: from the folder of the page."""
    target = (root / page).parent / link
    return target.exists() and target.resolve().is_relative_to(root.resolve())


def check_page(page):
    text = (root / page).read_text()
    text = re.sub(r"^```.*?^```", lambda m: "\n" * m[0].count("\n"), text, flags=re.S | re.M)
    for number, line in enumerate(text.split("\n"), 1):
        for link in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", line):
            if "://" not in link and not leads_to(link, page):
                wrong.append(f"{page}:{number}: link to {link}: no such file")
        for word in re.findall(r"`([^`]+)`", line):
            path = re.fullmatch(rf"(?:{FOLDERS})/[\w./{{}},*-]*", word) or re.fullmatch(SOURCE, word)
            if path and word not in FOREIGN:
                for one in alternatives(word):
                    # What a build makes is there after it only.
                    if not exists(one, page):
                        wrong.append(f"{page}:{number}: `{word}`: no such file")


def check_rows(page):
    """In a row of a table: what is named beside files stands in one of them."""
    for number, line in enumerate((root / page).read_text().split("\n"), 1):
        if not line.startswith("|"):
            continue
        words = re.findall(r"`([^`]+)`", line)
        beside = [f for w in words for one in alternatives(w) for f in files if f == one or f.endswith("/" + one)]
        if not beside:
            continue
        sources = "\n".join((root / f).read_text(errors="replace") for f in beside)
        for word in words:
            called = re.fullmatch(r"(?:\w+::)*(\w+)\(\)", word) or re.fullmatch(r"([A-Z][a-z]\w*)", word)
            if called and not re.search(rf"\b{called[1]}\b", sources):
                wrong.append(f"{page}:{number}: `{word}` is in none of the files of its row")


def check_comments(source):
    for number, line in enumerate((root / source).read_text(errors="replace").split("\n"), 1):
        comment = re.search(r"(//|#|\"\"\").*", line)
        for page in re.findall(r"[\w/.-]*\w\.md\b", comment[0] if comment else ""):
            if page not in files and pathlib.PurePosixPath(page).name not in names | FOREIGN:
                wrong.append(f"{source}:{number}: {page}: no such page in this repository")


for page in sorted(f for f in files if f.endswith(".md")):
    check_page(page)
for page in ("docs/dev/architecture.md", "docs/dev/contributing.md"):
    check_rows(page)
for source in sorted(f for f in files if f.endswith((".cpp", ".hpp", ".py", ".txt", ".cmake"))
                     and f.startswith(("libchar/", "tools/", "tests/"))):
    check_comments(source)
print("\n".join(wrong) or f"pages: every file and name in {sum(f.endswith('.md') for f in files)} pages exists")
sys.exit(bool(wrong))
