# %% [markdown]
# # A sensor from its recording to its fusion, in Python
#
# Run cell by cell in an editor that knows `# %%`, or whole: `python3 docs/examples/tour.py` from a folder that holds `fixtures`. It runs with
# the tests. Times are in s, frequencies in Hz, noise coefficients are roots of two-sided densities ([python.md](../python.md)).

# %%
import numpy as np

import libchar

log = libchar.read("fixtures/imu_at_rest.csv")
print(log.names, log.units, f"{len(log)} samples at {log.rate_hz:g} Hz")

# %% [markdown]
# ## How noisy is it?
# The samples are NumPy arrays, and go into every function as they are.

# %%
gyro, accelerometer = libchar.fit(log)
n = gyro.white_noise
print(f"{gyro.name}: N = {n.value:.5f} {n.unit}, between {n.ci95[0]:.5f} and {n.ci95[1]:.5f}; {n.status}")
print(f"{accelerometer.name}: K at most {accelerometer.random_walk.upper95:.1e} {accelerometer.random_walk.unit}")
assert 0.0038 < n.value < 0.0042 and accelerometer.random_walk.value is None

# %% [markdown]
# ## The curves behind it

# %%
curve = libchar.allan(log["gyro_z"], log.rate_hz, taus=[0.1, 1, 10, 100])
for tau, deviation, (low, high) in zip(curve.tau_s, curve.deviation, curve.ci95):
    print(f"{tau:6.1f} s   {deviation:.5f}   [{low:.5f}, {high:.5f}]")
spectrum = libchar.psd(log["gyro_z"], log.rate_hz, segment_s=20, scaling="lsd")
band = (spectrum.frequency_hz > 5) & (spectrum.frequency_hz < 20)
plateau = np.sqrt(np.mean(spectrum.value[band] ** 2))  # one-sided: √2 N
assert abs(plateau / (np.sqrt(2) * n.value) - 1) < 0.05

# %% [markdown]
# A notebook shows a curve as a picture. `plot` draws what `sensorchar plot` draws; `save` writes it as SVG, PDF or PNG.

# %%
figure = curve.plot(title="gyro_z")
assert "<svg" in figure.svg and "gyro_z" in figure.svg
figure

# %% [markdown]
# ## Everything at once, and a model to go on with

# %%
result = libchar.characterize(log)
print(result.verdict)
model = next(model for model in result.models() if model.channel == "gyro_z")
picture = result.plot(channel="gyro_z", width="two-columns")  # the curve with its band, the model and its terms
assert "<svg" in picture.svg
kalibr = result.export(to="kalibr", axis=["gyro_z=g", "accel_z=a"])
print(kalibr[:200])

# %% [markdown]
# ## Three such gyroscopes on a turntable, one of which fails: which algorithm would have coped?

# %%
array = libchar.simulate(model, duration_s=300, devices=3, truth="sine,amplitude=5,frequency_hz=0.05", faults=["gyro_z2:bias=0.5@200..260"])
replay = libchar.replay(array, sensors=["gyro*"], reference="truth", learning=(0, 100), algorithms=["mean", "median", "minque", "best-sensor"])
for algorithm in replay.algorithms:
    if algorithm.rmse is not None:
        print(f"{algorithm.name:12} RMSE {algorithm.rmse:.4f} deg/s")
assert replay["median"].rmse < replay["mean"].rmse
print(replay.verdict)
