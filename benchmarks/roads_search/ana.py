import sys,json; sys.path[:0]=['/work/wt/roads/benchmarks']
import numpy as np
import rough_truth as rt, elastomdr as em
from elastomdr.rough import multiscale as ms
from elastomdr.rough.psd_integrals import nodes
def load(*files):
    pts=[]
    for f in files:
        for p in json.load(open(f)):
            if p['mu']: pts.append(p)
    return pts
def prep(p):
    kind,*num=p['surface']; s=rt.surface_of(kind,tuple(num),p['ratio']); m=rt.rubber(p['material']).complex_modulus
    at=np.array([p['velocity']]),np.array([p['pressure']])
    pa=ms.parts(m,nodes(s,16),*at)
    return s,m,pa
def show(p):
    s,m,pa=prep(p)
    A=float(pa.area[0]); At,_=rt.truth(p['area']); mu,u=rt.truth(p['mu'])
    full=pa.full[0].ravel(); full=full/full.sum()
    q=pa.at.q.ravel(); P=ms.contact(pa.until,.5,True)[0].ravel()
    b=np.array(p['bands']); nb=len(b)-5
    edges=float(s.q_high)*2.0**(-np.arange(nb,-1,-1)/2)
    W=b[:nb,2]/np.maximum(b[:nb,3],1e-30); L=b[:nb,0]/np.maximum(b[:nb,1],1e-30)
    mid=np.sqrt(edges[1:]*edges[:-1]); Pm=np.interp(np.log(mid),np.log(q),P)
    lossb=b[:nb,1]; beyond=b[nb:,0].sum()/b[:,0].sum()
    form=float(ms.weighed(pa)[0]/pa.full[0].sum())
    print(p['number'],p['surface'],p['ratio'],p['material'],'A th',round(A,4),'true',round(At,4),'mu',round(mu,4),'form/3D',round(form/mu,3),'u',round(u,3),'beyond share',round(beyond,3))
    print('  W/At',np.round(W/At,2)); print('  P/At',np.round(Pm/At,2)); print('  loss ',np.round(lossb,3))
if __name__=='__main__':
    for p in load(sys.argv[1]): show(p)
