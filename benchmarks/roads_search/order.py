import sys, time; sys.path.insert(0,'/work/main/benchmarks')
import numpy as np
import rough_map as rm, elastomdr as em
from elastomdr.rough import half_space, random_maps as maps
from elastomdr.surface.spectrum import rough_map
def run(H,ratio,per,name,v,p,seed=1):
    s=em.SelfAffine(H,rms_slope=1.0,q_low=1.0,q_high=float(ratio))
    mat=rm.rubber(name).complex_modulus
    n=16*ratio*per
    h,side=rough_map(s,seed,periods=per,points=n)
    h4=rm._coarser(h,n)  
    out=[]
    for c in (16,8,4,2):
        hc=h[::16//c,::16//c]
        t=time.process_time()
        f=half_space.solve(mat,hc,(side,side),velocity=v,pressure=p,double=False)
        own=maps.full_contact_of_map(mat,hc,(side,side),v,p)
        out.append((f.stress/p/own,f.area,f.settled,time.process_time()-t))
    o=np.array([x[:2] for x in out])
    d=o/o[0]-1
    print(H,ratio,name,v,p,'A',round(o[0,1],4),'mu 8,4,2:',np.round(d[1:,0],4),'A 8,4,2:',np.round(d[1:,1],4),[round(x[3],1) for x in out],flush=True)
run(.8,16,4,'one1.3',.06,.03)
run(.8,16,4,'one100',.06,.3)
run(.8,16,4,'one100',1e-3,.03)
run(.8,16,4,'pow6_1000',.06,.5)
run(.5,16,4,'flat6_30',.06,.1)
run(.5,16,4,'one11',.5,.1)
run(.8,32,2,'pow8_1000',.06,3)
