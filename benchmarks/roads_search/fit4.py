import sys; sys.path[:0]=['/tmp/tr']
from area2 import *
import rough_map as rm
NAMES=['gam','c0','cM','cE','n','k','l','w','g','e']
C0=[.56,.05,-.13,.9,1.74,.45,2.3,-.4,.75,.38]
def prep4(o):
    m=(rt.rubber(o.p['material']) if hasattr(o,'bands') else rm.rubber(o.p['material'])).complex_modulus
    n=o.n; q=np.exp(o.x[:n]); f=o.f[:n]; x=o.x[:n]
    _,_,o.lost=direct(m,q*o.p['velocity'],True)
    h=o.h
    R=np.cumsum(f)*h/2; I=np.cumsum(f*x)*h/2
    # at cell ends
    xe=x+h/2
    M=xe-I/R+1e-9          # mean distance below the end
    o.Re=R; o.lnMe=-np.log(M+.05); o.loste=np.append(.5*(o.lost[1:]+o.lost[:-1]),o.lost[-1])
    # at centres
    Rm=R-f*h/4; Im=I-f*x*h/4; Mm=x-Im/Rm
    o.Rm=Rm; o.lnMm=-np.log(np.maximum(Mm,0)+.05)
_t={}
def tab(gam):
    key=round(gam,5)
    if key not in _t:
        if len(_t)>50: _t.clear()
        _t[key]=table(gam,0)
    return _t[key]
def closure(o,c):
    gam,c0,cM,cE=c[:4]; t=tab(gam)
    P=P_of(o.Rm*np.exp(c0+cM*o.lnMm+cE*o.lost),t)
    A=float(P_of(o.Re[-1]*np.exp(c0+cM*o.lnMe[-1]+cE*o.loste[-1]),t))
    return A,np.maximum(P,A)
def model(o,c,A=None,full=False):
    Ap,P=closure(o,c)
    A=Ap if A is None else A
    n,k,l,w,g,e=c[4:10]
    f=o.f[:o.n]
    coh=P**n*(1-k*(1-A))*f
    src=f*P**g
    T=np.exp(-l*(o.d+w))/(1+np.exp(-15*(o.d+w)))
    tail=T@src*o.h
    tot=(m2(min(A,1-1e-9))-1)*(1+e*A*(1-A))
    N=max(tot-coh.sum()*o.h,0)/(tail.sum()*o.h+1e-30)
    D=N*tail; D[:o.n]+=coh
    mu=(D*o.ratio).sum()*o.h
    return (mu,D,A,Ap) if full else mu
def bandres(o,D):
    cum=np.concatenate([[0],np.cumsum(D)*o.h]); xe=np.concatenate([[o.x[0]-o.h/2],o.x+o.h/2])
    Db=np.diff(np.interp(np.append(o.edges[:-1],o.x[-1]+o.h/2),xe,cum))
    true=o.bands[:o.nband+4,2]*o.Vfull; k=o.nband+3
    return np.log(np.maximum(Db[:k],1e-30)/np.maximum(true[:k],1e-30))*np.sqrt(true[:k]/true.sum())
def residuals(c,new,old=()):
    r=[]
    for o in new:
        mu,D,A,Ap=model(o,c,full=True)
        r+=[np.log(Ap/o.At)/np.hypot(o.uA,.03),2*np.log(mu/o.mu)/np.hypot(o.u,.03)]
        r+=list(np.clip(bandres(o,D),-2,2)/.2)
    for o in old: r.append(np.log(model(o,c)/o.mu)/np.hypot(o.u,.08))
    return np.array(r)
def fit(new,old=(),c0=C0): 
    return least_squares(residuals,c0,args=(new,old),loss='soft_l1',x_scale=.3,diff_step=1e-4,max_nfev=25).x
if __name__=='__main__':
    new=[build(p) for p in load(*sys.argv[1:])]
    for o in new: prep4(o)
    # GFMD as area constraints
    c=fit(new); print(dict(zip(NAMES,np.round(c,3).tolist())))
    A=np.array([o.At for o in new])
    off=np.array([np.log(model(o,c)/o.mu) for o in new]); offA=np.array([np.log(closure(o,c)[0]/o.At) for o in new])
    print('mu'); stat(off,A); print('area'); stat(offA,A); print('form'); stat(np.array([np.log(o.form/o.mu) for o in new]),A)
    print('true area mu'); stat(np.array([np.log(model(o,c,A=min(o.At,.99999))/o.mu) for o in new]),A)
    for o in gf:
        o.lost=np.zeros(o.n)
        n=o.n;h=o.h;f=o.f[:n];x=o.x;R=np.cumsum(f)*h/2;I=np.cumsum(f*x)*h/2;o.Re=R;o.lnMe=-np.log(x+h/2-I/R+.05);o.loste=o.lost;o.Rm=R-f*h/4;o.lnMm=-np.log(np.maximum(x-(I-f*x*h/4)/o.Rm,0)+.05)
    print('gfmd',np.round([np.log(closure(o,c)[0]/o.At) for o in gf],3))
    # 5-fold held out
    idx=np.random.default_rng(0).permutation(len(new)); ho=np.zeros(len(new)); hA=np.zeros(len(new))
    for k in range(4):
        t=[new[i] for j,i in enumerate(idx) if j%4!=k]; ck=fit(t,c0=c)
        for j,i in enumerate(idx):
            if j%4==k: ho[i]=np.log(model(new[i],ck)/new[i].mu); hA[i]=np.log(closure(new[i],ck)[0]/new[i].At)
    print('held out mu'); stat(ho,A); print('held out area'); stat(hA,A)
    for o,a,b in sorted(zip(new,ho,hA),key=lambda z:-abs(z[1]))[:12]: print(round(o.At,4),'mu',round(a,3),'A',round(b,3),'u',round(o.u,3),o.p['surface'],o.p['ratio'],o.p['material'])
