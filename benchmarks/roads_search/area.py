import sys; sys.path[:0]=['/tmp/tr']
from fit2 import *
def areaP(o,c):
    """P on the grid and A, dG/dx = f/2 S(P lagged by d)"""
    g,k,d,b=c
    n=o.n; x=o.x[:n]; G=0.0; P=np.ones(n+1); xe=x[0]-o.h/2+o.h*np.arange(n+1)
    lag=max(d,0)/o.h
    for i in range(n):
        j=i-lag
        if j<=0: Pl=1.0
        else:
            i0=min(int(j),i); Pl=P[i0]+(j-i0)*(P[min(i0+1,i)]-P[i0])
        # midpoint predictor
        S=g+(1-g)*Pl**k if b==0 else g-b*Pl**2+(1-g+b)*Pl**4
        G+=o.f[i]*o.h/2*S
        P[i+1]=erf(.5/np.sqrt(G))
    return P[-1],0.5*(P[1:]+P[:-1])
if __name__=='__main__':
    new=[build(p) for p in load(*sys.argv[1:])]
    pts=[o for o in old if np.isfinite(o.At) and o.At<.999]+new
    At=np.array([o.At for o in pts]); isnew=np.array([hasattr(o,'bands') for o in pts])
    def r(c): return np.array([np.log(areaP(o,c)[0]/o.At) for o in pts])/np.where(isnew,.02,.05)
    for name,c0,fix in (('lag',[.5,2,.3,0],[0,1,0,1]),('lag k',[.5,2,.3,0],[0,0,0,1])):
        fix=np.array(fix,bool); c=np.array(c0,float)
        if (~fix).any():
            def rr(y): z=c.copy(); z[~fix]=y; return r(z)
            s=least_squares(rr,c[~fix],loss='soft_l1',x_scale=.2,diff_step=1e-3); c[~fix]=s.x
        off=np.array([np.log(areaP(o,c)[0]/o.At) for o in pts])
        print(name,np.round(c,3)); 
        for nm,k in (('old',~isnew),('new',isnew)): print(nm); stat(off[k],At[k])
    if 1:
        s_=em.SelfAffine(.8,rms_slope=.2766,q_low=1.,q_high=100.)
        for pp,Ag in zip([1e-4,.001,.005,.01,.015,.025,.04,.065,.086,.113,.147,.191,.24],[.00083,.00827,.0399,.0779,.1147,.1852,.2846,.4326,.5403,.6571,.7719,.8739,.9406]):
            o=Pt(); n=54; h=np.log(100)/n; x=h*(np.arange(n)+.5); q=np.exp(x); o.h=h;o.n=n;o.x=x
            o.f=q**4*s_.at(q)*2*np.pi/4/pp**2
            print(pp,Ag,round(areaP(o,c)[0]/Ag-1,3), round(areaP(o,[.5,2,0,0])[0]/Ag-1,3))
    for o,v in zip(pts,off):
        if hasattr(o,'bands'): print(round(o.At,4),round(v,3),o.p['surface'],o.p['ratio'],o.p['material'])
