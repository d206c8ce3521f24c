"""Flight logs that raise the findings of their reading, of the parts that fixtures/flight/make.py is made of."""
import importlib.util
import pathlib
import random
import struct

from .parts import Input, noise

FLIGHT = pathlib.Path(__file__).parents[3] / "fixtures/flight"
spec = importlib.util.spec_from_file_location("flight_logs", FLIGHT / "make.py")
make = importlib.util.module_from_spec(spec)
spec.loader.exec_module(make)
make.count = lambda i, axis: round(random.Random(1000 * i + axis).gauss(0, 200))  # noise, in place of a ramp

FIELDS = "uint64_t timestamp;uint64_t timestamp_sample;float x;float y;float z;uint64_t ticks;"


def row(i, w, stamp=None, ticks=None):
    stamp = 1_000_000 + 10_000 * i if stamp is None else stamp
    return make.data(0, struct.pack("<QQfffQ", stamp, stamp, w, -w, w * w, i if ticks is None else ticks))


def ulog(name, change=lambda rows: rows, flags=None, behind=b""):
    """A gyroscope of 2000 rows in a ULog; `change` makes other rows of them."""
    def write(folder):
        rows = change([row(i, w) for i, w in enumerate(noise(2000))])
        path = folder / f"{name}.ulg"
        path.write_bytes(make.header() + (flags or make.flags()) + make.about() + make.define("sensor_gyro", FIELDS) +
                         make.subscribe(0, "sensor_gyro") + b"".join(rows) + behind)
        return path
    return write


def put_in(at, piece):
    return lambda rows: rows[:at] + [piece] + rows[at:]


def too_many(folder):
    """A FIFO message that says 40 samples and holds 32."""
    log = make.header() + make.flags() + make.about() + make.define("sensor_gyro_fifo", make.FIFO) + make.subscribe(0,
            "sensor_gyro_fifo")
    for m in range(200):
        part = make.fifo(0, 8 * m, 8, 10_000_000 + 125 * (8 * m + 7), 125.0, 0.001)
        if m == 60:
            part = part[:-1] + bytes([40])
        log += part
    path = folder / "fifo.ulg"
    path.write_bytes(log)
    return path


def dataflash(name, fill):
    def write(folder):
        path = folder / f"{name}.bin"
        path.write_bytes(fill())
        return path
    return write


def gyr_log(rows=2000):
    log = make.Dataflash()
    log.units()
    log.define("GYR", 67, "QBQfff", "TimeUS,I,SampleUS,GyrX,GyrY,GyrZ")
    log.mean("GYR", "s#sEEE", "F-F000")
    for i, w in enumerate(noise(rows)):
        log.put("GYR", 1_000_100 + 2500 * i, 0, 1_000_000 + 2500 * i, w, -w, w * w)
    return log


def headless():
    """A block of the batch sampler in front of the first header."""
    log = make.Dataflash()
    log.define("ISBH", 80, "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
    log.define("ISBD", 81, "QHHaaa", "TimeUS,N,seqno,x,y,z")
    log.put("ISBD", 5_000, 7, 0, [0] * 32, [0] * 32, [0] * 32)
    return log.bytes + make.batch_log()[len(make.Dataflash().bytes):]


def many_topics():
    """More instances of messages than there is room for: 40 kinds of 256."""
    log = gyr_log()
    front = log.bytes
    for kind in range(40):
        log.bytes = b""
        log.define(f"C{kind:02d}", 140 + kind, "QBf", "TimeUS,I,V")
        log.mean(f"C{kind:02d}", "s#v", "F-0")
        for i in range(256):
            log.put(f"C{kind:02d}", 1_000_000 + 1000 * i, i, 3.7)
        front += log.bytes
    return front


def two_scales():
    """A letter that means hundredths, and a multiplier of thousandths."""
    log = make.Dataflash()
    log.units()
    log.define("BARO", 70, "QfcB", "TimeUS,Press,Temp,I")
    log.mean("BARO", "sPO#", "F0C-")
    for i, w in enumerate(noise(2000)):
        log.put("BARO", 1_000_000 + 10_000 * i, 101325 + w, int(2500 + 100 * w), 0)
    return log.bytes


INPUTS = {
    "appended_lost": Input(ulog("appended", flags=make.flags(1, (10**9, 0, 0)))),
    "cut_message": Input(ulog("cut", change=lambda rows: [*rows[:-1], rows[-1][:17]])),
    "damaged_bytes": Input(ulog("damaged", change=put_in(900, b"\xff" * 100))),
    "dropout": Input(ulog("dropout", change=put_in(900, make.message("O", struct.pack("<H", 20))))),
    "unknown_message": Input(ulog("unknown", change=put_in(900, make.data(9, bytes(20))))),
    "wrong_size": Input(ulog("size", change=put_in(900, make.data(0, bytes(20))))),
    "unusable_stamp": Input(ulog("stamp", change=put_in(900, row(0, 0, stamp=0)))),
    "too_many_samples": Input(too_many),
    "burst_without_header": Input(dataflash("headless", headless), ("--topic", "ISBD gyro 0")),
    "bursts": Input(dataflash("bursts", make.batch_log), ("--topic", "ISBD gyro 0")),
    "too_many_topics": Input(dataflash("topics", many_topics), ("--topic", "GYR 0")),
    "two_scales": Input(dataflash("scales", two_scales)),
}
