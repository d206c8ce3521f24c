#!/usr/bin/env python3
"""Makes the first inputs of the fuzz targets from the fixtures: seeds.py FOLDER [PROGRAM]

A folder a target in FOLDER, with the bytes before a file that its target takes for choices. Real files come
whole and cut, tables in every dialect, stamps at the ends of 64 bits. With PROGRAM (sensorchar) there are
reports and a fusion.yaml of its own making, shortened."""
import bz2
import json
import pathlib
import random
import sqlite3
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
KNOWN = ROOT / "fixtures" / "known" / "badinputs"
LARGEST = 4000
EXTREMES = [-2**63, -2**63 + 1, -2**62, -1, 0, 1, 2**53, 2**62, 2**63 - 1, 2**63, 10**18, 1700000000 * 10**9]
NUMBERS = ["0", "-0", "1e400", "-1e400", "1e-400", "5e-324", "2.2250738585072011e-308", "1.7976931348623157e308",
           "9007199254740993", "0.1",
           ".5", "5.", "1,5", "nan", "NA", "inf", "-Infinity", "12345678901234567890123", "0." + "0" * 40 + "1",
           "1_000", "0x10", "+1", "--1", "1e+",
           "0.500000000000000055511151231257827021181583404541015625", "2d", "1.5kHz", "64k", "10us"]


def cut(data, generator, pieces=3):
    """The data if it is short, and the beginnings of it: a file that was cut anywhere."""
    yield data[:LARGEST]
    for _ in range(pieces):
        yield data[:generator.randrange(1, max(2, min(len(data), LARGEST)))]


def tables():
    """One small table in every dialect."""
    rows = [[f"{0.01 * i:.2f}", f"{1.5 * i - 3:.3f}", str(i)] for i in range(12)]
    for delimiter in ",;\t |":
        for mark in ".,":
            if mark == delimiter:
                continue
            for end in ("\n", "\r\n", "\r"):
                for header in ("", delimiter.join(["t[s]", "gyro_x[deg/s]", '"a b"']) + end,
                               f"# made{end}t{delimiter}x{delimiter}y{end}"):
                    yield (header + end.join(delimiter.join(cell.replace(".", mark) for cell in row) for row in rows)
                           + end).encode()


def stamps():
    """Tables whose stamps are extreme, in every unit."""
    generator = random.Random(2)
    for unit in ("ns", "us", "ms", "s"):
        for _ in range(6):
            chosen = sorted(generator.sample(EXTREMES, 3)) + generator.sample(EXTREMES, 1)
            yield (f"t[{unit}],a\n" + "".join(f"{stamp},{i}\n" for i, stamp in enumerate(chosen))).encode()
    for step in (1, 2**61, 2**62):
        yield ("t[ns],a\n" + "".join(f"{-2**63 + i * step},{i}\n" for i in range(4))).encode()


TABLE_FORMATS = ["jsonl", "csv", "wav", "xlsx", "tables", "auto"]  # as in tables_fuzz.cpp


def printed_rows():
    """(format, text) of what becomes a table of text."""
    def rows(line):
        return "".join(line(k) for k in range(12))
    yield "jsonl", rows(lambda k: f'{{"t": {k / 100}, "imu": {{"gyro": [{k}, -{k}.5, null]}}, "s": "a\\u00e9"}}\n')
    yield "jsonl", "[" + rows(lambda k: f'{{"t":{k},"x":1e{k}}},\n') + "{}]"
    yield "csv", rows(lambda k: f'header: \n  seq: {k}\n  stamp: \n    secs: 15\n    nsecs: {k}0000000\n'
                                f'angular_velocity: \n  x: {k}.5\nframe: "imu"\nc: [{k}, 1.0]\n---\n')
    yield "csv", rows(lambda k: f"header:\n  stamp:\n    sec: 15\n    nanosec: {k}\nposition:\n- {k}.5\n- 2\n"
                                "s:\n- name: a\n  v: 1\n---\n")
    yield "csv", rows(lambda k: f"$VNGYR,+00.{k},-0.2,+3.5*5D\r\n")
    yield "csv", rows(lambda k: f"#RAWIMUSXA,COM1,0,0,FINE,2000,{k}.5;0,0,2000,{k}.5,00000077,1,2,3,4,5,6*0a0b0c0d\n")
    yield "csv", ("LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\t\n\t\nChannels\t1\n"
                  "Delta_X\t0.01\n***End_of_Header***\t\nX_Value\tA\tComment\n" + rows(lambda k: f"{k / 100}\t{k}\n"))
    special = "***Start_Special***\nX0\t7\n***End_Special***\n"
    for columns, names in (("Multi", "X_Value\tA\tX_Value\tB"), ("No", "X_Value\tA\tB")):
        each = "\t\t" if columns == "Multi" else "\t"
        yield "csv", (f"LabVIEW Measurement\nSeparator\tTab\nX_Columns\t{columns}\n***End_of_Header***\n\nChannels\t2\n"
                      f"X0\t0{each}0\nDelta_X\t.01{each}.02\n{special}***End_of_Header***\n{names}\n" +
                      rows(lambda k: (f"{k / 100}\t{k}\t{k / 50}\t{k}\n" if columns == "Multi" else f"\t{k}\t{k}\n")
                           + ("\n" if k == 6 else "")))
    yield "csv", rows(lambda k: f"2026-11-22 12:00:{k + 10}: $VNYPR,1,2,3*5D\n17.5 $VNGYR,+0.{k},-.2,+3.5,T00{k}*5D\n")
    yield "csv", rows(lambda k: f"%CORRIMUSA,2200,300000.{k};1,0.125,0.25,{k},-1,-2,-3,0,0*5aa97065\n")
    yield "csv", rows(lambda k: f"2021-12-19 05:00:{k + 14} PPS 1 4.417 0.067 1.094e-06 N 1 3.957e-07 -9.719e-12 "
                                "1.000e-09 8.640e-06 2.516e-05\n")
    yield "csv", rows(lambda k: f"61016 {8 * k}.878 0.000001853 -33.344 0.000003510 0.002074 3\n")
    yield "csv", rows(lambda k: f"10,000,000.000,{k:03},5 Hz\n")


def sounds():
    for kind, bits in ((1, 8), (1, 16), (1, 24), (3, 32)):
        form = struct.pack("<HHIIHH", kind, 2, 1000, 2000 * bits // 8, 2 * bits // 8, bits)
        chunk = lambda name, data: name + struct.pack("<I", len(data)) + data
        body = b"WAVE" + chunk(b"fmt ", form) + chunk(b"data", bytes(range(48)))
        yield chunk(b"RIFF", body)


def text_tables():
    """Inputs of tables_fuzz: JSON lines, printed messages, lines of units, sound, workbooks, archives."""
    def choice(name, bits=0):
        mask = 128 + 64
        return bytes([16, next(b for b in range(256) if TABLE_FORMATS[b % 6] == name and b & mask == bits)])
    for name, text in printed_rows():
        yield choice(name) + text.encode()
        yield choice("auto") + text.encode()
    for data in sounds():
        yield choice("wav") + data
    cells = "".join(f'<row r="{k}"><c r="A{k}" s="1"><v>{45000 + k / 86400}</v></c><c r="B{k}"><v>{k}</v></c></row>'
                    for k in range(2, 14))
    book = ['<workbook><sheets><sheet name="a" r:id="1"/></sheets></workbook>',
            '<Relationships><Relationship Id="1" Target="worksheets/sheet1.xml"/></Relationships>',
            '<styleSheet><cellXfs><xf numFmtId="0"/><xf numFmtId="22"/></cellXfs></styleSheet>',
            "<sst><si><t>time</t></si><si><t>x [V]</t></si></sst>",
            '<sheetData><row r="1"><c t="s"><v>0</v></c><c t="s"><v>1</v></c></row>' + cells + "</sheetData>"]
    yield choice("xlsx", 128) + "\0".join(book).encode()
    phone = "time,seconds_elapsed,z,y,x\n" + "".join(f"{10**18 + k * 10**7},{k / 100},{k},1,2.5\n" for k in range(12))
    for bits in (128, 128 + 64):
        yield choice("tables", bits) + (phone + "\0" + phone).encode()


def ros_files():
    """(target, bytes) of small logs of ROS messages: every way to pack a chunk, with and without an index."""
    text = lambda t: struct.pack("<I", len(t)) + t
    record = lambda op, content: bytes([op]) + struct.pack("<Q", len(content)) + content
    definition = b"float64 x\nint16[2] n\nstring s\nC[] cs\n" + b"=" * 80 + b"\nMSG: a/C\nfloat32 y\n"
    body = struct.pack("<d2h", 1.5, 2, -3)
    cdr = b"\0\1\0\0" + body + struct.pack("<I", 3) + b"ab\0\0" + struct.pack("<If", 1, 0.5)
    ros1 = body + text(b"ab") + struct.pack("<If", 1, 0.5)
    for encoding, data, schema in ((b"cdr", cdr, b"ros2msg"), (b"ros1", ros1, b"ros1msg"),
                                   (b"json", b'{"x": 1.5, "a": [1, 2], "stamp": {"sec": 3, "nsec": 4}}',
                                    b"jsonschema")):
        front = (record(3, struct.pack("<H", 1) + text(b"a/B") + text(schema) + text(definition)) +
                 record(4, struct.pack("<HH", 0, 1) + text(b"/t") + text(encoding) + struct.pack("<I", 0)))
        messages = b"".join(record(5, struct.pack("<HIQQ", 0, i, 10**18 + i * 10**7, 0) + data) for i in range(4))
        begin = b"\x89MCAP0\r\n" + record(1, text(b"ros2") + text(b""))
        chunks = [("", front + messages)]
        for program in ("lz4", "zstd"):
            try:
                chunks.append((program, subprocess.run([program, "-c", "-q"], input=front + messages,
                                                       capture_output=True, check=True).stdout))
            except (OSError, subprocess.CalledProcessError):
                pass  # not installed: one seed less
        for packed, content in [(None, front + messages)] + chunks:
            if packed is not None:
                content = record(6, struct.pack("<QQQI", 0, 0, len(front + messages), 0) + text(packed.encode())
                                 + struct.pack("<Q", len(content)) + content)
            content = begin + content
            place = struct.pack("<QQQQI", 0, 10, len(begin), 0, 0) + text(b"") + struct.pack("<QQ", 0, 0)
            statistics = struct.pack("<QHIIIIQQI", 4, 1, 1, 0, 0, 1, 10**18, 10**18 + 3 * 10**7,
                                     10) + struct.pack("<HQ", 0, 4)
            end = record(15, bytes(4))
            summary = front + (record(8, place) if packed is not None else b"") + record(11, statistics)
            yield "mcap", content
            yield "mcap", content + end + summary + record(2, struct.pack("<QQI", len(content) + len(end), 0,
                                                                          0)) + b"\x89MCAP0\r\n"
    fields = lambda *pairs: text(b"".join(text(name + b"=" + value) for name, value in pairs))
    connection = (fields((b"op", b"\7"), (b"conn", bytes(4)), (b"topic", b"/t")) +
                  fields((b"type", b"a/B"), (b"md5sum", b"*"), (b"message_definition", definition)))
    messages = b"".join(fields((b"op", b"\2"), (b"conn", bytes(4)), (b"time", struct.pack("<II", 10**9, i * 10**7)))
                        + text(ros1) for i in range(4))
    for compression, content in ((b"none", connection + messages), (b"bz2", bz2.compress(connection + messages))):
        chunk = fields((b"op", b"\5"), (b"compression", compression),
                       (b"size", struct.pack("<I", len(connection + messages)))) + text(content)
        header = lambda at: fields((b"op", b"\3"), (b"index_pos", struct.pack("<Q", at)),
                                   (b"conn_count", struct.pack("<I", 1)),
                                   (b"chunk_count", struct.pack("<I", 1))) + text(b" " * 8)
        begin = b"#ROSBAG V2.0\n" + header(0)
        info = fields((b"op", b"\6"), (b"ver", struct.pack("<I", 1)), (b"chunk_pos", struct.pack("<Q", len(begin))),
                      (b"start_time", bytes(8)),
                      (b"end_time", bytes(8)), (b"count", struct.pack("<I", 1))) + text(struct.pack("<II", 0, 4))
        yield "bag", begin + chunk
        yield "bag", b"#ROSBAG V2.0\n" + header(len(begin + chunk)) + chunk + connection + info
    with tempfile.TemporaryDirectory() as folder:
        for version in (3, 4):
            path = pathlib.Path(folder) / f"{version}.db3"
            base = sqlite3.connect(path)
            base.execute("PRAGMA page_size=512")
            base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
            base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
                         "BLOB)")
            base.execute("INSERT INTO topics VALUES (1, '/t', ?, 'cdr')",
                         ("std_msgs/msg/Float64" if version == 3 else "a/msg/B",))
            if version == 4:
                base.execute("CREATE TABLE message_definitions(topic_type TEXT, encoding TEXT, "
                             "encoded_message_definition TEXT)")
                base.execute("INSERT INTO message_definitions VALUES ('a/msg/B', 'ros2msg', ?)", (definition.decode(),))
            base.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)",
                             [(10**18 + i * 10**7, b"\0\1\0\0" + struct.pack("<d", i) if version == 3 else cdr)
                              for i in range(4)])
            base.commit()
            base.close()
            yield "db3", path.read_bytes()


def shortened(value):
    """A document with at most two of each list."""
    if isinstance(value, dict):
        return {key: shortened(one) for key, one in value.items()}
    return [shortened(one) for one in value[:2]] if isinstance(value, list) else value


def figure_parts(report):
    """A report with one part at a time beside what every report has: as a whole it is longer than an input may be."""
    common = {key: value for key, value in report.items() if not isinstance(value, (dict, list))}
    for key, value in report.items():
        if key not in common and key not in ("tool", "command", "input", "measured"):
            yield {**common, key: value}


def made_by(program):
    """(target, first byte, text) of reports and a fusion.yaml that the program writes."""
    with tempfile.TemporaryDirectory() as folder:
        run = lambda *words: subprocess.run([str(program), *map(str, words)], capture_output=True, cwd=folder,
                                            check=False)
        run("characterize", ROOT / "fixtures" / "imu_at_rest.csv", "-o", "log")
        run("replay", ROOT / "fixtures" / "scenes" / "rv-3.3-calibrated.yaml", "-o", "scene")
        for name, first in (("log/report.json", 0), ("scene/report.json", 1)):
            path = pathlib.Path(folder) / name
            if path.exists():
                document = json.loads(path.read_text())
                yield "report", first, json.dumps(shortened(document))
                for parts in figure_parts(document):
                    yield "figure", 0, json.dumps(shortened(parts), separators=(",", ":"))
        for path in pathlib.Path(folder).rglob("*.yaml"):
            yield ("fusion" if path.name == "fusion.yaml" else "model"), 0, path.read_text()[:LARGEST]
            yield "figure", 1, path.read_text()[:LARGEST]
        for verb in ("allan", "psd", "fit"):
            table = run(verb, ROOT / "fixtures" / "imu_at_rest.csv").stdout.decode(errors="replace")
            yield "figure", 2, table[:LARGEST]
            if verb == "allan":
                yield "curve", 1, table[:LARGEST]
            document = json.loads(run(verb, ROOT / "fixtures" / "imu_at_rest.csv", "--json").stdout)
            yield "figure", 0, json.dumps(shortened(document), separators=(",", ":"))
        table = pathlib.Path(folder) / "log" / "curves.csv"
        yield "figure", 2, table.read_text()[:LARGEST]


def stretch_content(state):
    """What stands in a partial state behind the settings and in front of the digest."""
    at = 20  # magic, version, length
    for _ in range(3):  # kind, identity, settings
        at += 8 + struct.unpack_from("<Q", state, at)[0]
    return state[at:-64]


def fleets_of(program):
    """(target, bytes) of what fleets read: manifests, and the plan, tasks, records and states of a small fleet."""
    generator = random.Random(4)
    devices = [("A1", "a.csv", "x", "b1", "21.5"), ("B 2", "b;2.npy", "", "", ""),
               ("Ä", "/logs/c.ulg", "y", "", "-3e1")]
    heads = ["device", "log", "type", "batch", "temperature_c"]
    for mark in ",;":
        for end in ("\n", "\r\n"):
            rows = [heads] + [[f'"{cell}"' if mark in cell else cell for cell in row] for row in devices]
            yield "manifest", b"\2" + end.join(mark.join(row) for row in rows).encode()
    tree = {"format": "fleet-manifest", "version": 1,
            "defaults": {"type": "x", "batch": "b", "limits": "l.yaml",
                         "options": {"reading": {"rate_hz": 200}, "fit": {"threshold": 6}}},
            "devices": [{key: cell for key, cell in zip(heads[:4], row) if cell} for row in devices]}
    tree["devices"][0] |= {"temperature_c": 21.5, "options": {"spectrum": {"segment": 64}}}
    text = json.dumps(tree, ensure_ascii=False).encode()
    yield "manifest", b"\1" + text
    yield "manifest", b"\0" + text  # JSON is YAML
    devices = b"devices:\n  - {device: A, log: a.npy}\n  - log: b.npy\n    batch: \"2\"\n"
    yield "manifest", b"\0format: fleet-manifest\nversion: 1\n" + devices
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run = lambda *words: subprocess.run([str(program), "fleet", *map(str, words)], capture_output=True,
                                            cwd=folder, check=True)
        (folder / "a.f64").write_bytes(b"".join(struct.pack("<d", generator.gauss(0, 1)) for _ in range(16 * 20)))
        channels = [{"name": f"a{k}", "unit": "deg/s"} for k in range(20)]
        (folder / "a.f64.json").write_text(json.dumps({"dtype": "f64", "endian": "little", "rate_hz": 100,
                                                       "channels": channels}))
        (folder / "b.csv").write_text("t[s],gx[deg/s]\n"
                                      + "".join(f"{k / 100},{generator.gauss(0, 1):.4f}\n" for k in range(400)))
        run("plan", "a.f64", "--split-above", "1KiB", "--segment", "8", "-c", "a0", "--no-reports", "-o", "f")
        run("plan", "b.csv", "--no-reports", "-o", "g")
        for fleet in ("f", "g"):
            run("run", fleet)
            for first in (b"\0", b"\1"):
                yield "plan", first + (folder / fleet / "plan.jsonl").read_bytes()
                for task in sorted((folder / fleet / "tasks").iterdir()):
                    yield "task", first + task.read_bytes()
        records = [path.read_bytes()[65:] for path in sorted(folder.rglob("device.record"))]
        for first in range(0, 32, 5):
            for text in [*records, b"\n".join(records), records[0].replace(b",", b", ")]:
                yield "record", bytes([first]) + text[:LARGEST]
        for path in folder.rglob("state.bin"):
            for length in (LARGEST, 3000, 1000, 300):
                yield "stretch", b"\0\0" + stretch_content(path.read_bytes())[:length]
    for choice in range(256):
        yield "stretch", bytes([choice, 1 + choice % 3]) + generator.randbytes(generator.choice([8, 16, 60]))


def seeds(program):
    """(target, bytes) of every seed."""
    generator = random.Random(1)
    files = lambda folder, *ends: [p for p in sorted(folder.rglob("*")) if p.suffix in ends]
    csv_files = files(KNOWN / "csv", ".csv") + [ROOT / "fixtures" / "imu_at_rest.csv"]
    for data in [p.read_bytes() for p in csv_files] + list(tables()) + list(stamps()):
        for piece in cut(data, generator, 1):
            yield "csv", bytes([generator.randrange(256), generator.randrange(256)]) + piece
            yield "curve", b"\1" + piece
            yield "figure", b"\2" + piece
    for path in files(KNOWN / "npy", ".npy") + files(ROOT / "fixtures" / "npy", ".npy"):
        for piece in cut(path.read_bytes(), generator):
            yield "npy", bytes([generator.randrange(256)]) + piece
    for target, *ends in (("npz", ".npz"), ("matlab", ".mat"), ("imu", ".imu"), ("hdf5", ".h5", ".mat")):
        for path in files(ROOT / "fixtures" / "arrays", *ends):
            for piece in cut(path.read_bytes(), generator):
                yield target, bytes([generator.randrange(16) * 16] * (2 if target == "imu" else 1)) + piece
                yield target, bytes([generator.randrange(256)] * (2 if target == "imu" else 1)) + piece
    for path in files(KNOWN / "raw", ".json"):
        data = path.with_suffix("")
        for piece in cut(data.read_bytes() if data.exists() else b"", generator):
            yield "raw", b"\1" + path.read_bytes()[:LARGEST // 2] + b"\0" + piece[:LARGEST // 2]
    for target, suffix in (("ulog", ".ulg"), ("dataflash", ".bin")):
        for path in files(ROOT / "fixtures" / "flight", suffix):
            data = path.read_bytes()
            for piece in cut(data, generator):
                yield target, bytes([generator.randrange(256)]) + piece
            # Definitions are long: the end of a log behind its beginning, as if what lies between had been lost.
            yield target, b"\3" + data[:LARGEST // 2] + data[-LARGEST // 2:]
    documents = files(ROOT / "fixtures", ".yaml") + files(KNOWN / "json", ".json") + files(KNOWN, ".yaml")
    for path in documents:
        first = b"\1" if path.suffix == ".json" else b"\0"
        for piece in cut(path.read_bytes(), generator):
            yield "document", first + piece
            for target in ("scene", "model", "limits", "fusion", "report"):
                yield target, first + piece
    yield "limits", (b"\0format: noise-limits\nversion: 1\nlimits:\n  - kind: angular_rate\n    white_noise: "
                     b"{value: 2, unit: deg/\xe2\x88\x9ah}\n"
                     b"  - channels: [accel_x]\n    white_noise: 1e-3\n    bias_instability: "
                     b"{value: 25, unit: m/s^2, reading: floor}\n")
    for text in NUMBERS + [str(e) for e in EXTREMES]:
        for choice in range(8):
            yield "number", bytes([choice]) + text.encode()
    for row in range(40):
        cells = "".join(
            f"{generator.choice(EXTREMES)},{generator.choice(NUMBERS)},{generator.random():.{row % 17}f}\n"
            for _ in range(5))
        yield "number", bytes([row]) + cells.encode()
    for choice in range(256):
        yield "formats", bytes([choice, generator.randrange(256)]) + generator.randbytes(400)
        yield "stamps", bytes([choice]) + bytes(generator.choice([0, 1, 2, 3, 128, 129, 130, 131, 132, 200, 230])
                                                for _ in range(80))
        yield "stream", bytes([choice, generator.randrange(256), generator.randrange(256)]) + generator.randbytes(600)
    for stamp in EXTREMES:
        extreme, far = struct.pack("<Q", stamp % 2**64), struct.pack("<Q", 2**62)
        yield "stamps", b"\7\x80" + extreme + bytes(range(40)) + b"\xff" + far + bytes(20)
    for target, data in ros_files():
        for piece in cut(data, generator):
            yield target, bytes([generator.randrange(256)]) + piece
    for data in text_tables():
        for piece in cut(data, generator, 2):
            yield "tables", piece
    for path in files(ROOT / "fixtures" / "ros", ".mcap", ".bag"):
        yield path.suffix[1:], b"\3" + path.read_bytes()[:LARGEST]
    if program:
        for target, first, text in made_by(program):
            for piece in cut(text.encode(), generator):
                yield target, bytes([first]) + piece
        yield from fleets_of(program)


def main():
    folder = pathlib.Path(sys.argv[1])
    counts = {}
    for target, data in seeds(sys.argv[2] if len(sys.argv) > 2 else None):
        (folder / target).mkdir(parents=True, exist_ok=True)
        counts[target] = counts.get(target, 0) + 1
        (folder / target / f"{counts[target]:04}").write_bytes(data)
    print("seeds:", ", ".join(f"{name} {count}" for name, count in sorted(counts.items())))


if __name__ == "__main__":
    main()
