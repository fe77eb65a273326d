# %% [markdown]
# Snap-fit: a shell is pushed over a cylinder of its own radius R and pulled back.
# Forces are in B / R^2 with the bending stiffness B of the section; travel is in R.

# %%
import matplotlib.pyplot as plt
import supercircle as sc

R = 0.0192  # of the scene, m

# %%
fig, ax = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
for color, mu in zip(("tab:blue", "tab:green", "tab:red"), (0.1, 0.2, 0.35)):
    r = sc.run("shell_on_cylinder", mu=mu, phi_bar=0.75, elements=32)
    unit = r.summary["peak_force_N"] / r.summary["peak_force_R2_over_B"]  # B / R^2, N
    x, f = r.series.displacement_m / R, r.series.force_N / unit
    turn = x.argmax()
    ax.plot(x[: turn + 1], f[: turn + 1], color=color, label=f"push, $\\mu$ = {mu}")
    ax.plot(x[turn:], f[turn:], "--", color=color, label=f"pull, $\\mu$ = {mu}")
    print(f"mu {mu:4}  push {f.max():.4f}  pull {-f.min():.4f} B/R^2  type {r.summary['snap_type']}")
ax.axhline(0, color="black", lw=0.6)
ax.set(xlabel="travel of the crown / R", ylabel="force against the push, $F R^2 / B$", ylim=(-0.21, 0.12))
ax.set_title(r"Shell on a cylinder, $\bar\Phi$ = 0.75: smooth snap-fit")
ax.legend(ncols=3, fontsize="small", loc="lower left")
fig.savefig("snap_fit.svg")
