import sys; sys.path[:0]=['/tmp/tr']
from fit1 import *
import pickle
from form import Pt
import __main__; __main__.Pt=Pt
old=pickle.load(open('/tmp/tr/old.pkl','rb'))
def stat(off,A):
    for lo,hi in ((0,.01),(.01,.05),(.05,.25),(.25,.75),(.75,1.01),(0,1.01)):
        k=(A>=lo)&(A<hi); print('  ',lo,hi,k.sum(),'rms',round(np.sqrt(np.mean(off[k]**2)),3),'mean',round(off[k].mean(),3),'max',round(abs(off[k]).max(),3))
def modN(o,c,full=False):
    n,l,w,g,N,e=c[:6]
    T=np.where(o.d>=-w,np.exp(-l*(o.d+w)),0.0)
    # smooth start of the step across a cell
    T=np.exp(-l*(o.d+w))/(1+np.exp(-20*(o.d+w)))
    coh=o.P[:o.n]**n*o.f[:o.n]
    src=o.f[:o.n]*(1-o.P[:o.n]**n)*o.P[:o.n]**g
    D=N*l*(T@src)*o.h; D[:o.n]+=coh
    return ((D*o.ratio).sum()*o.h,D) if full else (D*o.ratio).sum()*o.h
if __name__=='__main__':
    new=[build(p) for p in load(*sys.argv[1:])]
    def r(c): 
        a=[np.log(modN(o,c)/o.mu)/np.hypot(o.u,.03) for o in old+new]
        return np.array(a)
    s=least_squares(r,[2.7,1.2,.1,1,.5,0],loss='soft_l1',x_scale=.3); c=s.x; print(np.round(c,3))
    for name,pts in (('old',old),('new',new)):
        off=np.array([np.log(modN(o,c)/o.mu) for o in pts]); print(name); stat(off,np.array([o.A for o in pts]))
        offt=np.array([np.log(o.form/o.mu) for o in pts]); print('form'); stat(offt,np.array([o.A for o in pts]))
