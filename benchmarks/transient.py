"""How fast does a rough line march? 10^5 elements, 10 branches, at a given load, beside
a loop in C over the same updates.

    python benchmarks/transient.py

The loop is compiled with gcc (-O3 -march=native -ffast-math), one core for both, 128 of
the 10^4 contact steps that such a run would have; compilation apart. The loop has the
same recurrences, the same search for the depth and the same sums, but no care for
elements that strike or leave within a step. Both must give the same depth. Shorter
lines show what a step costs beside its elements. The two take turns, and the least time
of each counts, since neighbours on the machine share its memory.
"""

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from common import heading, one_core, plt, save, table, timed, verdict

SIZES, BRANCHES, STEPS = (1_000, 10_000, 100_000), 10, 128
# element [m], elements per step, step [s], load [N/m]
SPACING, SHIFT, H, LOAD = 1e-6, 1, 1e-5, 2.0
TIMES = np.geomspace(1e-6, 1.0, BRANCHES)
RELAXED, BRANCH = 4e6, 1e6  # E_inf, E_k [Pa]

LOOP = """
#include <math.h>
void run(int n,int k,int steps,const double*dec,const double*gain,const double*mean,const double*en,double E,double S,
         double drag,const double*h,const double*sl,const int*shift,double force,double*u,double*f,double*stored,
         double*lev,double*out){
  double d=0;
  for(int s=0;s<steps;s++){
    const double*b=h+shift[s],*g=sl+shift[s];
    for(int i=0;i<n;i++){ double a=E*u[i]; const double*fi=f+(long)i*k; for(int j=0;j<k;j++)a+=dec[j]*fi[j];
      lev[i]=u[i]-a/S-b[i]; }
    int count=-1,before=-2;
    while(count!=before){ before=count; double sum=0; count=0;
      for(int i=0;i<n;i++) if(lev[i]<d){sum+=lev[i];count++;}
      if(!count){double m=1e300; for(int i=0;i<n;i++) if(lev[i]<m)m=lev[i]; d=m+force/S; count=1;}
      else d=(force/S+sum)/count; }
    double F=0,X=0,W=0;
    for(int i=0;i<n;i++){ double*fi=f+(long)i*k,free=lev[i]+b[i],w=d+b[i],un=fmax(free,w),c=un-u[i],m=0,st=0;
      for(int j=0;j<k;j++){m+=mean[j]*fi[j]; fi[j]=dec[j]*fi[j]+gain[j]*c; st+=en[j]*fi[j]*fi[j];}
      W+=fmax((m+drag*c)*c,st-stored[i])+0.5*E*(un*un-u[i]*u[i]); stored[i]=st; u[i]=un;
      double q=S*(un-free); F+=q; X+=q*g[i]; }
    out[4*s]=d; out[4*s+1]=F/n; out[4*s+2]=X/n; out[4*s+3]=W/n;
  }
}
"""


def main() -> None:
    one_core()
    import jax
    import jax.numpy as jnp

    from elastomdr.element.body_over_line import rough
    from elastomdr.element.moving_body import MotionScene
    from elastomdr.material.relaxation import Relaxation
    from elastomdr.transient.march import run
    from elastomdr.transient.problem import Steps

    jax.config.update("jax_enable_x64", True)
    record = heading(
        "Marching a rough line, one core",
        f"{SIZES[-1]} elements, {BRANCHES} branches, {STEPS} steps, load control",
    )
    if shutil.which("gcc") is None:
        print("  gcc is not installed: there is nothing to compare with")
        return
    law = Relaxation(
        *map(jnp.asarray, (RELAXED, np.full(BRANCHES, BRANCH), TIMES, 0.0))
    )
    place = SHIFT * SPACING * np.arange(STEPS)
    steps = Steps(*map(jnp.asarray, (np.full(STEPS, H), place, np.full(STEPS, LOAD))))
    rows, figures = [], []
    for n in SIZES:
        rng = np.random.default_rng(0)
        height = np.cumsum(rng.normal(size=n)) * 1e-8
        height -= np.linspace(0, height[-1], n)
        surface = rough(jnp.asarray(height), SPACING, height.max())

        def ours(surface=surface) -> np.ndarray:
            options = {"viscous": False, "balance": False}
            return np.asarray(run(MotionScene(law, surface), steps, **options)[0].depth)

        first, loop = timed(ours).wall, compiled_loop(height)
        turns = [(timed(ours), timed(loop)) for _ in range(5)]
        mine, theirs = (
            min(one.cpu for one in ones) for ones in zip(*turns, strict=True)
        )
        off = float(np.abs(turns[0][0].value / turns[0][1].value - 1).max())
        updates = n * BRANCHES * STEPS
        rows.append(
            (
                n,
                1e3 * mine / STEPS,
                1e3 * theirs / STEPS,
                mine / theirs,
                updates / mine,
                off,
                first,
            )
        )
    columns = (
        "elements",
        "elastomdr [ms/step]",
        "C loop [ms/step]",
        "ratio",
        "branch updates per s",
        "difference of depth",
        "first call [s]",
    )
    record["table"] = table(columns, rows)
    figures.append(
        verdict(
            "processor time over that of the C loop, 10^5 elements", rows[-1][3], 1.5
        )
    )
    figures.append(
        verdict(
            "largest relative difference of the depth",
            max(row[5] for row in rows),
            1e-9,
        )
    )
    record["figures"] = figures
    figure, ax = plt.subplots(figsize=(5.6, 4.0), layout="constrained")
    for column, name in ((1, "elastomdr"), (2, "loop in C")):
        ax.loglog(SIZES, [row[column] for row in rows], "o-", label=name)
    ax.set(
        xlabel="Elements [-]",
        ylabel="Processor time per step [ms]",
        title=f"Rough line, {BRANCHES} branches",
    )
    ax.legend(frameon=False)
    ax.grid(True, which="both", color="#dddddd", linewidth=0.5)
    save("transient", record, figure)


def compiled_loop(height: np.ndarray):
    """The loop in C, as a call that gives the depth at the end of each step."""
    folder = Path(tempfile.mkdtemp())
    (folder / "loop.c").write_text(LOOP)
    flags = ["-O3", "-march=native", "-ffast-math", "-shared", "-fPIC"]
    subprocess.run(
        ["gcc", *flags, "-o", folder / "loop.so", folder / "loop.c", "-lm"], check=True
    )
    library = ctypes.CDLL(str(folder / "loop.so"))
    y = H / TIMES
    decay, mean = np.exp(-y), -np.expm1(-y) / y
    gain, energy = BRANCH * mean, np.full(BRANCHES, 0.5 / BRANCH)
    stiffness, drag = RELAXED + gain.sum(), (BRANCH * (1 - mean) / y).sum()
    n = height.size
    below = np.tile(height - height.max(), 2)
    slope = -np.gradient(below, SPACING)
    shift = np.ascontiguousarray((-SHIFT * np.arange(STEPS)) % n, dtype=np.int32)

    def call() -> np.ndarray:
        u, f, stored, level = (
            np.zeros(n),
            np.zeros((n, BRANCHES)),
            np.zeros(n),
            np.zeros(n),
        )
        out = np.zeros((STEPS, 4))
        numbers = [ctypes.c_double(x) for x in (RELAXED, stiffness, drag)]
        arrays = [
            a.ctypes.data_as(ctypes.c_void_p) for a in (decay, gain, mean, energy)
        ]
        more = [a.ctypes.data_as(ctypes.c_void_p) for a in (below, slope, shift)]
        state = [a.ctypes.data_as(ctypes.c_void_p) for a in (u, f, stored, level, out)]
        library.run(
            n,
            BRANCHES,
            STEPS,
            *arrays,
            *numbers,
            *more,
            ctypes.c_double(LOAD * n),
            *state,
        )
        return out[:, 0]

    return call


if __name__ == "__main__":
    main()
