"""Tables whose stamps raise the findings of the clock."""
import datetime
import random

from .parts import Input, noise, text


def stamped(instants, head="t[s]", form="{:.6f}"):
    """A table of a gyroscope with these stamps."""
    def content():
        times = instants()
        return "\n".join([head + ",w[deg/s]"] + [f"{form.format(t)},{w:.5f}" for t, w in zip(times,
                noise(len(times)))]) + "\n"
    return content


def even(n=4000, rate=100.0, start=0.0):
    return [start + i / rate for i in range(n)]


def changed(at, to):
    """Even stamps, with those of `at` replaced by what `to` makes of them."""
    def instants():
        times = even()
        for i in at:
            times[i] = to(times[i])
        return times
    return instants


def jittering():
    draw = random.Random(5)
    return [t + 0.002 * draw.gauss(0, 1) for t in even()]


def packets():
    times = even()
    return [times[min(len(times) - 1, i - i % 11 + 10)] - (10 - i % 11) * 0.007345 for i in range(len(times))]


def in_turns(steps):
    def instants():
        times, off = even(), 0.0
        for i in range(len(times)):
            times[i] += off / 100
            off += steps[i % len(steps)] - 1
        return times
    return instants


def doubled():
    """Two rows stand there twice."""
    times = even()
    for at in (3000, 2000):
        times.insert(at, times[at])
    return times


def two_rates():
    """A few rows at 60 Hz among those at 100 Hz."""
    times, now = [], 0.0
    for i in range(4000):
        times.append(now)
        now += 1 / 60 if 2000 <= i < 2040 else 0.01
    return times


def uneven():
    """The last twelfth of the rows comes at four fifths of the rate."""
    times, now = [], 0.0
    for i in range(12000):
        times.append(now)
        now += 0.01 if i < 11000 else 0.012
    return times


def calendar(first, rows, step_s, again=()):
    """Rows with local clock times; the hours in `again` begin an hour earlier."""
    def content():
        now = datetime.datetime.fromisoformat(first)
        lines = ["time,w[deg/s]"]
        for i, w in enumerate(noise(rows)):
            lines.append(f"{now.isoformat(sep=' ')},{w:.5f}")
            now += datetime.timedelta(seconds=step_s)
            if i in again:
                now -= datetime.timedelta(hours=1)
        return "\n".join(lines) + "\n"
    return content


INPUTS = {
    "backward_timestamp": Input(text("backward.csv", stamped(changed([2000], lambda t: t - 1.234)))),
    "duplicate_timestamp": Input(text("duplicate.csv", stamped(doubled))),
    "held_stamp": Input(text("held.csv", stamped(changed([2000, 3000], lambda t: t - 0.01)))),
    "gap": Input(text("gap.csv", stamped(changed(range(2000, 4000), lambda t: t + 3)))),
    "wild_stamp": Input(text("wild.csv", stamped(changed([2500], lambda t: 4294967.295)))),
    "late_stamp": Input(text("late.csv", stamped(changed([2000], lambda t: t + 0.5)))),
    "clock_rollover": Input(text("rollover.csv",
                                 stamped(lambda: [(t + 4294.967296 - 10) % 4294.967296 for t in even()]))),
    "clock_change": Input(text("change.csv", calendar("2025-10-26 02:10:00", 6000, 1, again=(2999,)))),
    "jitter": Input(text("jitter.csv", stamped(jittering))),
    "coarse_stamps": Input(text("coarse.csv", stamped(lambda: [round(t, 2) for t in even(rate=130.0)], form="{:.2f}"))),
    "packets": Input(text("packets.csv", stamped(packets))),
    "uneven_stamps": Input(text("turns.csv", stamped(in_turns([0.5612, 1.4388])))),
    "rate_change": Input(text("rates.csv", stamped(two_rates))),
    "uneven_sampling": Input(text("uneven.csv", stamped(uneven))),
    "rate_uncertain": Input(text("stated.csv", lambda: "w[deg/s]\n" + "".join(f"{w:.5f}\n" for w in noise(4000))),
                            ("--rate", "100±0.5Hz")),
    "rate_ignored": Input(text("ignored.csv", stamped(even)), ("--rate", "50")),
}
