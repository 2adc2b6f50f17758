import jax, jax.numpy as jnp
jax.config.update("jax_enable_x64", True)
from elastomdr.material.relaxation import Relaxation
from elastomdr.element.contact_step import coefficients, lag, coefficients_of_steps
import numpy as np
def f(m, h, which):
    law = Relaxation(jnp.asarray(4e6), jnp.stack([m]), jnp.asarray([1e-3]), jnp.asarray(0.0))
    c = coefficients(law, h)
    x = lag(c) if which=="lag" else getattr(c, which)
    return jnp.sum(x)
for w in ("lag",)+("decay","mean","gain","energy","seen","stiffness","end","drag","blow"):
    print(w, [float(jax.jit(jax.grad(f),static_argnums=2)(12e6, jnp.asarray(h), w)) for h in (1e-15,1e-12,1e-9,1e-6,1e-5,1.25e-4,1e-3)])
