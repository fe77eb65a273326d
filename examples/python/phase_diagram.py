# %% [markdown]
# Do the tips slide or stick when a shell is first pressed onto a cylinder of its own radius?
# Sano et al., supplement: they stick above the amount of equation (1). Above 0.919 it is negative: they slide inwards.

# %%
import matplotlib.pyplot as plt
import numpy as np
import supercircle as sc


def boundary(phi_bar):
    """Equation (1), with the ratio of the tip's two elastic responses, equations (2) to (4)."""
    phi = np.pi * phi_bar
    c, s = np.cos(phi), np.sin(phi)
    ratio = (0.5 - 1.5 * c**2 + c - phi * s * c) / (0.5 * phi - 1.5 * s * c + phi * c**2)
    return np.tan(np.pi - phi + np.arctan(ratio))


# %% Thin shells; their density keeps the frequencies. Steps of 10 ms are quasi-static.
h, rows = 2e-5, []
thin = dict(thickness=h, density=1270 * (h / 5e-4) ** 2, speed=2e-4, travel_over_R=0.005, elements=16)
for phi_bar in np.linspace(0.64, 0.97, 12):
    for mu in np.geomspace(0.03, 8, 15):
        r = sc.run("shell_on_cylinder", phi_bar=phi_bar, mu=mu, fixed_dt=0.01, pictures=False, **thin)
        end = r.series.displacement_m.argmax()
        rows.append((phi_bar, mu, r.series.friction_J[end] > 1e-6 * r.series.work_in_J[end]))
phi_bar, mu, slides = np.array(rows).T
print(f"{np.sum(slides == (mu < abs(boundary(phi_bar))))} of {len(rows)} shells do what equation (1) says")

# %%
fig, ax = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
ax.plot(phi_bar[slides == 1], mu[slides == 1], "o", mfc="none", color="tab:blue", label="tips slide")
ax.plot(phi_bar[slides == 0], mu[slides == 0], "x", color="tab:red", label="tips stick: abrupt snap-fit")
line = np.linspace(0.63, 0.98, 2001)
ax.plot(line, abs(boundary(line)), "k-", label="amount of equation (1)")
ax.set(yscale="log", ylim=(0.015, 12), xlabel=r"opening angle / $2\pi$", ylabel=r"friction coefficient $\mu$")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3, fontsize="small")
ax.text(0.7, 0.02, "slide outwards"), ax.text(0.928, 0.02, "inwards")
fig.savefig("phase_diagram.svg")
