import sys, jax, jax.numpy as jnp, numpy as np, elastomdr as em, time
jax.config.update("jax_enable_x64", True)
from elastomdr.material.relaxation import Relaxation
from elastomdr.transient.body_motion import Scene, run, Mount
from elastomdr.transient.body_over_line import rough
from elastomdr.transient.problem import even_steps
from elastomdr.transient.march import padded
N=int(sys.argv[1]); finer=int(sys.argv[2]); room=int(sys.argv[3])
X = np.arange(64) * 1e-5
W = em.RoughLine(X, 4e-6 * np.cos(2 * np.pi * X / 6.4e-4))
T=np.linspace(0,4e-3,5)
def place(mass, modulus):
    law = Relaxation(jnp.asarray(4e6), jnp.stack([modulus]), jnp.asarray([1e-3]), jnp.asarray(0.0))
    sh = jnp.minimum(jnp.min(jnp.where(law.moduli>0,law.times,jnp.inf),initial=jnp.inf),1e-3)
    surf = rough(jnp.tile(W._finer(finer), room//finer), 1e-5/finer, jnp.asarray(W.highest))
    steps, inst = even_steps(T, jnp.asarray(0.05*T), jnp.asarray(np.full(5,20.0)), sh, 12, N*finer)
    seen,_ = run(Scene(law,surf,Mount(mass,1e4,1.0),None), padded(steps, 16*N*room), inst)
    return seen.position[-1]*1e4
t=time.process_time()
f=jax.jit(jax.value_and_grad(place,argnums=(0,1)))
print(sys.argv[1:], f(5e-3, 12e6), f"{time.process_time()-t:.0f}", flush=True)
