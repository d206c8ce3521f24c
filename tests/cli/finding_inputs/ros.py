"""Recordings of ROS that raise the findings of their reading; MCAP as its specification lays it out (mcap.dev/spec)."""
import pathlib
import sqlite3
import struct
import zlib

from .parts import Input, noise

ROS = pathlib.Path(__file__).parents[3] / "fixtures/ros"
MAGIC = b"\x89MCAP0\r\n"
GYRO = ("std_msgs/Header header\nfloat64 w\nfloat64[] more\nint64 ticks\n" + "=" * 80 +
        "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n")
START = 1_700_000_000


def word(value):
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(data)) + data


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def schema(name="bench_msgs/Gyro", number=1):
    return record(3, struct.pack("<H", number) + word(name) + word("ros1msg") + word(GYRO))


def channel(topic="/gyro", number=0):
    return record(4, struct.pack("<HH", number, 1) + word(topic) + word("ros1") + word(b""))


def body(i, value, more=(0.5, 0.25), ticks=None, stamp=None):
    seconds, part = divmod(i, 100)
    stamp = struct.pack("<II", START + seconds, part * 10_000_000) if stamp is None else stamp
    return (struct.pack("<I", i) + stamp + word("gyro") + struct.pack("<d", value) +
            struct.pack(f"<I{len(more)}d", len(more), *more) + struct.pack("<q", i if ticks is None else ticks))


def message(i, content):
    logged = START * 10**9 + i * 10**7 + 10**6
    return record(5, struct.pack("<HIQQ", 0, i, logged, logged) + content)


def chunk(records):
    return record(6, struct.pack("<QQQI", 0, 0, len(records), zlib.crc32(records)) + word("") +
                  struct.pack("<Q", len(records)) + records)


def summary(at, count, crc=True):
    """Schema, channel and statistics behind the data, and the footer; `count` messages are said to be there."""
    times = struct.pack("<QQ", START * 10**9, START * 10**9 + count * 10**7)
    records = schema() + channel() + record(11, struct.pack("<QHIIIII", count, 1, 1, 0, 0, 0, 0)[:26] + times +
                                            struct.pack("<IHQ", 10, 0, count))
    front = struct.pack("<BQQQ", 2, 20, at, 0)
    check = zlib.crc32(records + front)
    return records + front + struct.pack("<I", check if crc else check ^ 1) + MAGIC


def mcap(name, messages=None, front=schema() + channel(), count=None, data_crc=True, summary_crc=True, pieces=None):
    """A closed file of these messages (2000 of a gyroscope), or of these pieces of bytes."""
    def make(folder):
        rows = messages() if messages else [message(i, body(i, w)) for i, w in enumerate(noise(2000))]
        data = MAGIC + record(1, word("ros1") + word("bench")) + front + (pieces(rows) if pieces else b"".join(rows))
        data += record(15, struct.pack("<I", zlib.crc32(data) if data_crc else 1))
        path = folder / f"{name}.mcap"
        path.write_bytes(data + summary(len(data), count or len(rows), summary_crc))
        return path
    return make


def odd(at, content):
    """The messages with another content in row `at`."""
    return lambda: [message(i, content(i, w) if i == at else body(i, w)) for i, w in enumerate(noise(2000))]


def in_chunks(change):
    """The messages in chunks of 200, the third of which is changed."""
    def pieces(rows):
        chunks = [chunk(b"".join(rows[i:i + 200])) for i in range(0, len(rows), 200)]
        chunks[3] = change(chunks[3])
        return b"".join(chunks)
    return pieces


def flipped(data):
    return data[:-20] + bytes([data[-20] ^ 1]) + data[-19:]


def cut(folder):
    path = mcap("cut")(folder)
    data = path.read_bytes()
    path.write_bytes(data[:len(data) * 3 // 4])
    return path


def open_database(folder):
    """A recording beside which the journal of its database still stands."""
    path = folder / "open.db3"
    path.write_bytes((ROS / "humble.db3").read_bytes())
    base = sqlite3.connect(path)
    topic, = base.execute("SELECT id FROM topics WHERE name = '/level'").fetchone()
    base.execute("DELETE FROM messages")
    base.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                     [(topic, START * 10**9 + i * 10**7, struct.pack("<4sd", b"\0\1\0\0", w))
                      for i, w in enumerate(noise(2000))])
    base.commit()
    base.close()
    (folder / "open.db3-wal").write_bytes(b"not yet written")
    return path


def parts(folder):
    """A recording of two databases of ROS; the first has no definition of the topic's type."""
    path = folder / "parts"
    path.mkdir(exist_ok=True)
    names = ["humble.db3", "jazzy.db3"]
    for name in names:
        (path / name).write_bytes((ROS / name).read_bytes())
    (path / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths:\n" +
        "".join(f"    - {name}\n" for name in names) + "  compression_format: ''\n  compression_mode: ''\n")
    return path


def driver_without_stamps():
    return [message(i, body(i, w, stamp=bytes(8))) for i, w in enumerate(noise(2000))]


TOPIC = ("-c", "w")
INPUTS = {
    "array_length": Input(mcap("length", odd(700, lambda i, w: body(i, w, more=(1.0,))))),
    "broken_chunk": Input(mcap("chunk", pieces=in_chunks(flipped)), TOPIC),
    "broken_index": Input(mcap("index", summary_crc=False), TOPIC),
    "broken_message": Input(mcap("message", pieces=lambda rows: b"".join(rows[:50]) + record(5,
            b"short") + b"".join(rows[50:])), TOPIC),
    "checksum": Input(mcap("checksum", data_crc=False), TOPIC),
    "cut_end": Input(cut, TOPIC),
    "definition_changed": Input(mcap("definition", front=schema() + channel() + schema("bench_msgs/Other")), TOPIC),
    "lost_messages": Input(mcap("lost", count=2100), TOPIC),
    "open_recording": Input(open_database, ("--topic", "/level")),
    "unreadable_message": Input(mcap("unreadable", odd(700, lambda i, w: b"no message")), TOPIC),
    "unreadable_part": Input(parts, ("--topic", "/odd")),
    "zero_stamp": Input(mcap("zero", driver_without_stamps), TOPIC),
}
