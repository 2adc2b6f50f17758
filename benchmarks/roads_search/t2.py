import sys; sys.path[:0]=['/work/wt/roads/benchmarks']
import numpy as np, time
import rough_truth as rt
from elastomdr.rough import half_space as hs
from elastomdr.surface.spectrum import rough_map
for i in (10,5,4):
    rng=np.random.default_rng([1,i]); s=rt.draw(rng,1024)
    kind,*num=s['surface']; sp=rt.surface_of(kind,tuple(num),s['ratio']); m=rt.rubber(s['material']).complex_modulus
    n=4*-(-s['per_wave']*s['periods']*s['ratio']//4)
    h,side=rough_map(sp,3,periods=s['periods'],points=n); h=h[::2,::2]
    for dbl in (False,True):
        t=time.process_time()
        f=hs.solve(m,h,(side,side),velocity=s['velocity'],pressure=s['pressure'],double=dbl)
        print(i,dbl,f.area,f.stress,f.settled,f.products,f'{time.process_time()-t:.2f}s',flush=True)
