import numpy as np, elastomdr as em, sys
exec(open('/tmp/tr/hexes.py').read().split('C={}')[0])
import elastomdr.transient.refinement as r
old = r.run
def run(scene, steps, instants, **k):
    out = old(scene, steps, instants, **k)
    print(k, len(steps.h), [getattr(x,'dtype',type(x)) for x in (*steps, *out[0], scene.surface.coefficients, scene.surface.spacing, scene.surface.highest, scene.surface.weight, *out[1])])
    return out
r.run = run
em.slide(SOLID,WAVE,time=T,position=X,load=10.,rtol=1e-1)
