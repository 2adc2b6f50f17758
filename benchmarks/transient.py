"""How fast does a rough line march? 10^5 elements, 10 branches, at a given load, beside a loop in C over the same
updates.

    python benchmarks/transient.py

The loop is compiled with gcc (-O3 -march=native -ffast-math), one core for both, 128 of the 10^4 contact steps that
such a run would have; compilation apart. The loop has the same recurrences, the same search for the depth and the same
sums, but no care for elements that strike or leave within a step. Both must give the same depth.
"""

import ctypes
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from common import heading, one_core, save, table, timed, verdict

N, BRANCHES, STEPS = 100_000, 10, 128
SPACING, SHIFT, H, LOAD = 1e-6, 1, 1e-5, 2.0  # element [m], elements per step, step [s], load [N/m]
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

    from elastomdr.material.relaxation import Relaxation
    from elastomdr.solve.over_line import rough
    from elastomdr.solve.slide import march
    from elastomdr.solve.timeline import Steps

    jax.config.update("jax_enable_x64", True)
    record = heading(
        "Marching a rough line, one core", f"{N} elements, {BRANCHES} branches, {STEPS} steps, load control"
    )
    rng = np.random.default_rng(0)
    height = np.cumsum(rng.normal(size=N)) * 1e-8
    height -= np.linspace(0, height[-1], N)
    law = Relaxation(*map(jnp.asarray, (RELAXED, np.full(BRANCHES, BRANCH), TIMES, 0.0)))
    place = SHIFT * SPACING * np.arange(STEPS)
    steps = Steps(*map(jnp.asarray, (np.full(STEPS, H), place, np.full(STEPS, LOAD))))
    surface = rough(jnp.asarray(height), SPACING, height.max())

    def ours() -> np.ndarray:
        return np.asarray(march(law, surface, steps, control="load", viscous=False)[0].depth)

    first = timed(ours).wall
    mine = timed(ours, 3)
    loop = compiled_loop(height)
    theirs = timed(loop, 3)
    rows = [("elastomdr", mine), ("C loop", theirs)]
    updates = N * BRANCHES * STEPS
    record["table"] = table(
        ("method", "ms per step", "branch updates per s"),
        [(name, 1e3 * t.cpu / STEPS, updates / t.cpu) for name, t in rows],
    )
    print(f"\n  first call, compilation included: {first:.1f} s")
    record["figures"] = [
        verdict("processor time over that of the C loop", mine.cpu / theirs.cpu, 1.5),
        verdict("largest relative difference of the depth", np.abs(mine.value / theirs.value - 1).max(), 1e-9),
    ]
    save("transient", record)


def compiled_loop(height: np.ndarray):
    """The loop in C, as a call that gives the depth at the end of each step."""
    folder = Path(tempfile.mkdtemp())
    (folder / "loop.c").write_text(LOOP)
    flags = ["-O3", "-march=native", "-ffast-math", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, "-o", folder / "loop.so", folder / "loop.c", "-lm"], check=True)
    library = ctypes.CDLL(str(folder / "loop.so"))
    y = H / TIMES
    decay, mean = np.exp(-y), -np.expm1(-y) / y
    gain, energy = BRANCH * mean, np.full(BRANCHES, 0.5 / BRANCH)
    stiffness, drag = RELAXED + gain.sum(), (BRANCH * (1 - mean) / y).sum()
    below = np.tile(height - height.max(), 2)
    slope = -np.gradient(below, SPACING)
    shift = np.ascontiguousarray((-SHIFT * np.arange(STEPS)) % N, dtype=np.int32)

    def call() -> np.ndarray:
        u, f, stored, level = np.zeros(N), np.zeros((N, BRANCHES)), np.zeros(N), np.zeros(N)
        out = np.zeros((STEPS, 4))
        numbers = [ctypes.c_double(x) for x in (RELAXED, stiffness, drag)]
        arrays = [a.ctypes.data_as(ctypes.c_void_p) for a in (decay, gain, mean, energy)]
        more = [a.ctypes.data_as(ctypes.c_void_p) for a in (below, slope, shift)]
        state = [a.ctypes.data_as(ctypes.c_void_p) for a in (u, f, stored, level, out)]
        library.run(N, BRANCHES, STEPS, *arrays, *numbers, *more, ctypes.c_double(LOAD * N), *state)
        return out[:, 0]

    return call


if __name__ == "__main__":
    main()
