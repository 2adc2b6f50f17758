import sys, jax, jax.numpy as jnp, numpy as np, elastomdr as em
jax.config.update("jax_enable_x64", True)
X = np.arange(64) * 1e-5
WAVY = em.RoughLine(X, 4e-6 * np.cos(2 * np.pi * X / 6.4e-4))
time = np.linspace(0, 4e-3, 3)
def place(mass):
    rubber = em.Foundation(4e6, jnp.stack([jnp.asarray(12e6)]), [1e-3])
    found = em.drive(rubber, WAVY, time=time, position=0.05*time, load=20.0, tangential=em.Mount(mass,1e4,1.0), rtol=1e-1, elements=64)
    return found.position[-1]*1e4
print(jax.jit(jax.value_and_grad(place))(5e-3), jax.jit(lambda m: jax.jvp(place,(m,),(1.,)))(5e-3))
