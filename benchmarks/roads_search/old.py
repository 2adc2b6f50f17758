import sys; sys.path[:0]=['/tmp/tr']
from fit1 import *
import rough_map as rm, pickle
def buildold(p):
    o=Pt(); o.p=p
    H_,ra,ro=rm.SURFACES[p['surface']]
    s=rm.surface_of(p['surface']); m=rm.rubber(p['material']).complex_modulus
    lo,hi=float(s.q_low),float(s.q_high)
    n=int(np.ceil(np.log(hi/lo)/H)); h=np.log(hi/lo)/n
    x=np.log(lo)+h*(np.arange(n)+.5); nb=int(np.log(BEY)/h); xb=np.log(hi)+h*(np.arange(nb)+.5)
    o.h=h;o.n=n;o.x=np.concatenate([x,xb]); q=np.exp(o.x)
    drag,stiff,_=direct(m,q*p['velocity']); o.ratio=2*p['pressure']*drag/stiff
    o.f=np.concatenate([q[:n]**4*s.at(q[:n])*stiff[:n]/4/p['pressure']**2,np.zeros(nb)])
    R=np.cumsum(o.f)*h/2-o.f*h/4; o.P=ms.contact(R,.5,True); o.Vfull=o.f.sum()*h
    o.A=float(ms.contact(np.array([o.Vfull/2]),.5,True)[0]); o.full=(o.f*o.ratio).sum()*h
    at=np.array([p['velocity']]),np.array([p['pressure']])
    o.form=float(ms.weighed(ms.parts(m,nodes(s,16),*at))[0])
    mu=np.array(p['mu']); o.mu=mu.mean(); o.u=max(mu.std(ddof=1)/np.sqrt(len(mu))/o.mu,.01) if len(mu)>1 else .03
    a=p['area']; o.At=float(np.mean(a)) if a is not None else np.nan; o.uA=.02
    o.d=o.x[:,None]-o.x[None,:n]; o.tag=(H_,ra,ro,p['material'])
    return o
if __name__=='__main__':
    pts=[buildold(p) for p in json.load(open('/work/main/benchmarks/results/rough_map.json'))['points'] if p['settled']]
    pickle.dump(pts,open('/tmp/tr/old.pkl','wb'))
    c=np.array([2.696,23.3,1.161,-.106,.961,.31])
    def stat(off,A):
        for lo,hi in ((0,.01),(.01,.05),(.05,.25),(.25,.75),(.75,1.01),(0,1.01)):
            k=(A>=lo)&(A<hi); print(lo,hi,k.sum(),'rms',round(np.sqrt(np.mean(off[k]**2)),3),'mean',round(off[k].mean(),3),'max',round(abs(off[k]).max(),3))
    A=np.array([o.A for o in pts]); At=np.array([o.At for o in pts]); print('area known',np.isfinite(At).sum(),len(pts))
    offt=np.array([np.log(o.form/o.mu) for o in pts]); print('form'); stat(offt,A)
    k=np.isfinite(At)&(At<.9999)
    off=np.array([np.log(model(o,c)/o.mu) for o in np.array(pts)[k]]); print('new, true area'); stat(off,A[k])
    off=np.array([np.log(model(o,c,A=min(.9999999,o.A*.94**(1-o.A)))/o.mu) for o in pts]); print('new, theory area'); stat(off,A)
