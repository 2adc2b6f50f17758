import sys; sys.path[:0]=['/tmp/tr']
from area2 import *
import rough_map as rm
def lossf(o):
    m=(rt.rubber(o.p['material']) if hasattr(o,'bands') else rm.rubber(o.p['material'])).complex_modulus
    q=np.exp(o.x[:o.n]); _,_,lost=direct(m,q*o.p['velocity'],True)
    f=o.f[:o.n]; R=np.cumsum(f)
    o.L=(f*lost).sum()/f.sum(); o.Lend=lost[-1]
    # log-slope measures
    w=f/f.sum(); o.mean=(w*(o.x[:o.n]-o.x[o.n-1])).sum(); o.Df=np.gradient(np.log(f),o.h)[-3:].mean()
    o.bw=np.log(o.R/ (o.f[:max(2,o.n//8)].sum()*o.h/2))
if __name__=='__main__':
    new=[build(p) for p in load(*sys.argv[1:])]
    pts=[o for o in old if np.isfinite(o.At) and o.At<.98]+new
    for o in pts: prepD(o); lossf(o)
    isnew=np.array([hasattr(o,'bands') for o in pts])
    for nm,k in (('old',~isnew),('new',isnew)):
        P=[o for o,z in zip(pts,k) if z]
        A=np.array([o.At for o in P]); g=np.array([o.R for o in P])
        # effective ln c such that P_of(R*exp(lnc))=A for gamma .5
        tab=table(.5,0); lnR=np.interp(erfinv(np.clip(A,1e-9,1-1e-12)),np.sort(.5/np.sqrt(g_)),tab[::-1]) if 0 else None
        G=1/(2*erfinv(np.clip(A,1e-9,1-1e-12)))**2; lnc=np.interp(np.log(G),lg,tab)-np.log(g)
        X={'lnD':np.log([o.D for o in P]),'L':np.array([o.L for o in P]),'Lend':np.array([o.Lend for o in P]),'mean':np.array([o.mean for o in P]),'lnA':np.log(A),'A':A,'lnM':-np.log([-o.mean+.05 for o in P]),'AL':A*np.array([o.L for o in P]),'L2':np.array([o.L for o in P])**2,'lnV':np.log(np.array([o.R for o in P])),'Df':np.array([o.Df for o in P])}
        print(nm,len(P),'lnc mean',lnc.mean().round(3),'std',lnc.std().round(3))
        for kx,v in X.items(): print('  corr',kx,np.corrcoef(v,lnc)[0,1].round(2))
        wt=1/np.array([max(o.uA,.005) for o in P]); wt=1/np.hypot(1/wt,.03)
        for combo in (['lnM','L'],['lnM','Lend'],['lnM','L','A'],['lnM','L','A','lnD'],['lnM','L','lnV'],['lnM','L','AL','A'],['lnM','L','Lend','A'],['lnD'],['L'],['lnD','L'],['mean','L'],['lnD','L','A'],['lnD','L','A','mean'],['lnD','Lend'],['Df','L']):
            M=np.column_stack([np.ones(len(P))]+[X[c] for c in combo]); b,*_=np.linalg.lstsq(M,lnc,rcond=None); print('   ',combo,np.round(b,3),'worst',np.abs(lnc-M@b).max().round(2),'rest',np.std(lnc-M@b).round(3))
