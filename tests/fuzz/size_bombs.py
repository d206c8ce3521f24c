#!/usr/bin/env python3
"""Small files that declare much: size_bombs.py PROGRAM [--only WORD] [--seconds S] [--megabytes M] [--verbose]

Work and memory are bounded by the bytes that are there, not by the sizes that a file states. Each file of at most
10 MB, of every format, is read by inspect (documents by the verb that takes them), which has to end with an exit
code of docs/errors.md and at most one error within --seconds of processor time (2) and --megabytes of memory (256).
"""
import argparse
import io
import json
import lzma
import os
import pathlib
import re
import resource
import sqlite3
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

FIXTURES = pathlib.Path(__file__).resolve().parents[2] / "fixtures"
MILLION = 1_000_000
MOST_CHANNELS = 32_768  # that are read: kMostChannels in libchar/log/detail/row_source.hpp
ERROR = re.compile(r"(?:^|: )error E\d{4}:", re.M)


def csv_files():
    yield "million columns", b"c," * MILLION + b"\n" + b"1," * MILLION + b"\n"
    for columns in (MOST_CHANNELS, 100_000):
        yield f"{columns} columns", (",".join(f"c{k}" for k in range(columns)) + "\n"
                                     + ("1," * (columns - 1) + "1\n") * 20).encode()
    yield "colliding names", b"a," * (MOST_CHANNELS - 1) + b"a\n" + (b"1," * (MOST_CHANNELS - 1) + b"1\n") * 40
    yield "stamped columns", b"t[s]," + b"a," * 9000 + b"a\n" + b"".join(
        b"%d," % k + b"1," * 9000 + b"1\n" for k in range(500))
    yield "numbered names that collide", ((",".join(["a", "a_2", "a_3"] * 30_000) + "\n").encode()
                                          + b"1," * 89_999 + b"1\n")
    yield "names with units", (",".join(f"a{k} [m/s^2]" for k in range(MOST_CHANNELS)) + "\n"
                               + "1," * (MOST_CHANNELS - 1) + "1\n").encode()
    yield "names of strange units", (",".join(f"a{k} [{'m' * (k % 90)}/s^{k}]" for k in range(MOST_CHANNELS)) + "\n"
                                     + "1," * (MOST_CHANNELS - 1) + "1\n").encode()
    yield "empty cells of many columns", (b"x," + b"," * 9000 + b"1\n") * 1000
    yield "empty cells of two thousand columns", (b"," * 2000 + b"1\n") * 4500
    yield "quoted header of a million lines", b'"' + b"\n" * MILLION + b'",b\n1,2\n2,3\n'
    yield "quoted cells of many lines", b'a,b\n' + (b'"' + b"\n" * 1000 + b'",2\n') * 5000
    yield "one long name", b"a" * 9_000_000 + b",b\n1,2\n2,3\n"
    yield "columns like clocks", (",".join(f"utc{k}" for k in range(20_000)) + "\n"
                                  + (",".join(["120000"] * 20_000) + "\n") * 60).encode()
    yield "names of 100 kB", b",".join(b"a" * 100_000 for _ in range(90)) + b"\n" + b"1," * 89 + b"1\n"
    yield "nothing but line ends", b"\n" * 10_000_000
    yield "nothing but commas", b"," * 10_000_000
    yield "nothing but quotes", b'"' * 10_000_000
    yield "nothing but blanks", b" " * 10_000_000
    yield "nothing but comments", b"# x\n" * 2_500_000
    yield "nothing but digits", b"1" * 10_000_000
    yield "a line of every delimiter", b"1,2;3\t4|5 " * 900_000
    yield "carriage returns", b"t,a\r" + b"1,2\r" * 2_400_000
    yield "zeros", bytes(10_000_000)
    yield "stamps far apart", b"t[s],a\n0,1\n1e-9,2\n" + b"".join(b"%d,1\n" % (10**9 * k) for k in range(1, 200_000))
    yield "short rows", b"t,a\n" + b"1\n" * 4_900_000
    yield "long decimals", b"t,a\n" + b"".join(b"%d,0.%s\n" % (k, b"3" * 5000) for k in range(1900))
    yield "words in every cell", b"t,a\n" + b"x,y\n" * 2_400_000
    yield "dates", b"t,a\n" + b"2024-02-30T00:00:00Z,1\n" * 400_000
    yield "half a BOM of UTF-16", b"\xff\xfe" + b"1\x00,\x00" * 2_400_000


def npy(shape, kind="<f8", data=b""):
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}"
    head += " " * (-(len(head) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data


def array_files():
    yield "npy", "more than there is", npy("(1000000000000, 3)", data=bytes(800))
    yield "npy", "as many columns as values", npy("(1, 1000000)", data=bytes(8_000_000))
    yield "npy", "columns of bytes", npy("(1, 9000000)", "|i1", bytes(9_000_000))
    yield "npy", "no rows", npy("(0, 1000000000000)")
    yield "npy", "as many dimensions as fit", npy("(" + "1, " * 2000 + ")", data=bytes(8))
    for name, members in (("zeros", [("a", npy("(1000000000,)", data=b""), 9_000_000_000)]),
                          ("many members", [(f"m{k}", npy("(1,)", data=bytes(8)), 0) for k in range(50_000)]),
                          ("long names", [("n" * 60_000 + str(k), npy("(4,)", data=bytes(32)), 0) for k in range(70)]),
                          ("columns", [(f"m{k}", npy("(1, 100000)", "|i1", bytes(100_000)), 0) for k in range(90)])):
        yield "npz", name, archive(members)
    yield "f64", "a million channels", (bytes(8_000_000), '{"channels": 1000000, "rate_hz": 100}')
    yield "f64", "names of a million channels", (bytes(800), '{"channels": [%s], "rate_hz": 100}'
                                                 % ",".join(f'"c{k}"' for k in range(MILLION)))
    mat = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
    element = lambda kind, data: struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)
    matrix = lambda name, rows, columns, data: element(14, element(6, struct.pack("<II", 6, 0))
                                                       + element(5, struct.pack("<ii", rows, columns))
                                                       + element(1, name) + element(9, data))
    squeeze = zlib.compressobj(1)
    packed = squeeze.compress(struct.pack("<II", 14, 0xFFFFFFF0))
    packed += b"".join(squeeze.compress(bytes(10 * MILLION)) for _ in range(100)) + squeeze.flush()
    yield "mat", "zeros", mat + element(15, packed)
    yield "mat", "many variables", mat + matrix(b"a", 4, 1, bytes(32)) * 70_000
    yield "mat", "more than there is", mat + matrix(b"a", 2**31 - 1, 2**31 - 1, bytes(32))
    yield "mat", "a million columns", mat + matrix(b"a", 1, MILLION, bytes(8 * MILLION))
    nested = b""
    for _ in range(20_000):
        nested = struct.pack("<II", 14, len(nested)) + nested
    yield "mat", "cells in cells", mat + nested[:8_000_000]
    for fixture in ("log.h5", "groups.h5"):
        data = (FIXTURES / "arrays" / fixture).read_bytes()
        for factor in (3, 1000, 10**9):
            for size in sorted({struct.unpack_from("<Q", data, at)[0] for at in range(0, len(data) - 7, 8)}):
                if 100 <= size <= 100_000 and data.count(struct.pack("<Q", size)) <= 40:
                    yield "h5", f"{fixture}: {size} values times {factor}", data.replace(
                        struct.pack("<Q", size), struct.pack("<Q", min(size * factor, 2**62)))


def archive(members):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        for name, data, zeros in members:
            with file.open(name + ".npy", "w", force_zip64=True) as member:
                member.write(data)
                for _ in range(min(zeros, 1_000_000_000) // 10_000_000):
                    member.write(bytes(10_000_000))
    return out.getvalue()


def text(content):
    return struct.pack("<I", len(content)) + content


def record(kind, content):
    return bytes([kind]) + struct.pack("<Q", len(content)) + content


def topic(number, name, schema=b"float64 x\n"):
    return (record(3, struct.pack("<H", number) + text(b"a/B") + text(b"ros2msg") + text(schema))
            + record(4, struct.pack("<HH", number, number) + text(name) + text(b"cdr") + struct.pack("<I", 0)))


def mcap(body):
    return b"\x89MCAP0\r\n" + record(1, text(b"ros2") + text(b"")) + body


def message(number, data):
    return record(5, struct.pack("<HIQQ", number, 0, 10**18, 0) + data)


def topic_files():
    value = b"\0\1\0\0" + struct.pack("<d", 1.5)
    yield "mcap", "as many topics as numbers", mcap(b"".join(topic(k, b"/t%d" % k) for k in range(1, 65_536)))
    yield "mcap", "one topic said again", mcap(topic(1, b"/t") * 90_000)
    yield "mcap", "long names", mcap(b"".join(topic(k, b"/" + b"t" * 90_000) for k in range(1, 100)))
    yield "mcap", "deep message types", mcap(topic(1, b"/t", b"A0 a\n" + b"".join(
        b"=" * 80 + b"\nMSG: a/A%d\nA%d b\nA%d c\n" % (k, k + 1, k + 1) for k in range(60))) + message(1, value))
    yield "mcap", "arrays of arrays", mcap(topic(1, b"/t", b"A0[1000] a\n" + b"".join(
        b"=" * 80 + b"\nMSG: a/A%d\nA%d[1000] b\n" % (k, k + 1) for k in range(6))
        + b"=" * 80 + b"\nMSG: a/A6\nfloat64 x\n") + message(1, value))
    yield "mcap", "long sequences", mcap(topic(1, b"/t", b"float64[] x\n")
                                         + message(1, b"\0\1\0\0" + struct.pack("<I", 0xFFFFFFFF)) * 90_000)
    yield "mcap", "many fields", mcap(topic(1, b"/t", b"".join(b"float64 x%d\n" % k for k in range(300_000)))
                                      + message(1, value))
    chunk = record(6, struct.pack("<QQQI", 0, 0, 200 << 20, 0) + text(b"zstd") + struct.pack("<Q", 4) + b"abcd")
    index = record(8, struct.pack("<QQQQI", 0, 10, 30, len(chunk), 0) + struct.pack("<Q", 0) + text(b"zstd")
                   + struct.pack("<QQ", 4, 200 << 20))
    body = mcap(topic(1, b"/t") + chunk)
    yield "mcap", "an index of large chunks", body + record(15, bytes(4)) + index * 100_000 + record(
        2, struct.pack("<QQI", len(body) + 13, 0, 0)) + b"\x89MCAP0\r\n"
    yield "mcap", "many large chunks", mcap(topic(1, b"/t") + chunk * 90_000)
    fields = lambda *pairs: text(b"".join(text(name + b"=" + what) for name, what in pairs))
    connection = lambda k, name, definition: (
        fields((b"op", b"\7"), (b"conn", struct.pack("<I", k)), (b"topic", name))
        + fields((b"type", b"a/B"), (b"md5sum", b"*"), (b"message_definition", definition)))
    head = b"#ROSBAG V2.0\n" + fields((b"op", b"\3"), (b"index_pos", bytes(8)), (b"conn_count", bytes(4)),
                                      (b"chunk_count", bytes(4))) + text(b" " * 8)
    yield "bag", "many connections", head + b"".join(connection(k, b"/t%d" % k, b"float64 x") for k in range(70_000))
    yield "bag", "large chunk", head + fields((b"op", b"\5"), (b"compression", b"bz2"), (b"size", struct.pack(
        "<I", 0xFFFFFFFF))) + text(b"BZh9")
    yield "bag", "many empty chunks", head + (fields((b"op", b"\5"), (b"compression", b"none"), (b"size", bytes(4)))
                                              + text(b"")) * 120_000
    with tempfile.TemporaryDirectory() as folder:
        for name, topics, messages in (("many topics", 100_000, 4), ("many messages", 1, 100_000)):
            path = pathlib.Path(folder) / f"{topics}.db3"
            base = sqlite3.connect(path)
            base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
            base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
                         "data BLOB)")
            base.executemany("INSERT INTO topics VALUES (?, ?, 'std_msgs/msg/Float64', 'cdr')",
                             ((k, f"/t{k}") for k in range(1, topics + 1)))
            base.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)",
                             ((10**18 + k * 10**7, value) for k in range(messages)))
            base.commit()
            base.close()
            yield "db3", name, path.read_bytes()


def flight_files():
    begin = b"ULog\x01\x12\x35\x01" + bytes(8)
    said = lambda kind, content: struct.pack("<HB", len(content), ord(kind)) + content
    yield "ulg", "many formats", begin + b"".join(said("F", b"f%d:uint64_t timestamp;float x;" % k)
                                                 for k in range(200_000))
    fields_of = lambda k: b"".join(b"f%d[200] a%d;" % (k + 1, i) for i in range(20))
    yield "ulg", "formats in formats", begin + b"".join(said("F", b"f%d:%s" % (k, fields_of(k))) for k in range(40)) + (
        said("F", b"f40:uint64_t timestamp;") + said("A", bytes([0]) + struct.pack("<H", 0) + b"f0"))
    yield "ulg", "large arrays", begin + said("F", b"f:uint64_t timestamp;float[2000000000] x;") + said(
        "A", bytes([0]) + struct.pack("<H", 0) + b"f") + said("D", struct.pack("<H", 0) + bytes(60_000)) * 150
    yield "ulg", "many subscriptions", begin + said("F", b"f:uint64_t timestamp;float x;") + b"".join(
        said("A", bytes([k % 256]) + struct.pack("<H", k % 65536) + b"f") for k in range(500_000))
    yield "ulg", "parameters", begin + said("P", b"\x07float a" + bytes(4)) * 650_000
    yield "ulg", "nothing after the head", begin + bytes(9_000_000)
    form = lambda kind, name: (b"\xa3\x95\x80" + bytes([kind, 89]) + name.ljust(4, b"\0") + b"Q".ljust(16, b"\0")
                               + b"TimeUS".ljust(64, b"\0"))
    yield "bin", "formats again and again", form(128, b"FMT") + form(200, b"A") * 100_000
    yield "bin", "heads of messages only", form(200, b"A") + b"\xa3\x95\xc8" * 3_000_000


def packed_files():
    yield "csv.gz", "zeros", packed(lambda write: [write(bytes(MILLION)) for _ in range(300)])
    yield "csv.gz", "rows again and again", packed(
        lambda write: [write(b"a,b\n")] + [write(b"1,2\n" * 250_000) for _ in range(300)])
    yield "csv.gz", "one long line", packed(lambda write: [write(b"1," * 500_000) for _ in range(300)])
    yield "csv.gz", "empty members", zlib_gzip(b"") * 400_000
    yield "csv.gz", "a head of a long name", b"\x1f\x8b\x08\x08" + bytes(6) + b"n" * 9_000_000
    yield "csv.xz", "zeros", lzma.compress(bytes(60 * MILLION), preset=0)
    yield "csv.xz", "rows again and again", lzma.compress(b"a,b\n" + b"1,2\n" * 25 * MILLION, preset=0)
    yield "csv.xz", "a dictionary of 4 GB", b"\xfd7zXZ\0\0\1\x69\x22\xde\x36\2\0\x21\1\x28\0\0\0" + bytes(100)
    yield "csv.xz", "empty streams", lzma.compress(b"") * 300_000
    block = lambda size, kind, last, data: struct.pack("<I", size << 3 | kind << 1 | last)[:3] + data
    head = lambda window: b"\x28\xb5\x2f\xfd\0" + bytes([window])
    yield "csv.zst", "zeros", head(0x58) + block(131_072, 1, 0, b"\0") * 2_400_000
    yield "csv.zst", "rows of one digit", (head(0x58) + block(8, 0, 0, b"a,b\n1,2\n")
                                           + block(131_072, 1, 0, b"1") * 2_400_000)
    yield "csv.zst", "line ends", head(0x58) + block(131_072, 1, 0, b"\n") * 2_400_000
    yield "csv.zst", "a window of a terabyte", head(0xF8) + block(8, 0, 1, b"t,a\n1,2\n")
    yield "csv.zst", "a window of 2 GB", head(0xA8) + block(131_072, 1, 0, b"1") * 2_400_000
    yield "csv.zst", "frames to skip", struct.pack("<II", 0x184D2A50, 0) * 1_200_000
    yield "csv.zst", "empty frames", (head(0x00) + block(0, 0, 1, b"")) * 1_000_000


def packed(fill):
    squeeze, out = zlib.compressobj(9, wbits=31), []
    fill(lambda data: out.append(squeeze.compress(data)))
    return b"".join(out) + squeeze.flush()


def zlib_gzip(data):
    return packed(lambda write: write(data))


def zipped(members, method=zipfile.ZIP_DEFLATED):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method, compresslevel=9) as file:
        for name, pieces in members:
            with file.open(name, "w", force_zip64=True) as member:
                for piece, times in pieces:
                    for _ in range(times):
                        member.write(piece)
    return out.getvalue()


SHEET = b'<?xml version="1.0"?><worksheet><sheetData>'
BOOK = ("xl/workbook.xml", [(b'<workbook xmlns:r="r"><sheets><sheet name="a" sheetId="1" r:id="rId1"/></sheets>'
                             b'</workbook>', 1)])
LINKS = ("xl/_rels/workbook.xml.rels", [(b'<Relationships><Relationship Id="rId1" Type="x/worksheet" '
                                         b'Target="worksheets/sheet1.xml"/></Relationships>', 1)])


def workbook(sheet, *more):
    return zipped([BOOK, LINKS, ("xl/worksheets/sheet1.xml", [(SHEET, 1), *sheet]), *more])


def table_files():
    row = b'<row r="1"><c r="A1"><v>1</v></c></row>'
    shared = b'<row r="1"><c r="A1" t="s"><v>4000000000</v></c></row>'
    yield "xlsx", "rows again and again", workbook([(row * 25_000, 100)])
    yield "xlsx", "a column far out", workbook([(b'<row r="1"><c r="XFD1"><v>1</v></c></row>' * 25_000, 80)])
    yield "xlsx", "columns of many letters", workbook([
        (b'<row r="1"><c r="' + b"Z" * 60_000 + b'1"><v>1</v></c></row>', 1000)])
    wide = b"".join(b"<c><v>%d</v></c>" % k for k in range(16_384)) + b"</row>"
    yield "xlsx", "as many columns as there are", workbook([(b'<row r="%d">' % r + wide, 1) for r in range(1, 22)])
    yield "xlsx", "rows far down", workbook([(b'<row r="1"><c r="A1"><v>1</v></c></row><row r="999999999999">'
                                              b'<c r="A999999999999"><v>1</v></c></row>', 1)])
    yield "xlsx", "tags in tags", workbook([(b"<a>" * 250_000, 100)])
    yield "xlsx", "one long text", workbook([
        (b'<row r="1"><c r="A1" t="inlineStr"><is><t>', 1), (b"x" * MILLION, 200)])
    yield "xlsx", "attributes", workbook([(b"<row ", 1), (b'a="b" ' * 200_000, 100)])
    yield "xlsx", "shared texts", workbook([(shared, 1)], ("xl/sharedStrings.xml", [
        (b"<sst>", 1), (b"<si><t>a</t></si>" * 50_000, 200)]))
    yield "xlsx", "long shared texts", workbook([(b'<row r="1">', 1), (b'<c t="s"><v>0</v></c>' * 1000, 100)], (
        "xl/sharedStrings.xml", [(b"<sst><si><t>", 1), (b"y" * 60_000, 1), (b"</t></si></sst>", 1)]))
    yield "xlsx", "styles", workbook([(row, 1)], ("xl/styles.xml", [
        (b"<styleSheet><cellXfs>", 1), (b'<xf numFmtId="14"/>' * 50_000, 200)]))
    yield "xlsx", "sheets", zipped([("xl/workbook.xml", [(b"<workbook><sheets>", 1), (
        b'<sheet name="a" sheetId="1" r:id="rId1"/>' * 25_000, 150)]), LINKS])
    yield "xlsx", "entities", workbook([(b'<!DOCTYPE a [<!ENTITY b "cccccccccc">]><row r="1"><c r="A1"><v>', 1),
                                        (b"&b;" * 300_000, 50)])
    yield "zip", "rows again and again", zipped([("a.csv", [(b"a,b\n", 1), (b"1,2\n" * 250_000, 300)])])
    yield "zip", "many tables", zipped([(f"{k}.csv", [(b"t,a\n1,2\n2,3\n", 1)]) for k in range(60_000)])
    yield "zip", "many wide tables", zipped([
        (f"{k}.csv", [(b"a,", 50_000), (b"b\n", 1), (b"1,", 50_000), (b"1\n", 1)]) for k in range(20)])
    yield "zip", "folders in folders", zipped([("a/" * 30_000 + f"{k}.csv", [(b"t,a\n1,2\n", 1)]) for k in range(70)])
    yield "zip", "zeros", zipped([(f"{k}.csv", [(bytes(MILLION), 40)]) for k in range(40)])
    riff = lambda channels, bits, size, data: (b"RIFF" + struct.pack("<I", 0xFFFFFFFF) + b"WAVEfmt " + struct.pack(
        "<IHHIIHH", 16, 1, channels, 48_000, 0xFFFFFFFF, channels * bits // 8 & 0xFFFF, bits) + b"data" + struct.pack(
            "<I", size) + data)
    yield "wav", "more than there is", riff(2, 16, 0xFFFFFFF0, bytes(9_000_000))
    yield "wav", "as many channels as fit", riff(65_535, 8, 9_000_000, bytes(9_000_000))
    yield "wav", "as many channels as are read", riff(MOST_CHANNELS, 8, 9_000_000, bytes(9_000_000))
    yield "wav", "wide channels", riff(8191, 64, 9_000_000, bytes(9_000_000))
    yield "wav", "empty chunks", b"RIFF" + struct.pack("<I", 0) + b"WAVE" + b"junk\0\0\0\0" * 1_200_000
    four = lambda kind, rows, columns, name, data: struct.pack("<IIIII", kind, rows, columns, 0,
                                                               len(name) + 1) + name + b"\0" + data
    yield "mat", "version 4, more than there is", four(0, 2**31 - 1, 2**31 - 1, b"a", bytes(80))
    yield "mat", "version 4, many variables", four(0, 1, 1, b"a", bytes(8)) * 290_000
    yield "mat", "version 4, empty variables", four(0, 0, 2**31 - 1, b"a", b"") * 400_000
    yield "mat", "version 4, bytes as columns", four(50, 1, 9_000_000, b"a", bytes(9_000_000))
    yield "mat", "version 4, a long name", struct.pack("<IIIII", 0, 1, 1, 0, 2**31 - 1) + b"n" * 9_000_000
    for keys in (50_000, 90_000):
        yield "jsonl", f"{keys} keys", (b"{" + b",".join(b'"k%d":1' % k for k in range(keys)) + b"}\n") * 9
    yield "jsonl", "other keys in every line", b"".join(b'{"t":%d,"k%d":1}\n' % (k, k) for k in range(400_000))
    yield "jsonl", "deep", b'{"a":' * 1_900_000
    yield "jsonl", "arrays", b'{"a":[' + b"1," * 4_900_000
    yield "jsonl", "deep lines", (b'{"a":' * 60 + b"1" + b"}" * 60 + b"\n") * 23_000
    yield "jsonl", "one long key", b'{"' + b"k" * 9_000_000 + b'":1}\n'
    yield "jsonl", "escapes", b'{"a":"' + b"\\u0041" * 1_600_000 + b'"}\n'
    yield "jsonl", "numbers of many digits", (b'{"a":' + b"9" * 100_000 + b"}\n") * 90
    yield "txt", "sentences of other kinds", b"".join(
        b"$GP%c%c%c,1,2*00\n" % (65 + k % 26, 65 + k // 26 % 26, 65 + k // 676 % 26) for k in range(600_000))
    yield "txt", "echoed keys", b"".join(b"k%d: 1\n---\n" % k for k in range(600_000))
    yield "txt", "echoed depth", b"".join(b" " * k + b"k:\n" for k in range(4000))
    yield "csv", "groups", b"t,name,x\n" + b"".join(b"%d,n%d,1\n" % (k, k) for k in range(600_000))
    yield "lvm", "segments", b"LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\n" * 150_000
    yield "lvm", "channels", (b"LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\nChannels\t999999999\n"
                              b"***End_of_Header***\n" + b"1\t" * 3_000_000)
    yield "imu", "zeros", bytes(10_000_000)


def document_files():
    head = "format: sensor-model\nversion: 1\nchannel: a\nunit: V\ndensity: two-sided\nrate_hz: 100\n"
    yield "sensor.yaml", "many keys", ["model"], (head + "".join(f"k{k}: 1\n" for k in range(500_000))).encode()
    for piece in ("[", "{", "[a,", "{a: ", "[[],[],", "- ", "? ", "k: "):
        yield "sensor.yaml", f"{piece} again and again", ["model"], (
            head + "white_noise: " + piece * (9_000_000 // len(piece))).encode()
    yield "sensor.yaml", "long text", ["model"], (head + "note: " + "x" * 9_000_000).encode()
    yield "sensor.yaml", "a list of millions", ["model"], (head + "l: [" + "1," * 4_900_000 + "1]").encode()
    yield "sensor.yaml", "many lines of nothing", ["model"], (head + "\n" * 9_000_000).encode()
    model = "model: {unit: m, white_noise: {value: 1}, density: two-sided}"
    scene = ("format: scene\nversion: 1\nname: s\nsimulate: {{rate_hz: 100, samples: {}, truth: {{name: l, kind: sine, "
             "amplitude: 1, frequency_hz: 1}}}}\nsensors:\n{}")
    sensors = "".join(f"  - {{name: s{k}, {model}}}\n" for k in range(20_000))
    yield "scene.yaml", "twenty thousand sensors", ["replay", "--explain"], scene.format(600, sensors).encode()
    yield "scene.yaml", "more samples than there is time", ["replay", "--explain"], scene.format(
        2**62, "".join(f"  - {{name: s{k}, {model}}}\n" for k in range(3))).encode()
    for name, content in (("deep", b"[" * 9_000_000), ("many keys", b"{" + b",".join(
            b'"k%d":1' % k for k in range(700_000)) + b"}"), ("many files", b'{"format":"characterization","files":['
                                                              + b'"a",' * 2_000_000 + b'"b"]}')):
        yield "json", name, ["report"], content
    yield "json", "millions of empty channels", ["report", "--form"], (
        b'{"format":"characterization","version":1,"tool":{},"allan":{"channels":[' + b"{}," * 3_000_000 + b"{}]}}")
    said = b'{"tool":{},"files":[],"a":[%s]}'
    for name, piece in (("objects", b'{},'), ("arrays", b"[],"), ("numbers", b"1,"), ("keys", b'{"a":1},')):
        yield "json", f"results of {name}", ["verify"], said % (piece * (9_000_000 // len(piece)) + b"1")


def all_files():
    for name, data in csv_files():
        yield "csv", name, ["inspect"], data
    for suffix, name, data in (*array_files(), *topic_files(), *flight_files(), *packed_files(), *table_files()):
        yield suffix, name, ["inspect"], data
    yield from document_files()


def serve():
    """Runs what it is told, line by line: a process of its own, since a child begins with its parent's memory."""
    for line in sys.stdin:
        words = json.loads(line)
        with tempfile.TemporaryFile() as said:
            child = os.fork()
            if child == 0:
                resource.setrlimit(resource.RLIMIT_CPU, (30, 31))
                null = os.open(os.devnull, os.O_RDWR)
                for descriptor, target in ((0, null), (1, null), (2, said.fileno())):
                    os.dup2(target, descriptor)
                os.execv(words[0], words)
            _, status, used = os.wait4(child, 0)
            said.seek(0)
            print(json.dumps([os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024,
                              said.read().decode(errors="replace")]), flush=True)


class Runner:
    def __init__(self, program, folder):
        self.program = program
        self.server = subprocess.Popen([sys.executable, __file__, "--serve"], stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, text=True, cwd=folder)

    def measured(self, words):
        """Exit code, seconds of processor time, megabytes, what was said."""
        print(json.dumps([self.program, *words]), file=self.server.stdin, flush=True)
        return json.loads(self.server.stdout.readline())


class Tally:
    """What was run, and what of it was beyond the limits."""

    def __init__(self, options):
        self.options, self.count, self.wrong = options, 0, 0
        self.slowest = self.largest = (0, "")

    def add(self, name, size, done):
        code, seconds, megabytes, said = done
        options = self.options
        self.count += 1
        self.slowest, self.largest = max(self.slowest, (seconds, name)), max(self.largest, (megabytes, name))
        faults = [fault for fault, there in (
            (f"exit {code}", code not in (0, 2, 3, 4, 5)), (f"{seconds:.1f} s", seconds > options.seconds),
            (f"{megabytes:.0f} MB", megabytes > options.megabytes), ("internal error", "internal error" in said),
            ("no error said", code > 0 and len(ERROR.findall(said)) != 1)) if there]
        self.wrong += bool(faults)
        if faults or options.verbose:
            print(f"{name} ({size / 1e6:.1f} MB): {', '.join(faults) or 'well'}: exit {code}, "
                  f"{seconds:.2f} s, {megabytes:.0f} MB, {said.strip()[-160:]!r}", flush=True)

    def end(self):
        options = self.options
        print(f"{self.count} files, {self.wrong} beyond {options.seconds:g} s, {options.megabytes:g} MB or the "
              f"contract; slowest {self.slowest[0]:.1f} s ({self.slowest[1]}), largest {self.largest[0]:.0f} MB "
              f"({self.largest[1]})")
        return 1 if self.wrong else 0


def arguments(description):
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--only", default="")
    parser.add_argument("--seconds", type=float, default=2)
    parser.add_argument("--megabytes", type=float, default=256)
    parser.add_argument("--verbose", action="store_true")
    return parser


def main():
    options = arguments(__doc__).parse_args()
    tally = Tally(options)
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(options.program, folder)
        for suffix, name, words, data in all_files():
            if options.only not in f"{suffix}: {name}":
                continue
            path = pathlib.Path(folder) / f"bomb.{suffix}"
            data, sidecar = data if isinstance(data, tuple) else (data, None)
            assert len(data) <= 10_500_000, (suffix, name, len(data))
            path.write_bytes(data)
            side = pathlib.Path(f"{path}.json")
            if sidecar is not None:
                side.write_text(sidecar)
            tally.add(f"{suffix}: {name}", len(data), runner.measured([words[0], str(path), *words[1:]]))
            side.unlink(missing_ok=True)
            path.unlink()
    sys.exit(tally.end())


if __name__ == "__main__":
    serve() if sys.argv[1:] == ["--serve"] else main()
