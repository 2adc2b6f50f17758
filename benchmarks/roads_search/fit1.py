import sys; sys.path[:0]=['/tmp/tr']
from form import *
from scipy.optimize import least_squares
def model(o,c,A=None,full=False):
    A=o.At if A is None else A
    n,m,l,w,g=c[:5]
    T=1/(np.exp(-m*(o.d+w))+np.exp(l*(o.d+w)))     # x^m rising, x^-l falling
    T/= (T.sum(0)*o.h)
    coh=o.P[:o.n]**n*o.f[:o.n]
    src=o.f[:o.n]*(1-o.P[:o.n]**n)*o.P[:o.n]**g
    tail=T@src*o.h
    tot=(m2(A)-1)*(1+c[5]*A*(1-A))
    N=max(tot-coh.sum()*o.h,1e-9)/(tail.sum()*o.h)
    D=N*tail; D[:o.n]+=coh
    mu=(D*o.ratio).sum()*o.h
    return (mu,D,N) if full else mu
def res(c,pts,bands=True):
    r=[]
    for o in pts:
        mu,D,N=model(o,c,full=True)
        r.append(np.log(mu/o.mu)/np.hypot(o.u,.02))
        if bands:
            cum=np.concatenate([[0],np.cumsum(D)*o.h])
            xe=np.concatenate([[o.x[0]-o.h/2],o.x+o.h/2])
            e=np.append(o.edges[:-1],o.x[-1]+o.h/2)
            Db=np.diff(np.interp(e,xe,cum))
            true=o.bands[:o.nband+4,2]*o.Vfull
            true[-1]=o.bands[o.nband+3:,2].sum()*o.Vfull if 0 else true[-1]
            k=o.nband+3
            share=true[:k]/true.sum()
            r+=list(.3*np.clip(np.log(Db[:k]/np.maximum(true[:k],1e-30)),-3,3)/.15*np.sqrt(share))
    return np.array(r)
if __name__=='__main__':
    pts=[build(p) for p in load(*sys.argv[1:])]
    c0=[2,2,2,0,0,.2]
    s=least_squares(res,c0,args=(pts,),loss='soft_l1',x_scale=.3)
    c=s.x; print(len(pts),np.round(c,3))
    off=np.array([np.log(model(o,c)/o.mu) for o in pts]); offt=np.array([np.log(o.form/o.mu) for o in pts])
    print('rms new',np.sqrt(np.mean(off**2)),'form',np.sqrt(np.mean(offt**2)))
    for o,a,b in zip(pts,off,offt): print(o.p['surface'],o.p['ratio'],o.p['material'],round(o.At,4),'new',round(a,3),'form',round(b,3),'u',round(o.u,3), 'v',f"{o.p['velocity']:.2g}")
