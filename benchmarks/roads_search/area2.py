import sys; sys.path[:0]=['/tmp/tr']
from fit2 import *
lg=np.linspace(np.log(1e-4),np.log(1e8),1500); g_=np.exp(lg); Pg=erf(.5/np.sqrt(g_))
def table(gam,b):
    S=gam-b*Pg**2+(1-gam+b)*Pg**4 if b else gam+(1-gam)*Pg**2
    R=np.exp(lg[0])+np.concatenate([[0],np.cumsum(.5*(g_[1:]/S[1:]+g_[:-1]/S[:-1])*np.diff(lg))])
    return np.log(R)
def P_of(R,tab): return erf(.5*np.exp(-.5*np.interp(np.log(R),tab,lg)))
def features(o):
    n=o.n; R=np.cumsum(o.f[:n])*o.h/2; return R[-1], o.fe/2/R[-1]
def prepD(o):
    n=o.n
    f=o.f[:n]; o.fe=np.exp(1.5*np.log(f[-1])-.5*np.log(f[-2])) if n>2 else f[-1]
    o.R,o.D=features(o)
gf=[]
s_=em.SelfAffine(.8,rms_slope=.2766,q_low=1.,q_high=100.)
for pp,Ag in zip([1e-4,.001,.005,.01,.015,.025,.04,.065,.086,.113,.147,.191,.24],[.00083,.00827,.0399,.0779,.1147,.1852,.2846,.4326,.5403,.6571,.7719,.8739,.9406]):
    o=Pt(); n=54; h=np.log(100)/n; x=h*(np.arange(n)+.5); q=np.exp(x); o.h=h;o.n=n;o.x=x; o.At=Ag; o.uA=.01
    o.f=q**4*s_.at(q)*2*np.pi/4/pp**2; o.p={'surface':'gfmd','ratio':100,'material':'elastic'}; gf.append(o)
if __name__=='__main__':
    new=[build(p) for p in load(*sys.argv[1:])]
    pts=[o for o in old if np.isfinite(o.At) and o.At<.999]+new+gf
    for o in pts: prepD(o)
    At=np.array([o.At for o in pts]); isnew=np.array([hasattr(o,'bands') for o in pts]); isg=np.array([o.p['surface']=='gfmd' for o in pts])
    R=np.array([o.R for o in pts]); D=np.array([o.D for o in pts])
    print('D range',D.min(),D.max())
    w=np.where(isg,.015,np.where(isnew,.02,.04))
    def pred(c):
        gam,b,c0,c1=c
        return P_of(R*np.exp(c0)*D**c1,table(gam,b))
    for name,c0,fix in (('gam',[.5,0,0,0],[0,1,1,1]),('gam D',[.5,0,0,0],[0,1,1,0]),('gam c0 D',[.5,0,0,0],[0,1,0,0]),('wm gam D',[.5,.2,0,0],[0,0,1,0]),('wm c0 D',[.5,.2,0,0],[0,0,0,0])):
        fix=np.array(fix,bool); c=np.array(c0,float)
        def rr(y): z=c.copy(); z[~fix]=y; return np.log(pred(z)/At)/w
        s=least_squares(rr,c[~fix],loss='soft_l1',x_scale=.2,diff_step=1e-3); c[~fix]=s.x
        off=np.log(pred(c)/At)
        print(name,np.round(c,3))
        for nm,k in (('old',~isnew&~isg),('new',isnew),('gfmd',isg)): print(nm); stat(off[k],At[k])
    for o,v in zip(pts,off):
        if hasattr(o,'bands'): print(round(o.At,4),round(v,3),round(o.D,2),o.p['surface'],o.p['ratio'],o.p['material'])
    print(np.round(off[isg],3))
