import sys; sys.path[:0]=['/tmp/tr']
from fit1 import *
c=[2.7,23,1.16,-.1,.96,.31]
pts=[build(p) for p in load(*sys.argv[1:])]
s=least_squares(res,c,args=(pts,),loss='soft_l1',x_scale=.3); c=s.x; print(len(pts),np.round(c,3))
for o in pts:
    mu,D,N=model(o,c,full=True)
    # contrast of f: where
    print(round(o.At,4),'A/Ath',round(o.At/o.A,3),'uA',round(o.uA,3),'N',round(N,3),'mu off',round(np.log(mu/o.mu),3),o.p['surface'],o.p['ratio'],o.p['material'])
