# %% [markdown]
# Five shells dropped into a narrow box, squeezed to 1 N and released: piles are random, so seeds make the statistics.

# %%
import matplotlib.pyplot as plt
import numpy as np
import supercircle as sc

frictions, seeds = (0.1, 0.5), range(1, 6)
s = sc.sweep("stack30", seeds=seeds, mu=frictions, shells=5, width=0.06, max_force=1, plate_speed=0.02, elements=12)
print(s)

# %%
fig, (left, right) = plt.subplots(1, 2, figsize=(8, 3.8), width_ratios=(2, 1), layout="constrained")
for color, mu in zip(("tab:blue", "tab:red"), frictions):
    of = s.where(mu=mu)
    for k, row in enumerate(of.runs):
        for j, (travel, force) in enumerate(row["branches"]):  # down, up: m, N
            left.plot(1e3 * np.array(travel), force, "-" if j == 0 else "--", color=color, lw=0.8,
                      label=f"$\\mu$ = {mu}, {('down', 'up')[j]}" if k == 0 else None)
    ratio = of["dissipation_ratio"]
    mean, error = ratio.mean(), ratio.std(ddof=1) / np.sqrt(len(ratio))
    right.plot(np.full(len(ratio), mu), ratio, "o", mfc="none", color=color)
    right.errorbar(mu + 0.06, mean, error, fmt="s", color=color, capsize=4)
    print(f"mu {mu}: dissipated share {mean:.3f} +- {error:.3f} (standard error of {len(ratio)} piles)")
left.set(xlabel="travel of the plate from first contact, mm", ylabel="force on the plate, N", ylim=(0, None))
left.legend(fontsize="small")
right.set(xlabel=r"friction coefficient $\mu$", ylabel="dissipated share of the work", ylim=(0, None), xlim=(0, 0.7))
fig.savefig("stack_statistics.svg")
