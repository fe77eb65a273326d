# %% [markdown]
# What does the simulator leave out? A machine pulls a sled by a spring; the "recording" hides 30 % more friction at rest.

# %%
import json, pathlib
import matplotlib.pyplot as plt
import numpy as np
import supercircle as sc

folder, rng = pathlib.Path("sled"), np.random.default_rng(1)
folder.mkdir(exist_ok=True)
speeds = {"slow": 5e-4, "fast": 2e-3, "again": 5e-4}  # m/s, over 4 mm after a rest of 1 s


def write(run, time, travel, force):
    np.savetxt(folder / f"{run}.csv", np.c_[time, 1e3 * travel, force], "%.6g", ",", header="time_s,displacement_mm,force_N", comments="")


# %% The description states what is known and how well. The first files have no force yet; a replay with the effect makes it.
runs = [{"file": f"{k}.csv", "drive_time_s": [0, 1, 1 + 4e-3 / v], "drive_displacement_mm": [0, 0, 4]} for k, v in speeds.items()]
known = {"mu": {"value": 0.32, "unc": 0.04}, "stiffness": {"value": 480, "unc": 40}, "mass": 0.2, "normal_force": 1.96}
(folder / "experiment.json").write_text(json.dumps({
    "schema": "rod-recordings/1", "protocol": "scene", "scene": "sled", "scene_parameters": known, "runs": runs,
    "channels": [{"observe": "force", "column": "force_N", "noise_std": 0.005}]}))
for k, v in speeds.items():
    t = np.linspace(0, 1 + 4e-3 / v, 150)
    write(k, t, np.clip(v * (t - 1), 0, None), t)
for c in sc.replay(folder, parameters={"mu": 0.3, "stiffness": 500}, effects=["static_friction_excess:mu_s_over_mu_k=1.3"]).curves:
    write(c.run, c.time, c.displacement, c.simulated + rng.normal(0, 0.005, c.time.size))

# %%
print(d := sc.diagnose(folder, next_experiment=False, time_limit_min=0.8))
fig, ax = plt.subplots(figsize=(6.4, 4), layout="constrained")
for c, color in zip(sc.replay(folder).curves[:2], ("tab:blue", "tab:red")):
    ax.plot(1e3 * c.displacement, c.recorded, ".", ms=3, color=color, label=f"{c.run}: recorded")
    ax.plot(1e3 * c.displacement, c.simulated, "-", color=color, label=f"{c.run}: simulated, as described")
ax.set(xlabel="travel of the machine, mm", ylabel="force, N", title=f"{d.verdict}: {', '.join(e.label for e in d.effects[:1])}")
ax.legend(fontsize="small")
fig.savefig("diagnosis.svg")
