import jax, jax.numpy as jnp, numpy as np, elastomdr as em, time as tm
jax.config.update("jax_enable_x64", True)
X = np.arange(64) * 1e-5
WAVY = em.RoughLine(X, 4e-6 * np.cos(2 * np.pi * X / 6.4e-4))
time = np.linspace(0, 4e-3, 5)
def place(mass, modulus):
    rubber = em.Foundation(4e6, jnp.stack([modulus]), [1e-3])
    f = em.drive(rubber, WAVY, time=time, position=0.05*time, load=20.0, tangential=em.Mount(mass,1e4,1.0), rtol=1e-1)
    return f.position[-1]*1e4
both = jax.jit(jax.value_and_grad(place, argnums=(0,1)))
c=tm.process_time()
for m in (5e-3, 5e-3*(1+1e-4)):
    v, g = both(jnp.asarray(m), jnp.asarray(12e6))
    print(v, g)
print(tm.process_time()-c)
