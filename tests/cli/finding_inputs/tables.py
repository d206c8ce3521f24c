"""Tables of text that raise the findings of their reading."""
import gzip

from .parts import Input, csv_text, gyro_lines, noise, text


def with_line(at, line):
    """The small table with this line in front of row `at`."""
    def content():
        lines = gyro_lines()
        lines.insert(at, line)
        return "\n".join(lines) + "\n"
    return content


def with_cell(at, cell, count=1):
    """The small table with this cell in `count` rows from `at` on, every 50th."""
    def content():
        lines = gyro_lines()
        for i in range(at, at + 50 * count, 50):
            lines[i] = lines[i].split(",")[0] + "," + cell
        return "\n".join(lines) + "\n"
    return content


def two_columns(name, cell):
    """A gyroscope beside a column of this name whose cell in row i is `cell(i)`."""
    def content():
        lines = gyro_lines()
        return "\n".join([lines[0] + "," + name] + [f"{line},{cell(i)}" for i, line in enumerate(lines[1:])]) + "\n"
    return content


def side_by_side():
    """Two loggers, each with its stamps."""
    values = noise(2000)
    return "t1[s],w[deg/s],t2[s],temp[degC]\n" + "".join(
        f"{i * 0.01:.2f},{v:.5f},{i * 0.025:.3f},{20 + 0.1 * (i % 3)}\n" for i, v in enumerate(values))


def slow():
    """A temperature at 1 Hz beside a gyroscope at 100 Hz."""
    temperature = iter(noise(100, 0.02, seed=2))
    return csv_text({"w[deg/s]": noise(10000),
                     "temp[degC]": [next(temperature) if i % 100 == 0 else None for i in range(10000)]})


def in_turn():
    """Two devices that are sampled one after the other, 2 of 10 s apart."""
    values = noise(1200)
    return "t[s],device,v[degC]\n" + "".join(
        f"{10 * i + 2 * k},{'AB'[k]},{values[2 * i + k]:.5f}\n" for i in range(600) for k in range(2))


def plain():
    return "\n".join(gyro_lines()) + "\n"


def late_key():
    """A key that is not in the first quarter of a MiB of objects."""
    rows = [f'{{"t": {i / 100}, "w [deg/s]": {v:.17g}}}' for i, v in enumerate(noise(8000))]
    return "\n".join(rows[:-1] + [rows[-1].replace("{", '{"battery": 3, ')]) + "\n"


INPUTS = {
    "late_key": Input(text("late.jsonl", late_key)),
    "bad_row": Input(text("bad_row.csv", with_line(500, "5.0,noise")), ("--bad-rows", "drop")),
    "blank_line": Input(text("blank.csv", with_line(500, ""))),
    "comment_line": Input(text("comment.csv", with_line(500, "# a pause"))),
    "footer_line": Input(text("footer.csv", with_line(len(gyro_lines()), "*** end of data ***"))),
    "repeated_header": Input(text("repeated.csv", with_line(500, "t[s],w[deg/s]")), ("--repeated-header", "skip")),
    "mixed_line_ends": Input(text("ends.csv", lambda: plain().replace("\n", "\r\n", 700))),
    "infinite_value": Input(text("infinite.csv", with_cell(500, "inf"))),
    "number_out_of_range": Input(text("range.csv", with_cell(500, "1e400")), ("--overflow", "nan")),
    "number_too_small": Input(text("small.csv", with_cell(500, "1e-400"))),
    "missing_cell": Input(text("cell.csv", with_cell(500, ""))),
    "missing_value": Input(text("value.csv", with_cell(500, "-999")), ("--missing=-999",)),
    "nul_tail": Input(text("nul.csv", lambda: plain() + "\0" * 40)),
    "compressed_cut": Input(text("cut.csv.gz", lambda: gzip.compress(plain().encode(), mtime=0)[:-300])),
    "carriage_return_line_ends": Input(text("cr.csv", lambda: plain().replace("\n", "\r"))),
    "no_final_newline": Input(text("end.csv", lambda: plain()[:-1])),
    "trailing_delimiter": Input(text("trailing.csv", lambda: plain().replace("\n", ",\n"))),
    "no_header": Input(text("header.csv", lambda: plain().split("\n", 1)[1])),
    "formula_name": Input(text("formula.csv", lambda: plain().replace("w[deg/s]", "=w", 1))),
    "control_in_name": Input(text("control.csv", lambda: plain().replace("w[deg/s]", "w\u202e", 1))),
    "doubled_name": Input(text("doubled.csv", two_columns("w[deg/s]", lambda i: f"{0.1 * (i * 37 % 101)}"))),
    "unnamed_column": Input(text("unnamed.csv", two_columns("", lambda i: f"{0.1 * (i * 37 % 101)}"))),
    "unused_option": Input(text("option.csv", plain), ("--unit", "gyro=deg/s")),
    "unknown_unit": Input(text("unit.csv", plain), ("--unit", "w=sverdrup")),
    "no_finite_value": Input(text("empty.csv", two_columns("v", lambda i: ""))),
    "slow_channel": Input(text("slow.csv", slow), analysis=("--temperature", "temp"),
                          not_in=dict.fromkeys(("allan", "psd"), "it reads the channel alone, and says own_grid")),
    "own_stamps": Input(text("side.csv", side_by_side), analysis=("--temperature", "temp"),
                        not_in=dict.fromkeys(("allan", "psd"), "it reads the channel by them, and says own_grid")),
    "own_grid": Input(text("own_grid.csv", slow), made_by="characterize"),
    "own_rows": Input(text("own_rows.csv", slow), ("-c", "temp")),
    "time_unit_guessed": Input(text("unit.csv", lambda: "time,w[deg/s]\n" + "".join(
        f"{10 * i},{v:.5f}\n" for i, v in enumerate(noise(2000))))),
    "stamps_apart": Input(text("turns.csv", in_turn), ("--group-by", "device")),
    "stated_rate": Input(text("stated.csv", lambda: "# sample rate: 200 Hz\n" + plain())),
}
