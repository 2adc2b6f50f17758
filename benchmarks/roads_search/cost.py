import time, numpy as np
import elastomdr as em
from elastomdr.arrays import numpy_unless_traced
from elastomdr.material.relaxation import Relaxation
from elastomdr.surface.lines import SingleLine
from elastomdr.transient.body_motion import Scene, run, Mount
from elastomdr.transient.body_over_line import indenter
from elastomdr.transient.problem import Steps
S=200
@numpy_unless_traced
def go(kind,n,k):
    law=Relaxation(4e6,np.full(k,1e6),np.geomspace(1e-6,1,k),0.0)
    sp=6e-3/n
    surf=indenter(SingleLine(em.Paraboloid(0.01)),-2e-3,sp,n,1.0)
    steps=Steps(np.full(S,1e-5),np.arange(S)*sp,np.full(S,2.0))
    mounts={"slide":(None,None),"tang":(Mount(.1,1e4,1.),None),"both":(Mount(.1,1e4,1.),Mount(.1,1e4,1.))}[kind]
    c=time.process_time()
    run(Scene(law,surf,*mounts),steps,np.arange(0,S,20),viscous=False,balance=kind!="slide")
    return (time.process_time()-c)/S
for kind in ("slide","tang","both"):
    for n in (128,1024,8192):
        for k in (1,10):
            t=min(go(kind,n,k) for _ in range(2))
            print(kind,n,k,f"{1e6*t:.0f} us/step")
