"""One case of the Python module, printed: python_cases.py CASE. Without a case: their names. Run by
compare_builds.py."""
import inspect
import json
import sys
import warnings

IMU, MODEL, SCENE = "fixtures/imu_at_rest.csv", "report/gyro_z.sensor.yaml", "array.scene.yaml"


def shown(value):
    import numpy
    if isinstance(value, (list, tuple)):
        return [shown(item) for item in value]
    if isinstance(value, numpy.ndarray):
        return shown(value.tolist())
    if hasattr(value, "to_dict"):
        return shown(value.to_dict())
    if isinstance(value, dict):
        return {str(key): shown(item) for key, item in value.items()}
    if isinstance(value, float) and value != value:
        return None
    return value


def names(libchar):
    return {name: str(inspect.signature(getattr(libchar, name))) if inspect.isfunction(getattr(libchar, name)) else ""
            for name in sorted(libchar.__all__)}


def array(libchar):
    import numpy
    noise = numpy.random.default_rng(5).standard_normal((20000, 2))
    return [libchar.allan(noise, 100.0), libchar.psd(noise, 100.0, bins=20), libchar.fit(noise, 100.0)]


def wrong(libchar):
    try:
        libchar.read("no/such/file.csv")
    except libchar.Error as error:
        return [type(error).__name__, str(error), error.code, error.where, error.hint]


def page(libchar):
    return libchar.characterize(IMU).html()


CASES = {
    "names": names,
    "help": lambda libchar: {name: inspect.getdoc(getattr(libchar, name)) for name in libchar.__all__},
    "read": lambda libchar: libchar.read(IMU, channels=["gyro_z"], from_s=0, to_s=5).to_dict(),
    "allan": lambda libchar: libchar.allan(IMU, type="mdev"),
    "psd": lambda libchar: libchar.psd(IMU, bins=40),
    "fit": lambda libchar: libchar.fit(IMU),
    "characterize": lambda libchar: libchar.characterize(IMU),
    "models": lambda libchar: libchar.characterize(IMU).models(),
    "page": page,
    "simulate": lambda libchar: libchar.simulate(MODEL, duration_s=10, devices=2),
    "replay": lambda libchar: libchar.replay(SCENE, timing=False),
    "array": array,
    "wrong": wrong,
}

if __name__ == "__main__":
    if len(sys.argv) < 2:
        print("\n".join(CASES))
    else:
        import libchar as module
        warnings.simplefilter("ignore")
        print(json.dumps(shown(CASES[sys.argv[1]](module)), indent=1, sort_keys=True, ensure_ascii=False))
