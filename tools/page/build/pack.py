#!/usr/bin/env python3
"""The page of what was built: one file with everything inside.

usage: pack.py BUILD OUTPUT     BUILD: the folder of a build by tools/page/build/toolchain.cmake
"""
import gzip
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parent
ROOT = PAGE.parent.parent
SCRIPTS = ["elements", "words", "zip", "pool", "items", "remedies", "inspection", "options", "uses", "page"]
NOT_INSIDE = {"glog", "SuiteSparse", "HDF5", "OpenSSL", "oneTBB", "pybind11", "Cairo", "fontconfig"}


def said_by_program(build, *words):
    return subprocess.run(["node", "--no-experimental-fetch", str(HERE / "run.js"), str(build), *words], check=True,
                          capture_output=True, text=True).stdout


def licences():
    """Rows of docs/third-party.md of what is in the page."""
    rows = []
    for line in (ROOT / "docs/third-party.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        name = cells[0]
        if line.startswith("|") and len(cells) > 2 and cells[1].startswith("`lib") or name.startswith("JSON for"):
            if not any(name.startswith(other) for other in NOT_INSIDE):
                rows.append(f"{re.sub(r' [(]headers[)]', '', name)} ({cells[2]})")
    return ", ".join(rows)


def formats(usage):
    """The words of --format."""
    verb = next(verb for verb in usage["verbs"] if verb["name"] == "inspect")
    words = next(option["words"] for option in verb["options"] if "--format" in option["flags"])
    return "Formats: " + ", ".join(word for word in words if word != "auto") + ", packed ones too."


def filled(text, values):
    return re.sub(r"@([A-Z]+)@", lambda mark: values[mark[1]], text)


REPLACED = [0x00, 0x0D, 0x3C]  # what the text of a script may not have, or would change: NUL, CR, <


def seven_bits(data):
    """Bytes as text of 17 % more of them (base64: 33 %): 7 bits a character, U+0080 and on in place of REPLACED."""
    table = [chr(0x80 + REPLACED.index(code)) if code in REPLACED else chr(code) for code in range(128)]
    characters = []
    value = held = 0
    for byte in data:
        value = value << 8 | byte
        held += 8
        while held >= 7:
            held -= 7
            characters.append(table[value >> held])
            value &= (1 << held) - 1
    return "".join(characters) + (table[value << (7 - held)] if held else "")


def packed(data):
    """As gzip, by zopfli where it is installed: 4 % smaller, in a minute."""
    if shutil.which("zopfli"):
        with tempfile.NamedTemporaryFile() as file:
            file.write(data)
            file.flush()
            return subprocess.run(["zopfli", "-c", "--i5", file.name], check=True, capture_output=True).stdout
    return gzip.compress(data, 9, mtime=0)


def inside_script(text):
    """What an element of a script may hold."""
    return text.replace("</", "<\\/")


def main():
    build, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    script = "\n".join((PAGE / f"script/{name}.js").read_text().replace('"use strict";\n', "", 1) for name in SCRIPTS)
    worker = (build / "tools/sensorchar.js").read_text() + "\n" + (PAGE / "script/worker.js").read_text()
    usage = said_by_program(build, "--generate", "json")
    texts = {"usage": json.loads(usage), "targets": json.loads(said_by_program(build, "model", "--list", "--json")),
             "worker": worker}
    page = filled((PAGE / "page.html").read_text(), {
        "STYLE": (ROOT / "libchar/report/page.css").read_text() + (PAGE / "page.css").read_text(),
        "FORMATS": formats(json.loads(usage)),
        "LICENCES": licences(),
        "TEXTS": seven_bits(packed(json.dumps(texts).encode())),
        "SCRIPT": inside_script('"use strict";\n' + script),
        "MODULE": seven_bits(packed((build / "tools/sensorchar.wasm").read_bytes())),
    })
    output.write_bytes(page.encode())
    print(f"{output}: {output.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
