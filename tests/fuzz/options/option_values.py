"""Values of options by what stands for them in the help: good ones, ends of ranges, and what a slip makes of them."""
NUMBERS = ["0", "-0", "1", "-1", "2.5", "100", "1e-3", "1e6", "1e78", "1e100", "1e308", "1e-308", "9223372036854775808",
           "nan", "inf", "x", " "]
COUNTS = ["0", "1", "2", "3", "8", "64", "1000", "2000", "100000000", "4294967296", "9223372036854775808",
          "18446744073709551615", "18446744073709551616", "-1", "1.5"]
TIMES = ["0", "-0", "0.01", "0.05", "0.15", "1", "5", "8s", "20", "19.99", "100ms", "1min", "1h", "1e11", "1e-9", "-1",
         "1e308", "5 s"]
RANGES = ["0..8", "1..", "..5", "5..1", "3..3", "0..0.05", "2..2.1", "100..200", "0..1e11", "-1..4", "..", "19.98.."]
NAMES = ["a", "b", "c0", "c1", "c9", "ref", "temp", "nope", "*", "a*", "a,b", "a,a", "b,a", "é", "\x1b[31mred", "＝1",
         "x" * 300, "a b", "../a", "-"]
FILES = ["x.csv", "arr.csv", "nope.csv", "rep", "rep/report.json", "rr", "mx/a.sensor.yaml", "limits.yaml", ".", "-",
         "bn/bench.json", "OUT2", "OUT2.csv", "fl/plan.jsonl", "fleet.csv", "/dev/null", "OUT2/deep/er"]
UNITS = ["deg/s", "rad/s", "m/s^2", "V", "degC", "1/16.4 deg/s", "furlong", "1", "deg/s,rad/s"]
FACTORS = ["2", "0", "-1", "1/16.4", "1e78", "1e-78", "1e100", "1e300", "x"]
FAULTS = ["a:bias=1@1..2", "a:noise=1e308@1..2", "a:stuck@1..", "nope:bias=1@1..2", "a:dropout@0..0.1",
    "b:drift=1@0..1",
          "a:scale=0@1..2", "a:noise=-1@1..2"]
SIGNALS = ["0", "100", "sine", "sine,amplitude=2,frequency_hz=0.1", "noise,standard_deviation=1", "ramp,slope=1e308",
           "constant,value=nan", "random_walk,step=1", "recording,file=x.csv,channel=a", "sine,amplitude=1e300"]
BY_NAME = {
    "N": COUNTS, "NUMBER": NUMBERS, "TIME": TIMES, "RATE": ["100", "0", "-1", "1e9", "1e-9", "1.5kHz", "1/300", "200Hz",
                                                            "1e308", "50"],
    "BYTES": ["0", "1", "1024", "4MiB", "1e18", "9223372036854775808", "2GB", "-1"],
    "N|TIME": COUNTS + TIMES + ["N/4"], "FROM..TO": RANGES, "LOW..HIGH": RANGES + ["0.1..20", "-1..1"],
    "auto|FROM..TO": RANGES + ["auto"], "NAME=FACTOR": [f"{n}={f}" for n in ("a", "*", "nope") for f in FACTORS],
    "NAME=UNIT": [f"{n}={u}" for n in ("a", "*", "nope") for u in UNITS], "UNIT,…": UNITS, "VALUE,…": NUMBERS,
    "COLUMN=VALUE": ["a=1", "nope=1", "a", "t[s]=0"], "COLUMN": NAMES, "CHAR": [",", ";", "tab", "|", "ab", "a"],
    "FAULT": FAULTS, "SIGNAL": SIGNALS, "SENSOR=FILE": ["a=mx/a.sensor.yaml", "a=mr/g.sensor.yaml",
    "a=ma/z.sensor.yaml",
                                                       "nope=mx/a.sensor.yaml", "a=", "a"],
    "SENSOR=CHANNEL,…": ["a=a", "a=b", "a=a,a=b", "a=b,b=a", "nope=a", "a=nope", "a"],
    "S|estimate": ["estimate", "0", "0.1", "-0.1", "1e308", "x"], "NUMBER|estimate": ["estimate", *NUMBERS],
    "TERMS[@WHERE]": ["all", "gain", "delay", "bias@rest", "all@learning", "all@0..1", "gain@run", "bias@0..0.02", "x"],
    "WINDOW[,STEP]": ["1", "1,0.5", "0", "10,0", "0.01", "100", "1,1e-9", "1e11"], "A,B": ["a,b", "a,a", "a",
    "a,nope", "a,b,c"],
    "LENGTH": ["85mm", "0mm", "1e308mm", "two-columns", "3in", "-1cm", "1e-300pt", "5"],
    "SETTING": ["mean.x=1", "exponential.alpha=0.5", "x", "minque.gamma=0.99", "minque.gamma=nan"],
    "SWEEP": ["minque.gamma=0.9,0.99", "minque.gamma=0..1", "x", "mean.x=1..2"], "DEVIATION": NUMBERS,
    "PERCENT": NUMBERS,
    "FORMAT": ["csv", "npy", "f64", "xml"], "CHANNEL=PLACE": ["a=gx", "a=g", "nope=gx", "a", "a=x"],
    "[LABEL:]METRIC+N%": ["rmse+5%", "white_noise+10%", "x", "rmse+-1%", "a:white_noise+1e308%"],
    "COMMAND": ["sensorchar", "/nope", "a b"], "PART,…": ["design", "x"], "TEXT": [*NAMES, "octave", "all", "N,B",
    "R", "0"],
    "NAME": NAMES, "NAME,…": NAMES,
}
GOOD = {"N": ["8", "64", "3"], "NUMBER": ["2.5", "1", "100"], "TIME": ["1", "5", "100ms"], "N|TIME": ["64", "1s",
    "N/4"],
        "RATE": ["100", "200Hz"], "BYTES": ["4MiB", "2GB"], "FROM..TO": ["0..8", "1..", "..5"],
        "auto|FROM..TO": ["auto", "1..5"], "LOW..HIGH": ["0.1..20", "1..5"], "NAME=FACTOR": ["a=2", "*=1/16.4"],
        "NAME=UNIT": ["a=V", "*=deg/s"], "UNIT,…": ["deg/s"], "VALUE,…": ["-999", "65535"], "NAME": ["a"],
        "NAME,…": ["a", "c0"],
        "SENSOR=FILE": ["a=mx/a.sensor.yaml", "a=mr/g.sensor.yaml"], "FAULT": FAULTS[:3], "SIGNAL": SIGNALS[:2],
        "CHAR": [","], "A,B": ["a,b"], "TERMS[@WHERE]": ["all", "gain", "gain@run"], "WINDOW[,STEP]": ["1", "5,1"],
        "LENGTH": ["85mm"], "PERCENT": ["10"], "DEVIATION": ["0.01"], "COLUMN=VALUE": ["a=1"], "PART,…": ["design"],
        "S|estimate": ["estimate", "0.1"], "NUMBER|estimate": ["estimate", "0.1"]}
SPECIAL = {"--taus": ["octave", "decade", "dense", "all", "ten", "0", "1e-9", "0.1,1", "1e11", "-1", "x", "1,,2",
    "1,1"],
           "--terms": ["N", "R", "N,B,K", "N,B,K,R,quantization", "B", "K", "quantization", "Q", "x", "N,N"],
           "--threshold": ["0", "5", "1e308", "-1", "1e-308"], "--algorithm": ["mean", "nope", "minque", "perceptron"],
           "--algorithms": ["mean", "mean,mean", "mean,minque", "nope", "inverse-variance"],
           "--slower": ["2.5", "1000", "0.5"],
           "--topic": ["nope", "/imu0"], "--parts": ["design", "design,design", "x"],
           "--sensors": ["a,b", "a", "a,a", "*", "nope", "ref"], "--reference": ["ref", "a", "nope"],
           "--color": ["always", "never", "auto", "x"], "--estimates": ["csv", "npy", "f64", "x"],
           "--batches": ["a,b", "a", "a,a"]}
WRITES = {"-o", "--output", "--models", "--csv", "--gnuplot", "--scene", "--write-scene", "--rerun"}
OUTPUTS = ["OUT2", "OUT2.csv", "OUT2.svg", "OUT", "OUT.csv", "rep", "x.csv", "rep/report.json", "fl/plan.jsonl", "-",
    "",
           "nope/deep/x.csv", "rr/fusion.yaml", "/dev/null", "mx", "OUT2/"]


def value_of(verb, option, generator):
    """A value for this option of the program's own description; None for a flag."""
    if not option["value"]:
        return None
    flag = option["flags"][-1]
    if generator.random() < 0.02:
        return ""
    if flag in WRITES and not (flag == "--models" and verb == "replay"):
        return generator.choice(OUTPUTS)
    if flag in SPECIAL:
        return generator.choice(SPECIAL[flag])
    if option["words"]:
        return "nope" if generator.random() < 0.05 else generator.choice(option["words"])
    if option["kind"] in ("file", "folder"):
        return generator.choice(FILES)
    slip = generator.random() < 0.4 or option["value"] not in GOOD
    return generator.choice(BY_NAME.get(option["value"], NAMES + NUMBERS) if slip else GOOD[option["value"]])
