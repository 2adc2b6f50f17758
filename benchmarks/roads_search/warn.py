import warnings, elastomdr as em, numpy as np
R=em.load_material("epdm-70-softening") if False else None
import inspect
names=[str(n) for n in getattr(em.materials(),'name',[])] if False else None
T=np.linspace(0,1e-7,4)
from elastomdr.material.validity import Range
R=em.Prony(1e6,[9e6],[1e-2],range=Range(omega=(1e-1,1.),temperature=None))
with warnings.catch_warnings(record=True) as w:
    warnings.simplefilter("always")
    em.slide(R,em.Sphere(.01),time=T,position=1e4*T,load=1.,rtol=1e-1)
    em.drive(R,em.Sphere(.01),time=T,position=1e4*T,load=1.,rtol=1e-1)
for x in w: print(x.category.__name__, x.filename[-40:], x.lineno, str(x.message)[:60])
