import sys, jax, jax.numpy as jnp, numpy as np, elastomdr as em, time
jax.config.update("jax_enable_x64", True)
from elastomdr.material.relaxation import Relaxation
from elastomdr.transient.body_motion import Scene, run, Mount
from elastomdr.transient.body_over_line import rough
from elastomdr.transient.problem import even_steps
from elastomdr.transient.march import padded
X = np.arange(16) * 4e-5
h = 4e-6 * np.cos(2 * np.pi * X / 6.4e-4)
law = Relaxation(*map(jnp.asarray,(4e6,np.array([12e6]),np.array([1e-3]),0.0)))
T=np.linspace(0,1e-3,3)
def place(mass, room, early):
    surf = rough(jnp.asarray(h), 4e-5, h.max())
    steps, inst = even_steps(T, 0.05*T, np.full(3,20.0), 1e-3, early, 4)
    seen,_ = run(Scene(law,surf,Mount(mass,1e4,1.0),None), padded(steps, room), inst)
    return seen.position[-1]*1e4
for room, early in ((1,12),):
    t=time.process_time()
    print(room, early, jax.value_and_grad(place)(5e-3, room, early), f"{time.process_time()-t:.0f}", flush=True)
