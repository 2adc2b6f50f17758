"""Uses of the public names that a type checker must accept, with the types it must see."""

from typing import assert_type

import jax
import jax.numpy as jnp
import numpy as np
import pandas as pd
import pint
import polars as pl
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

import elastomdr as em
from elastomdr.material.prony import Prony

# Materials
rubber = em.Prony(1e6, [5e5], [1e-3], kind="tensile", poisson=0.5, shift=em.WLF(8.86, 101.6, 293.15), name="rubber")
assert_type(rubber, Prony)
assert_type(rubber.shear(), Prony)
em.Prony(np.float32(1e6), np.array([5e5]), jnp.array([1e-3]), range={"omega": (1e-2, 1e6)}, bulk=2e9)
em.Maxwell(1e6, 1e-3, kind="tensile", viscosity=1.0)
em.KelvinVoigt(1e6, 1e3, poisson=0.4)
library = em.load_material("epdm-70")
assert_type(library.at(293.15), Prony | em.TabulatedModulus)
table = em.TabulatedModulus(np.logspace(0, 3, 4), [1e6, 2e6, 3e6, 4e6], [1e5] * 4)
foundation = em.half_space(rubber)
assert_type(foundation, em.Foundation)
assert_type(em.springs(rubber, 1e-3, bonded=False), em.Foundation)
em.springs(library, 1e-3, bonded=False)
modulus = library.complex_modulus([1.0, 10.0])
print(modulus.real.max(), modulus.imag[0], float(rubber.storage(10.0)), float(rubber.moduli[0]))
print(float(em.WLF(8.86, 101.6, 293.15).a(300.0)))

# Verbs: numbers, lists, arrays of NumPy and JAX, columns of a table
frame = pd.DataFrame({"v": [0.1, 1.0]})
ball, road = em.Sphere(5e-3), em.SelfAffine(0.8, rms_slope=0.3, q_low=1e2, q_high=1e6)
curve = em.friction(rubber, ball, velocity=np.logspace(-3, 1, 20), load=1.0, model=em.Averaged())
assert_type(curve, em.FrictionCurve)
em.friction(library, ball, velocity=[0.1, 1], load=[[1.0], [2.0]], model="half-space")
em.friction(rubber, ball, velocity=jnp.linspace(0.1, 1.0), depth=np.float32(1e-5), temperature=300)
em.friction(rubber, ball, velocity=frame["v"], load=1.0)
em.friction([rubber, library], ball, velocity=1, load=1)
em.friction((foundation, rubber), road.line(), velocity=1.0, load=100.0)
em.friction(rubber, road, velocity=1.0, pressure=3e5, heat=em.Heat(0.2, 1.8e6), progress=lambda done, total: None)
assert_type(em.friction(table, road, velocity=1.0, pressure=3e5, model="persson"), em.FrictionCurve)
assert_type(em.rolling(foundation, em.Cylinder(0.05, 0.1), velocity=1.0, load=100.0), em.RollingCurve)
assert_type(em.impact([rubber, rubber], ball, mass=0.01, velocity=1.0), em.Impact)
assert_type(em.indent(rubber, ball, time=[0.0, 1.0], depth=[0.0, 1e-4]), em.Indentation)
assert_type(em.slide(library, road.line(), time=[0.0, 1.0], position=[0.0, 1e-2], load=10.0), em.Slide)
assert_type(em.traction(rubber, ball, velocity=1.0, creepage=[0.0, 0.1], friction=curve.law(), load=1.0), em.Traction)
em.drive(rubber, ball, time=[0.0, 1.0], position=[0.0, 1e-2], load=1.0, tangential=em.Mount(1.0, stiffness=1e3))
em.plan(rubber, ball, velocity=1.0, load=1.0, model="line")
em.reference.half_space_sliding(rubber, np.zeros((8, 8)), velocity=1.0, load=1.0, cell=(1e-3, 1e-3))
em.Line(seeds=4, samples=512)
em.HalfSpace(seeds=[1, 2])
assert_type(em.__version__, str)


def loss(stiffness: jax.Array) -> jax.Array:
    """Under JAX's transformations the arguments are JAX's arrays."""
    answer = em.friction(em.Prony(stiffness, [5e5], [1e-3]), em.Sphere(stiffness), velocity=1.0, load=1.0)
    return jnp.sum(jnp.asarray(answer.mu))


jax.grad(loss)(jnp.asarray(1e6))

# Results
print(curve.mu[0], curve.mu.max(), float(curve.mu[0]), 2 * curve.mu, np.log(curve.velocity), curve.mu / curve.mu)
print(curve.mu[curve.converged], curve.mu.shape, len(curve.mu), [float(mu) for mu in curve.mu])
if curve.contact is not None:
    print(curve.contact.leading - curve.contact.trailing)
plt.plot(curve.velocity, curve.mu)
assert_type(curve.plot(style="paper"), Axes)
assert_type(curve.summary(), str)
assert_type(curve.select("rubber"), em.FrictionCurve)
curve.to_excel("x.xlsx")
curve.to_csv("x.csv")
curve.to_pandas().to_parquet("x.parquet")
curve.plot(measured={"velocity": [0.1], "mu": np.array([0.5])})

# Files and fits
measured = em.read_dma(["a.csv", "b.csv"], kind="shear", temperature=[293.15, 303.15], columns={"loss": 4})
assert_type(measured, em.fit.Dma)
master = em.fit.master_curve(measured, 293.15)
assert_type(master, em.fit.MasterCurve)
if master.wlf is not None:
    print(float(master.wlf.c1))
em.fit.prony(master)
series = em.fit.prony([1.0, 10.0], [1e6, 2e6], [1e5, 2e5], shift=master.wlf)
assert_type(series.material, Prony)
em.save_material(series.material, "rubber.toml", info={"description": "black"})
em.fit.calibrate(rubber, ball, velocity=[0.1, 1.0], measured=np.array([0.1, 0.2]), parameters=["modulus"], load=1.0)

# Units and tables in memory
unit = pint.UnitRegistry()
em.friction(em.Prony(1e6, [unit.Quantity(1.0, "MPa")], unit.Quantity(np.array([1.0]), "ms")), em.Sphere(5 * unit.mm),
            velocity=unit.Quantity(np.array([10.0]), "mm/s"), load=unit.Quantity(10, "mN"))  # fmt: skip
em.read_dma(pd.DataFrame())
em.read_dma([pl.DataFrame(), "dma.csv"])
