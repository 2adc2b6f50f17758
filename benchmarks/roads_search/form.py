import sys; sys.path[:0]=['/tmp/tr']
from ana import *
from scipy.special import erf, erfinv
from elastomdr.rough.psd_integrals import direct
H=np.log(2)/8; BEY=40.0
def m2(A):
    s=1/(np.sqrt(2)*erfinv(np.clip(A,1e-12,1-1e-14)))
    return (1+s*s)*A+s*np.sqrt(2/np.pi)*np.exp(-.5/s**2)
class Pt: pass
def build(p):
    o=Pt(); o.p=p
    kind,*num=p['surface']; s=rt.surface_of(kind,tuple(num),p['ratio']); m=rt.rubber(p['material']).complex_modulus
    lo,hi=float(s.q_low),float(s.q_high)
    n=int(np.ceil(np.log(hi/lo)/H)); h=np.log(hi/lo)/n
    x=np.log(lo)+h*(np.arange(n)+.5)
    nb=int(np.log(BEY)/h); xb=np.log(hi)+h*(np.arange(nb)+.5)
    o.h=h; o.n=n; o.x=np.concatenate([x,xb]); q=np.exp(o.x)
    drag,stiff,_=direct(m,q*p['velocity'])
    o.ratio=2*p['pressure']*drag/stiff
    o.f=np.concatenate([q[:n]**4*s.at(q[:n])*stiff[:n]/4/p['pressure']**2,np.zeros(nb)])
    R=np.cumsum(o.f)*h/2; R=R-o.f*h/4
    o.P=ms.contact(R,.5,True); o.Vfull=o.f.sum()*h
    o.A=float(ms.contact(np.array([o.Vfull/2]),.5,True)[0])
    o.full=(o.f*o.ratio).sum()*h
    o.form=float(ms.weighed(prep(p)[2])[0]); 
    if p['mu']:
        o.mu,o.u=rt.truth(p['mu']); o.mu*=o.full; o.At,o.uA=rt.truth(p['area'])
    if p.get('bands'):
        b=np.array(p['bands']); k=len(b)-5; o.bands=b; o.nband=k
        e=np.log(hi)+np.log(2)/2*np.arange(-k,6); o.edges=e; o.edges[0]=min(e[0],np.log(lo))
    o.d=o.x[:,None]-o.x[None,:n]
    return o
if __name__=='__main__':
    pts=[build(p) for p in load(sys.argv[1])]
    for o in pts:
        V=o.bands[:,2].sum()*o.Vfull
        print(o.p['surface'],o.p['ratio'],o.p['material'],'A',round(o.A,4),round(o.At,4),'var/m2(At)-1:',round((V+1)/m2(o.At),3),'with A th',round((V+1)/m2(o.A),3),'P2 share',round((o.P[:o.n]**2*o.f[:o.n]).sum()*o.h/V,2))
