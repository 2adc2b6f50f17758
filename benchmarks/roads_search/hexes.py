"""Prints hex of results of transient verbs."""
import warnings, sys, hashlib
import numpy as np, elastomdr as em
warnings.simplefilter("ignore")
SOLID = em.StandardSolid(1e6, 9e6, 1e-2)
RUBBER = em.Prony(1e6, [3e7, 9e6, 3e6], [1e-4, 1e-2, 1.0], shift=em.WLF(8.86, 101.6, 293.15))
DASH = em.Prony(1e6, [3e6], [1e-2], viscosity=1e3)
BALL = em.Sphere(0.01); ROLLER=em.Cylinder(0.05,0.5); CONE=em.Cone(0.1)
WAVE = em.RoughLine(np.arange(64) * 1e-5, 1e-6 * np.cos(2 * np.pi * np.arange(64) / 64))
T=np.linspace(0,0.02,6)
X=0.2*T**2/0.02
L=np.array([1.,1,2,2,.5,.5])
def arr(r):
    out={}
    for q,v in r.fields().items():
        out[q.path if hasattr(q,'path') else q.key]=np.asarray(v)
    return out
C={}
C["slide ball load"]=lambda: em.slide(RUBBER,BALL,time=T,position=X,load=L,temperature=300.,rtol=1e-2)
C["slide cone depth"]=lambda: em.slide(SOLID,CONE,time=T,position=X,depth=1e-5*(1+np.arange(6.)%2),rtol=1e-2)
C["slide dash"]=lambda: em.slide(DASH,BALL,time=T,position=X,load=1.,rtol=1e-1)
C["slide jump"]=lambda: em.slide(SOLID,BALL,time=[0,.01,.01,.02],position=[0,1e-3,1e-3,2e-3],load=[1.,1,2,2],rtol=1e-1)
C["slide roller layer"]=lambda: em.slide(em.springs(SOLID.__class__(1e6,[9e6],[1e-2],poisson=.4) if False else em.Prony(1e6,[9e6],[1e-2],poisson=.4),5e-3),ROLLER,time=T,position=X,load=10.,rtol=1e-1)
C["slide ball springs"]=lambda: em.slide(em.springs(em.Prony(1e6,[9e6],[1e-2],poisson=.4),5e-3),BALL,time=T[:3],position=1e-3*T[:3],load=1.,rtol=1e-1)
C["slide wave"]=lambda: em.slide(SOLID,WAVE,time=T,position=X,load=10.,rtol=1e-1)
C["slide apart"]=lambda: em.slide(SOLID,BALL,time=T,position=X,depth=-1e-6)
C["drive plain"]=lambda: em.drive(SOLID,BALL,time=T,position=X,load=L,rtol=1e-1)
M=em.Mount(.1,1e4,1.); N=em.Mount(.1,0.,3.)
C["drive tang"]=lambda: em.drive(SOLID,BALL,time=T,position=X,load=L,tangential=M,rtol=1e-1)
C["drive both"]=lambda: em.drive(RUBBER,BALL,time=T,position=X,load=1.,tangential=M,normal=N,temperature=300.,rtol=1e-1)
C["drive track"]=lambda: em.drive(SOLID,BALL,time=T[:4],position=X[:4],load=1.,normal=N,track=WAVE,rtol=1e-1)
C["shear"]=lambda: em.shear(RUBBER,BALL,time=T,displacement=1e-6*np.sin(T*300),friction=.5,load=L,elements=200,steps=4)
C["shear elastic"]=lambda: em.shear(em.Prony(1e6,[],[]),BALL,time=T,displacement=1e-6*np.sin(T*300),friction=.5,load=L,elements=400)
C["shear elastic exact"]=lambda: em.shear(em.Prony(1e6,[],[]),BALL,time=T,displacement=1e-6*np.sin(T*300),friction=.5,depth=1e-5)
C["shear dash"]=lambda: em.shear(DASH,BALL,time=T,displacement=1e-6*np.sin(T*300)*(T>0),friction=.5,load=L,elements=100,steps=4)
C["shear default"]=lambda: em.shear(SOLID,BALL,time=T,displacement=1e-6*np.sin(T*300),friction=.5,load=1.)
C["shear roller"]=lambda: em.shear(em.springs(em.Prony(1e6,[9e6],[1e-2],poisson=.4),5e-3),ROLLER,time=T,displacement=1e-6*np.sin(T*300),friction=.5,load=1.,tangential=em.springs(em.Prony(1e6,[9e6],[1e-2],poisson=.4),5e-3,tangential=True),elements=100,steps=4)
C["impact"]=lambda: em.impact(RUBBER,BALL,mass=[.01,.02],velocity=1.,temperature=300.)
C["impact layer"]=lambda: em.impact(em.layer(RUBBER,5e-3),BALL,mass=.001,velocity=.1,temperature=300.)
C["impact oblique"]=lambda: em.impact(SOLID,BALL,mass=.01,velocity=1.,tangential_velocity=.5,friction=.3)
C["indent depth"]=lambda: em.indent(RUBBER,BALL,time=T,depth=1e-5*np.array([0,1,2,1,0,1.]),temperature=300.)
C["indent load up"]=lambda: em.indent(RUBBER,BALL,time=T,load=[0,1,2,3,4,4.],temperature=300.)
C["indent load down"]=lambda: em.indent(SOLID,BALL,time=T,load=L,rtol=1e-3)
C["indent mixed"]=lambda: em.indent(SOLID,BALL,time=T,load=[0,1,2,np.nan,np.nan,1.],depth=[np.nan]*3+[1e-5,2e-5,np.nan],rtol=1e-3)
C["indent layer"]=lambda: em.indent(em.layer(RUBBER,5e-3),BALL,time=T,load=[0,1,2,3,4,4.],temperature=300.)
C["indent jkr"]=lambda: em.indent(em.Prony(1e6,[],[]),BALL,time=T,load=[0,1,2,1,0,-1e-4],adhesion=.1)
C["indent sticky"]=lambda: em.indent(SOLID,BALL,time=T,load=[1,.8,.6,.4,.2,0.],adhesion=.1)
C["indent surface"]=lambda: em.indent(SOLID,BALL,time=T,load=[0,1,2,3,4,4.])
C["shear grad"]=None
import time
pick=sys.argv[1:]
for k,f in C.items():
    if f is None or (pick and not any(p in k for p in pick)): continue
    c=time.process_time()
    with warnings.catch_warnings(record=True) as w:
        warnings.simplefilter("always")
        try: r=f()
        except Exception as e:
            print(k,"EXC",type(e).__name__,str(e)[:300]); continue
    c=time.process_time()-c
    print(f"# {k}: {c:.2f} s", *[str(x.message)[:90] for x in w], file=sys.stderr)
    print(k, "warn", [str(x.message) for x in w], "plan", r.plan)
    for n,v in arr(r).items():
        if v.dtype.kind=='f':
            print(k,n,hashlib.md5(np.ascontiguousarray(v).tobytes()).hexdigest()[:8],*[float(x).hex() for x in v.ravel()[:6]])
    if k=="indent surface":
        print(k,"p",*[float(x).hex() for x in r.pressure([0.,1e-4,2e-4],.01)])
    if k=="impact oblique":
        for n in ("before","after","slip_loss","lost","force","error"):
            print(k,n,*[float(x).hex() for x in np.ravel(getattr(r.oblique,n))[:6]])
