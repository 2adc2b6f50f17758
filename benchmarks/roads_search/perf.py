import sys, time, numpy as np
which=sys.argv[1]
import jax, jax.numpy as jnp
jax.config.update("jax_enable_x64", True)
from elastomdr.material.relaxation import Relaxation
from elastomdr.transient.body_over_line import rough
K=10; STEPS=128
TIMES = np.geomspace(1e-6, 1.0, K)
law = Relaxation(*map(jnp.asarray, (4e6, np.full(K, 1e6), TIMES, 0.0)))
place=1e-6*np.arange(STEPS)
a=(np.full(STEPS, 1e-5), place, np.full(STEPS, 2.0))
if which=="old":
    from elastomdr.transient.slide_march import march
    from elastomdr.transient.timeline import Steps
    f=lambda s: march(law, s, Steps(*map(jnp.asarray,a)), control="load", viscous=False)[0].depth
else:
    from elastomdr.transient.body_motion import Scene, run
    from elastomdr.transient.problem import Steps
    f=lambda s: run(Scene(law, s), Steps(*map(jnp.asarray,a)), np.arange(0,STEPS,32) if which=="some" else None, viscous=False, balance=False)[0].depth
for n in (1000,100000):
    rng = np.random.default_rng(0)
    height = np.cumsum(rng.normal(size=n)) * 1e-8
    height -= np.linspace(0, height[-1], n)
    s = rough(jnp.asarray(height), 1e-6, height.max())
    c=time.process_time(); np.asarray(f(s)); first=time.process_time()-c
    best=[]
    for _ in range(7):
        c=time.process_time(); d=np.asarray(f(s)); best.append(time.process_time()-c)
    print(which,n,f"first {first:.2f} warm {1e3*min(best)/STEPS:.4f} ms/step", float(d[-1]))
