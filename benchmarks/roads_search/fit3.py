import sys; sys.path[:0]=['/tmp/tr']
from area2 import *
TAB=table(.618,0.); C0,C1=-.044,.134
def prepP(o):
    n=o.n; f=o.f[:n]; 
    Rm=np.cumsum(f)*o.h/2-f*o.h/4; Dm=f/2/Rm
    o.Pq=P_of(Rm*np.exp(C0)*Dm**C1,TAB); o.fe=np.exp(1.5*np.log(f[-1])-.5*np.log(f[-2])) if n>2 else f[-1]
    R=f.sum()*o.h/2; o.D=o.fe/2/R; o.Ap=float(P_of(R*np.exp(C0)*o.D**C1,TAB)); o.Pq=np.maximum(o.Pq,o.Ap)
NAMES=['n','k','l','w','g','e','r']
def model(o,c,A=None,full=False):
    n,k,l,w,g,e,r=c
    A=o.Ap if A is None else A
    P=o.Pq; f=o.f[:o.n]
    coh=P**n*(1-k*(1-A)*P**0)*f
    src=f*(1-P**r)*P**g
    T=np.exp(-l*(o.d+w))/(1+np.exp(-15*(o.d+w)))
    tail=T@src*o.h
    tot=(m2(min(A,1-1e-9))-1)*(1+e*A*(1-A))
    N=max(tot-coh.sum()*o.h,0)/(tail.sum()*o.h+1e-30)
    D=N*tail; D[:o.n]+=coh
    mu=(D*o.ratio).sum()*o.h
    return (mu,D,N) if full else mu
def bandres(o,D):
    cum=np.concatenate([[0],np.cumsum(D)*o.h]); xe=np.concatenate([[o.x[0]-o.h/2],o.x+o.h/2])
    Db=np.diff(np.interp(np.append(o.edges[:-1],o.x[-1]+o.h/2),xe,cum))
    true=o.bands[:o.nband+4,2]*o.Vfull; k=o.nband+3
    return np.log(np.maximum(Db[:k],1e-30)/np.maximum(true[:k],1e-30))*np.sqrt(true[:k]/true.sum())
if __name__=='__main__':
    new=[build(p) for p in load(*sys.argv[1:])]
    for o in old+new: prepP(o)
    trueA=len(sys.argv)>9
    def res(c):
        r=[]
        for o in old: r.append(np.log(model(o,c)/o.mu)/np.hypot(o.u,.04))
        for o in new:
            mu,D,N=model(o,c,A=min(o.At,.99999),full=True)
            r.append(2*np.log(mu/o.mu)/np.hypot(o.u,.03)); r+=list(np.clip(bandres(o,D),-2,2)/.15)
        return np.array(r)
    c0=[2.,.1,1.2,.1,1,.3,2.]
    s=least_squares(res,c0,loss='soft_l1',x_scale=.3); c=s.x; print(dict(zip(NAMES,np.round(c,3))))
    for name,pts in (('old',old),('new',new)):
        off=np.array([np.log(model(o,c)/o.mu) for o in pts]); print(name,'A predicted'); stat(off,np.array([o.A for o in pts]))
        if name=='new': off=np.array([np.log(model(o,c,A=min(o.At,.99999))/o.mu) for o in pts]); print(name,'A true'); stat(off,np.array([o.A for o in pts]))
    for o,v in zip(new,off): print(round(o.At,4),'A',round(np.log(o.Ap/o.At),3),'mu',round(v,3),round(np.log(model(o,c)/o.mu),3),'form',round(np.log(o.form/o.mu),3),o.p['surface'],o.p['ratio'],o.p['material'])
